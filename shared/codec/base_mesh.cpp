// Layout, bits most significant first:
//   magic "MFB" and version 2 (32), quantisation bits (5), splits (Exp-Golomb 16),
//   roots, virtual trees (Exp-Golomb 8, 2), code tables (code_tables.cpp), whether any root is a
//   leaf (1)
//   roots in order: each coordinate's difference from the last root's, zigzag, Exp-Golomb of the
//   order given by 5 bits; its colour and normal, where the mesh has them, likewise in the orders
//   3 and bits - 4; leaf flag where any is one; unless a leaf its level in maxLevel's bits
//   triangles (base_connectivity.h)
//   zero bits up to a byte, CRC-32C
#include "shared/codec/base_mesh.h"

#include <bit>

#include "shared/bits/crc32c.h"
#include "shared/bits/integer_codes.h"
#include "shared/codec/base_connectivity.h"

namespace meshfront {
namespace {

constexpr uint64_t kBaseMagic = 0x4D464202;
constexpr unsigned kBaseMagicBits = 32;
constexpr unsigned kSplitOrder = 16;
constexpr unsigned kRootOrder = 8;
constexpr unsigned kVirtualOrder = 2;
constexpr unsigned kOrderBits = 5;

uint64_t zigzag(int64_t v) {
  return v < 0 ? static_cast<uint64_t>(-2 * v - 1) : static_cast<uint64_t>(2 * v);
}
int64_t unzigzag(uint64_t v) {
  return (v & 1) != 0 ? -static_cast<int64_t>(v / 2) - 1 : static_cast<int64_t>(v / 2);
}

constexpr unsigned kColourOrder = 3;

unsigned normalOrder(const AttributeLayout& layout) {
  return layout.normalBits - kMinNormalBits;
}

void writeRootAttributes(BitWriter& out, const VertexAttributes& root, const VertexAttributes& last,
                         const AttributeLayout& layout) {
  if (layout.colours)
    for (size_t i = 0; i < 4; ++i)
      writeExpGolomb(out, zigzag(int64_t{root.colour[i]} - last.colour[i]), kColourOrder);
  if (layout.normalBits != 0)
    for (size_t i = 0; i < 2; ++i)
      writeExpGolomb(out, zigzag(int64_t{root.normal[i]} - last.normal[i]), normalOrder(layout));
}

bool readRootAttributes(BitReader& in, VertexAttributes& root, const VertexAttributes& last,
                        const AttributeLayout& layout) {
  const auto within = [&](int64_t value, int64_t limit) { return value >= 0 && value <= limit; };
  if (layout.colours)
    for (size_t i = 0; i < 4; ++i) {
      const int64_t value = last.colour[i] + unzigzag(readExpGolomb(in, kColourOrder));
      if (!within(value, 255)) return false;
      root.colour[i] = static_cast<uint8_t>(value);
    }
  if (layout.normalBits != 0)
    for (size_t i = 0; i < 2; ++i) {
      const int64_t value = last.normal[i] + unzigzag(readExpGolomb(in, normalOrder(layout)));
      if (!within(value, (int64_t{1} << layout.normalBits) - 1)) return false;
      root.normal[i] = static_cast<uint16_t>(value);
    }
  return true;
}

// The Exp-Golomb order that codes the coordinates in the fewest bits.
unsigned bestOrder(const BaseMesh& base) {
  unsigned best = 0;
  uint64_t bestBits = UINT64_MAX;
  for (unsigned order = 0; order <= base.quantizationBits; ++order) {
    uint64_t bits = 0;
    GridPosition last{};
    for (const auto& root : base.roots) {
      for (size_t i = 0; i < 3; ++i) {
        const uint64_t value = zigzag(int64_t{root.position[i]} - last[i]);
        const auto width = static_cast<unsigned>(std::bit_width(value + (uint64_t{1} << order)));
        bits += 2 * width - order - 1;
      }
      last = root.position;
    }
    if (bits < bestBits) {
      bestBits = bits;
      best = order;
    }
  }
  return best;
}

}  // namespace

std::vector<uint8_t> encodeBaseMesh(const BaseMesh& base) {
  BitWriter out;
  out.write(kBaseMagic, kBaseMagicBits);
  out.write(base.quantizationBits, 5);
  writeExpGolomb(out, base.splitCount, kSplitOrder);
  writeExpGolomb(out, base.roots.size(), kRootOrder);
  writeExpGolomb(out, base.virtualCount, kVirtualOrder);
  writeCodeTables(out, base.tables);
  bool anyLeaf = false;
  for (const auto& root : base.roots) anyLeaf |= root.isLeaf;
  out.writeBit(anyLeaf);
  const unsigned order = bestOrder(base);
  out.write(order, kOrderBits);
  const auto levelBits = static_cast<unsigned>(std::bit_width(base.tables.maxLevel));
  GridPosition last{};
  VertexAttributes lastAttributes;
  for (const auto& root : base.roots) {
    for (size_t i = 0; i < 3; ++i)
      writeExpGolomb(out, zigzag(int64_t{root.position[i]} - last[i]), order);
    last = root.position;
    writeRootAttributes(out, root.attributes, lastAttributes, base.tables.attributes.layout);
    lastAttributes = root.attributes;
    if (anyLeaf) out.writeBit(root.isLeaf);
    if (!root.isLeaf) out.write(root.level, levelBits);
  }
  writeBaseConnectivity(out, base.triangles, base.treeCount());
  std::vector<uint8_t> bytes = out.take();
  appendChecksum(bytes);
  return bytes;
}

Result<BaseMesh> decodeBaseMesh(std::span<const uint8_t> bytes) {
  const auto content = checkedContent(bytes, "base mesh");
  if (!content) return tl::unexpected(content.error());
  BitReader in(*content);
  if (in.read(kBaseMagicBits) != kBaseMagic)
    return fail("base mesh: not a base of this version of the format; update the viewer or server");
  BaseMesh base;
  base.quantizationBits = static_cast<unsigned>(in.read(5));
  if (base.quantizationBits < kMinQuantizationBits || base.quantizationBits > kMaxQuantizationBits)
    return fail("base mesh: quantisation outside 8 to 20 bits");
  base.splitCount = readExpGolomb(in, kSplitOrder);
  const uint64_t roots = readExpGolomb(in, kRootOrder);
  const uint64_t virtuals = readExpGolomb(in, kVirtualOrder);
  // Every root takes bits, every virtual tree faces: more of them than bits left is a lie.
  if (roots > in.left() || virtuals > in.left()) return fail("base mesh: wrong counts");
  base.virtualCount = static_cast<uint32_t>(virtuals);
  auto tables = readCodeTables(in);
  if (!tables) return tl::unexpected(tables.error());
  base.tables = std::move(*tables);
  const bool anyLeaf = in.readBit();
  const auto order = static_cast<unsigned>(in.read(kOrderBits));
  if (order > kMaxQuantizationBits) return fail("base mesh: wrong order of coordinates");
  const auto levelBits = static_cast<unsigned>(std::bit_width(base.tables.maxLevel));
  const int64_t limit = int64_t{1} << base.quantizationBits;
  GridPosition last{};
  VertexAttributes lastAttributes;
  base.roots.reserve(roots);
  for (uint64_t r = 0; r < roots; ++r) {
    BaseMesh::Root root;
    for (size_t i = 0; i < 3; ++i) {
      const int64_t value = last[i] + unzigzag(readExpGolomb(in, order));
      if (value < 0 || value >= limit) return fail("base mesh: a vertex outside the grid");
      root.position[i] = static_cast<int32_t>(value);
    }
    last = root.position;
    if (!readRootAttributes(in, root.attributes, lastAttributes, base.tables.attributes.layout))
      return fail("base mesh: a colour or normal out of range");
    lastAttributes = root.attributes;
    root.isLeaf = anyLeaf && in.readBit();
    if (!root.isLeaf) root.level = static_cast<uint8_t>(in.read(levelBits));
    if (root.level > base.tables.maxLevel) return fail("base mesh: a level beyond the finest");
    if (in.overrun()) return fail("base mesh: cut short");
    base.roots.push_back(root);
  }
  auto triangles = readBaseConnectivity(in, base.treeCount());
  if (!triangles) return tl::unexpected(triangles.error());
  base.triangles = std::move(*triangles);
  if (in.overrun() || in.left() >= 8 || in.read(static_cast<unsigned>(in.left())) != 0)
    return fail("base mesh: cut short, or bits behind the last triangle");
  return base;
}

}  // namespace meshfront
