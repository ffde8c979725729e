// Numbers as the panel shows them.
#pragma once

#include <cstdint>
#include <string>

namespace meshfront {

[[nodiscard]] std::string groupedText(uint64_t number);  // 1,234,567
[[nodiscard]] std::string byteText(uint64_t octets);     // 812 B, 1.24 MB (powers of 1000)
[[nodiscard]] std::string durationText(double seconds);  // 0.8 ms, 12 ms, 1.4 s
[[nodiscard]] std::string shareText(double share);       // 87 %, 99.9 %, never 100 % below 1
[[nodiscard]] std::string fixedText(double value, int decimals);
[[nodiscard]] std::string significantText(double value);  // three digits: 0.00123, 4.56e-07

}  // namespace meshfront
