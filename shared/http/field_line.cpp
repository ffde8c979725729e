#include "shared/http/field_line.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace meshfront {
namespace {

constexpr std::array<bool, 256> kTokenOctets = [] {
  std::array<bool, 256> table{};
  for (const char c : std::string_view("!#$%&'*+-.^_`|~0123456789"
                                       "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"))
    table[static_cast<uint8_t>(c)] = true;
  return table;
}();

constexpr std::array<bool, 256> kTextOctets = [] {
  std::array<bool, 256> table{};
  for (size_t octet = 0x20; octet < table.size(); ++octet) table[octet] = octet != 0x7F;
  table['\t'] = true;
  return table;
}();

std::string_view withoutBlanks(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

}  // namespace

bool isTokenOctet(char c) {
  return kTokenOctets[static_cast<uint8_t>(c)];
}

bool isToken(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), isTokenOctet);
}

bool isText(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return kTextOctets[static_cast<uint8_t>(c)]; });
}

bool equalsIgnoringCase(std::string_view text, std::string_view lower) {
  return std::equal(text.begin(), text.end(), lower.begin(), lower.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + ('a' - 'A')) : a) == b;
  });
}

std::string_view nextInList(std::string_view& list) {
  const size_t comma = list.find(',');
  const std::string_view element = list.substr(0, comma);
  list.remove_prefix(comma == std::string_view::npos ? list.size() : comma + 1);
  return withoutBlanks(element);
}

std::optional<std::string_view> withoutLineEnd(std::string_view line) {
  if (!line.ends_with("\r\n")) return std::nullopt;
  line.remove_suffix(2);
  return line;
}

std::optional<FieldLine> parseFieldLine(std::string_view line) {
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || !isToken(line.substr(0, colon))) return std::nullopt;
  const std::string_view value = line.substr(colon + 1);
  if (!isText(value)) return std::nullopt;
  return FieldLine{line.substr(0, colon), withoutBlanks(value)};
}

}  // namespace meshfront
