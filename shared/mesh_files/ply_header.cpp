#include "shared/mesh_files/ply_header.h"

#include <array>
#include <charconv>
#include <utility>

namespace meshfront {
namespace {

std::optional<PlyScalar> scalarNamed(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyScalar>, 16> kNames = {{
      {"char", PlyScalar::int8},
      {"int8", PlyScalar::int8},
      {"uchar", PlyScalar::uint8},
      {"uint8", PlyScalar::uint8},
      {"short", PlyScalar::int16},
      {"int16", PlyScalar::int16},
      {"ushort", PlyScalar::uint16},
      {"uint16", PlyScalar::uint16},
      {"int", PlyScalar::int32},
      {"int32", PlyScalar::int32},
      {"uint", PlyScalar::uint32},
      {"uint32", PlyScalar::uint32},
      {"float", PlyScalar::float32},
      {"float32", PlyScalar::float32},
      {"double", PlyScalar::float64},
      {"float64", PlyScalar::float64},
  }};
  for (const auto& [spelling, type] : kNames)
    if (spelling == name) return type;
  return std::nullopt;
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const size_t start = line.find_first_not_of(" \t\r");
    if (start == line.npos) return words;
    line.remove_prefix(start);
    const size_t length = line.find_first_of(" \t\r");
    words.push_back(line.substr(0, length));
    if (length == line.npos) return words;
    line.remove_prefix(length);
  }
}

// Each returns an empty text, or what is wrong with the line.
std::string readFormat(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() != 3 || words[2] != "1.0") return "not a PLY format of version 1.0";
  if (words[1] == "ascii")
    header.encoding = PlyEncoding::ascii;
  else if (words[1] == "binary_little_endian")
    header.encoding = PlyEncoding::littleEndian;
  else if (words[1] == "binary_big_endian")
    header.encoding = PlyEncoding::bigEndian;
  else
    return "unknown PLY format";
  return {};
}

std::string readElement(const std::vector<std::string_view>& words, size_t line,
                        PlyHeader& header) {
  if (words.size() != 3) return "expected: element NAME COUNT";
  PlyElement element;
  element.name = words[1];
  element.line = line;
  const char* const end = words[2].data() + words[2].size();
  const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
  if (error != std::errc() || stop != end) return "the element's count is no count";
  header.elements.push_back(std::move(element));
  return {};
}

std::string readProperty(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (header.elements.empty()) return "a property before the first element";
  PlyProperty property;
  const bool list = words.size() > 1 && words[1] == "list";
  if (words.size() != (list ? 5U : 3U))
    return "expected: property TYPE NAME, or property list TYPE TYPE NAME";
  property.name = words.back();
  const auto type = scalarNamed(words[words.size() - 2]);
  if (list) property.countType = scalarNamed(words[2]);
  if (!type || (list && !property.countType)) return "unknown property type";
  property.type = *type;
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

}  // namespace

unsigned byteLength(PlyScalar type) {
  constexpr std::array<unsigned, 8> kLengths = {1, 1, 2, 2, 4, 4, 4, 8};
  return kLengths[static_cast<size_t>(type)];
}

Result<PlyHeader> parsePlyHeader(std::string_view file) {
  if (!file.starts_with("ply")) return fail("line 1: a PLY file starts with the line 'ply'");
  // The first line shows how lines end: guessing later could swallow a byte of a binary body.
  std::string_view lineEnd = "\n";
  if (file.substr(3).starts_with("\r\n"))
    lineEnd = "\r\n";
  else if (file.substr(3).starts_with("\r"))
    lineEnd = "\r";

  PlyHeader header;
  bool hasFormat = false;
  size_t at = 0;
  for (size_t number = 1;; ++number) {
    const std::string place = "line " + std::to_string(number) + ": ";
    const size_t end = file.find(lineEnd, at);
    if (end == file.npos) return fail(place + "the file ends within the PLY header");
    const auto words = wordsOf(file.substr(at, end - at));
    at = end + lineEnd.size();
    const std::string_view keyword = words.empty() ? std::string_view() : words[0];
    std::string problem;
    if (number == 1) {
      if (words.size() != 1 || keyword != "ply") problem = "a PLY file starts with the line 'ply'";
    } else if (keyword == "format") {
      problem = readFormat(words, header);
      hasFormat = true;
    } else if (keyword == "element") {
      problem = readElement(words, number, header);
    } else if (keyword == "property") {
      problem = readProperty(words, header);
    } else if (keyword == "comment" && words.size() == 3 && words[1] == "TextureFile") {
      header.textureFiles.emplace_back(words[2]);
    } else if (keyword == "end_header") {
      if (hasFormat) {
        header.bodyOffset = at;
        return header;
      }
      problem = "the header names no format";
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      problem = "unknown keyword in the PLY header";
    }
    if (!problem.empty()) return fail(place + problem);
  }
}

}  // namespace meshfront
