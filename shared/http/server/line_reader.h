// Lines of a stream that comes in pieces.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace meshfront {

class LineReader {
 public:
  // Takes octets off the front of `bytes`, up to the end of a line: the line with its line feed, or
  // nothing where its end has not come yet. Valid until the next call and as long as `bytes` are.
  // Holds no more than `longest` octets; where the line has more, tooLong() from then on.
  [[nodiscard]] std::optional<std::string_view> take(std::string_view& bytes, size_t longest);
  [[nodiscard]] bool tooLong() const { return tooLong_; }
  // What has come of a line that is not whole, or what was held of one that is too long.
  [[nodiscard]] std::string_view begun() const {
    return whole_ ? std::string_view() : std::string_view(begun_);
  }

 private:
  std::string begun_;
  bool whole_ = false;  // `begun_` was given out
  bool tooLong_ = false;
};

}  // namespace meshfront
