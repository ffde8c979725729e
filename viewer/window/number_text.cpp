#include "viewer/window/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace meshfront {

std::string fixedText(double value, int decimals) {
  std::array<char, 400> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return {text.data(), std::min(text.size() - 1, static_cast<size_t>(std::max(0, length)))};
}

std::string significantText(double value) {
  std::array<char, 40> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.3g", value);
  return {text.data(), static_cast<size_t>(std::max(0, length))};
}

std::string groupedText(uint64_t number) {
  std::string digits = std::to_string(number);
  for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

std::string byteText(uint64_t octets) {
  constexpr std::array<const char*, 5> kUnits = {" B", " kB", " MB", " GB", " TB"};
  if (octets < 1000) return std::to_string(octets) + kUnits[0];
  auto value = static_cast<double>(octets);
  size_t unit = 0;
  // From 999.5 on it would be shown as 1000.
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  return fixedText(value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0) + kUnits[unit];
}

std::string durationText(double seconds) {
  const double milliseconds = 1000 * seconds;
  if (milliseconds < 9.95) return fixedText(milliseconds, 1) + " ms";
  if (milliseconds < 999.5) return fixedText(milliseconds, 0) + " ms";
  return fixedText(seconds, seconds < 9.95 ? 1 : 0) + " s";
}

std::string shareText(double share) {
  const double percent = 100 * std::clamp(share, 0.0, 1.0);
  if (percent >= 100) return "100 %";
  if (percent >= 99) return fixedText(std::min(percent, 99.9), 1) + " %";
  return fixedText(percent, 0) + " %";
}

}  // namespace meshfront
