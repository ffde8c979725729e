// A CSV file, a row a call. Values with commas or quotes are quoted.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "shared/result.h"

namespace meshfront::evaluation {

class CsvFile {
 public:
  CsvFile(std::filesystem::path path, const std::vector<std::string>& columns)
      : path_(std::move(path)), out_(path_, std::ios::trunc) {
    row(columns);
  }
  void row(const std::vector<std::string>& values) {
    for (size_t i = 0; i < values.size(); ++i) {
      if (i > 0) out_ << ',';
      write(values[i]);
    }
    out_ << '\n';
  }
  // Texts and numbers, these as streams write them.
  template <typename First, typename... Rest>
  void row(const First& first, const Rest&... rest) {
    write(first);
    ((out_ << ',', write(rest)), ...);
    out_ << '\n';
  }
  // An error if anything could not be written.
  Result<void> close() {
    out_.close();
    if (!out_) return fail(ErrorCode::unavailable, "cannot write " + path_.string());
    return {};
  }

 private:
  template <typename Value>
  void write(const Value& value) {
    if constexpr (std::is_convertible_v<Value, std::string_view>) {
      const std::string_view text(value);
      if (text.find_first_of(",\"\n") == std::string_view::npos) {
        out_ << text;
        return;
      }
      out_ << '"';
      for (const char c : text) {
        if (c == '"') out_ << c;
        out_ << c;
      }
      out_ << '"';
    } else {
      out_ << value;
    }
  }

  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace meshfront::evaluation
