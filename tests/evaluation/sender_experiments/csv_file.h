// A CSV file, a row a call. Values hold no commas or quotes.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "shared/result.h"

namespace meshfront::evaluation {

class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, const std::string& columns) : path_(path), out_(path) {
    out_ << columns << '\n';
  }
  template <typename First, typename... Rest>
  void row(const First& first, const Rest&... rest) {
    out_ << first;
    ((out_ << ',' << rest), ...);
    out_ << '\n';
  }
  Result<void> close() {
    out_.close();
    if (!out_) return fail(path_.string() + ": cannot be written");
    return {};
  }

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace meshfront::evaluation
