// Walks through the text of a mesh file: words and numbers, independent of the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace meshfront {

// Never reads past the text. The readers return false, and stay where they are, on anything else
// than what was asked for; problem() then says what is wrong and where.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text, size_t offset = 0)
      : begin_(text.data()), at_(text.data() + offset), end_(text.data() + text.size()) {}

  [[nodiscard]] bool atEnd() const { return at_ == end_; }
  [[nodiscard]] size_t left() const { return static_cast<size_t>(end_ - at_); }
  [[nodiscard]] size_t offset() const { return static_cast<size_t>(at_ - begin_); }

  // Space within a line; a backslash before the line's end continues it (OBJ).
  void skipBlanks() {
    while (at_ != end_) {
      if (isBlank(*at_)) {
        ++at_;
      } else if (const size_t joint = continuation(); joint > 0) {
        at_ += joint;
      } else {
        return;
      }
    }
  }
  void skipSpace() {
    while (at_ != end_ && isSpace(*at_)) ++at_;
  }
  void skipSpaceAndComments() {  // # to the end of the line
    for (skipSpace(); at_ != end_ && *at_ == '#'; skipSpace()) skipLine();
  }
  void skipLine() {
    while (at_ != end_ && *at_ != '\n') ++at_;
    if (at_ != end_) ++at_;
  }
  // The line ends here, or a comment starts.
  [[nodiscard]] bool atLineEnd() const { return at_ == end_ || *at_ == '\n' || *at_ == '#'; }

  // The characters up to the next space; empty at a line's end. Does not skip space before.
  std::string_view word() {
    const char* const start = at_;
    while (at_ != end_ && !isSpace(*at_) && continuation() == 0) ++at_;
    return {start, static_cast<size_t>(at_ - start)};
  }
  [[nodiscard]] std::string_view peekWord() const { return TextCursor(*this).word(); }

  // A finite number. Below the smallest double it is 0.
  bool real(double& value);
  // The same, or an infinite one (also for a number beyond the largest double), or NaN.
  bool number(double& value);
  // A whole number; also spelt as a real ("3.0").
  bool integer(int64_t& value);
  // A whole number that something may follow ("3/1/2"): stops behind its digits.
  bool integerPrefix(int64_t& value) {
    const char* const start = skipPlus();
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error != std::errc()) return false;
    at_ = stop;
    return true;
  }

  // "line 12", counted only when asked for.
  [[nodiscard]] std::string place() const { return place(offset()); }
  [[nodiscard]] std::string place(size_t offset) const;
  // "line 12: 'abc' is no finite number", or that the file ends early.
  [[nodiscard]] std::string problem(std::string_view expected = "finite number") const;

 private:
  static bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
  }
  static bool isSpace(char c) { return isBlank(c) || c == '\n'; }
  [[nodiscard]] size_t continuation() const {  // its length, 0 if none is here
    if (*at_ != '\\') return 0;
    if (end_ - at_ >= 2 && at_[1] == '\n') return 2;
    return end_ - at_ >= 3 && at_[1] == '\r' && at_[2] == '\n' ? 3 : 0;
  }
  [[nodiscard]] const char* skipPlus() const {  // from_chars takes no plus sign
    return end_ - at_ >= 2 && *at_ == '+' && at_[1] != '-' ? at_ + 1 : at_;
  }

  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace meshfront
