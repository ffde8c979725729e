// Colours and normals in a record: those of t as differences from those of s (u keeps s's).
//
// Layout, each part only if the layout has it; classes and values as in record.h:
//   colour   class of green's difference, Huffman(by level); classes of red's and of blue's
//            difference less green's, Huffman(by green's class) each; class of alpha's difference,
//            Huffman; then the rest of green, red, blue, alpha
//   normal   classes of both coordinates' differences jointly, Huffman(by level); the rest of both
#pragma once

#include <array>
#include <cstdint>

#include "shared/bits/bit_reader.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/huffman.h"
#include "shared/mesh/vertex_attributes.h"

namespace meshfront {

struct AttributeDelta {
  std::array<int16_t, 4> colour{};  // green, red - green, blue - green, alpha
  std::array<int16_t, 2> normal{};
};

[[nodiscard]] AttributeDelta attributeDelta(const VertexAttributes& s, const VertexAttributes& t);
// False if a colour or coordinate would leave its range, which is damage; then `out` is in range
// but of no meaning.
[[nodiscard]] bool addAttributes(const VertexAttributes& s, const AttributeDelta& delta,
                                 const AttributeLayout& layout, VertexAttributes& out);

inline constexpr unsigned kAttributeLevelContexts = 4;
inline constexpr unsigned kColourContexts = 8;
inline constexpr unsigned kColourClasses = 16;      // of green and alpha
inline constexpr unsigned kColourRestClasses = 18;  // of red and blue less green

struct AttributeTables {
  AttributeLayout layout;
  std::array<HuffmanCode, kAttributeLevelContexts> green;
  std::array<HuffmanCode, kColourContexts> red;
  std::array<HuffmanCode, kColourContexts> blue;
  HuffmanCode alpha;
  std::array<HuffmanCode, kAttributeLevelContexts> normal;  // class x * normalClasses() + class y

  [[nodiscard]] unsigned normalClasses() const { return 2 * layout.normalBits; }
  [[nodiscard]] size_t memoryBytes() const {  // held beside the object itself
    size_t bytes = alpha.memoryBytes();
    for (const auto& code : green) bytes += code.memoryBytes();
    for (const auto& code : red) bytes += code.memoryBytes();
    for (const auto& code : blue) bytes += code.memoryBytes();
    for (const auto& code : normal) bytes += code.memoryBytes();
    return bytes;
  }
};

// Untrusted.
AttributeDelta readAttributes(BitReader& in, const AttributeTables& tables, unsigned levelContext);
void writeAttributes(BitWriter& out, const AttributeDelta& delta, const AttributeTables& tables,
                     unsigned levelContext);

// What each part takes.
struct AttributeBits {
  unsigned colour = 0;
  unsigned normal = 0;
};
[[nodiscard]] AttributeBits attributeBits(const AttributeDelta& delta,
                                          const AttributeTables& tables, unsigned levelContext);

// Counts differences to train the codes from.
struct AttributeStatistics {
  explicit AttributeStatistics(const AttributeLayout& layout);
  void add(const AttributeDelta& delta, unsigned levelContext);
  [[nodiscard]] AttributeTables train() const;

  AttributeLayout layout;
  std::array<std::vector<uint64_t>, kAttributeLevelContexts> green;
  std::array<std::vector<uint64_t>, kColourContexts> red;
  std::array<std::vector<uint64_t>, kColourContexts> blue;
  std::vector<uint64_t> alpha;
  std::array<std::vector<uint64_t>, kAttributeLevelContexts> normal;
};

// The layout, then its codes.
void writeAttributeTables(BitWriter& out, const AttributeTables& tables);
// Untrusted; false if damaged or of a layout that this version does not know.
[[nodiscard]] bool readAttributeTables(BitReader& in, AttributeTables& tables);

}  // namespace meshfront
