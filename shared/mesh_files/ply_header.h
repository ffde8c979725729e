// The header of a PLY file (Turk 1994): what elements follow, and how they are spelt.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result.h"

namespace meshfront {

enum class PlyEncoding { ascii, littleEndian, bigEndian };
enum class PlyScalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::float32;  // of a list: of its items
  std::optional<PlyScalar> countType;   // of a list's length; none: no list
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;  // as the file claims
  size_t line = 0;     // of the header, from 1
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;       // in the order of the body
  std::vector<std::string> textureFiles;  // named by comments "TextureFile NAME" (MeshLab)
  size_t bodyOffset = 0;                  // byte behind the line "end_header"
};

[[nodiscard]] unsigned byteLength(PlyScalar type);

// Untrusted. Line ends may be LF, CR LF or CR. Errors name the line.
[[nodiscard]] Result<PlyHeader> parsePlyHeader(std::string_view file);

}  // namespace meshfront
