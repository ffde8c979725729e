#include "shared/mesh_files/text_cursor.h"

#include <algorithm>

namespace meshfront {

bool TextCursor::number(double& value) {
  const char* const start = skipPlus();
  double parsed = 0;
  const auto [stop, error] = std::from_chars(start, end_, parsed);
  if (stop != end_ && !isSpace(*stop)) return false;
  if (error == std::errc::result_out_of_range) {
    const std::string_view spelling(start, static_cast<size_t>(stop - start));
    const bool tiny = spelling.find("e-") != spelling.npos || spelling.find("E-") != spelling.npos;
    parsed = tiny ? 0 : std::copysign(HUGE_VAL, *start == '-' ? -1 : 1);
  } else if (error != std::errc()) {
    return false;
  }
  value = parsed;
  at_ = stop;
  return true;
}

bool TextCursor::real(double& value) {
  const char* const start = at_;
  double parsed = 0;
  if (!number(parsed)) return false;
  if (!std::isfinite(parsed)) {
    at_ = start;
    return false;
  }
  value = parsed;
  return true;
}

bool TextCursor::integer(int64_t& value) {
  const char* const start = at_;
  if (integerPrefix(value) && (at_ == end_ || isSpace(*at_))) return true;
  at_ = start;
  double number = 0;
  if (!real(number)) return false;
  if (std::floor(number) == number && std::fabs(number) < 0x1p53) {
    value = static_cast<int64_t>(number);
    return true;
  }
  at_ = start;
  return false;
}

std::string TextCursor::place(size_t offset) const {
  return "line " + std::to_string(std::count(begin_, begin_ + offset, '\n') + 1);
}

std::string TextCursor::problem(std::string_view expected) const {
  if (atEnd()) return place() + ": the file ends early";
  std::string found(peekWord().substr(0, 24));
  for (char& c : found)
    if (c < ' ' || c > '~') c = '?';  // the message goes to a terminal
  if (found.empty())
    return place() + ": the line ends where a " + std::string(expected) + " belongs";
  return place() + ": '" + found + "' is no " + std::string(expected);
}

}  // namespace meshfront
