#include <algorithm>

#include "shared/codec/answer.h"
#include "shared/codec/chunk.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/refinement/selectively_refined_mesh.h"
#include "tests/fuzz/fuzz_bases.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

void checkEntries(const std::vector<RecordEntry>& entries, uint64_t bits) {
  uint64_t end = 0;
  for (size_t i = 0; i < entries.size(); ++i) {
    const RecordEntry& entry = entries[i];
    promise(i == 0 || entries[i - 1].id < entry.id, "records are in preorder");
    promise(entry.id.depth < kMaxDepth, "no node is too deep to be split");
    promise(entry.bitLength > 0 && entry.bitOffset >= end, "records do not overlap");
    end = entry.bitOffset + entry.bitLength;
    promise(end <= bits, "records lie in the bytes");
  }
}

}  // namespace

bool readAnswer(Bytes input) {
  FuzzInput in(input);
  const uint8_t expand = in.byte();
  Expansion expansion;
  if (expand >= 128) {
    expansion.significance = static_cast<uint8_t>(expand % (kMaxLevel + 1));
  } else {
    expansion.levels = expand % (kMaxDepth + 1);
  }
  const size_t length = in.word();
  const auto wanted = decodeTreeBitstring(in.take(length), 4096);
  if (!wanted) return false;
  const std::vector<uint8_t> bytes = withChecksum(in.rest());
  bool accepted = false;
  for (size_t i = 0; i < kBases; ++i) {
    const BaseMesh& base = baseOf(i);
    const auto levelOf = [&](const NodeId& node) -> std::optional<unsigned> {
      if (node.tree >= base.roots.size()) return std::nullopt;
      return std::min<unsigned>(base.roots[node.tree].level + node.depth / 2U,
                                base.tables.maxLevel);
    };
    const auto entries = parseAnswer(bytes, *wanted, expansion, base.tables, levelOf);
    if (!entries) continue;
    accepted = true;
    checkEntries(*entries, bytes.size() * 8);
  }
  return accepted;
}

bool readBase(Bytes input) {
  auto base = decodeBaseMesh(withChecksum(input));
  if (!base) return false;
  const auto trees = base->treeCount();
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  for (const Triangle& t : base->triangles)
    for (size_t i = 0; i < 3; ++i) {
      promise(t[i] < trees, "corners are in range");
      edges.emplace_back(t[i], t[(i + 1) % 3]);
    }
  std::sort(edges.begin(), edges.end());
  promise(std::adjacent_find(edges.begin(), edges.end()) == edges.end(), "no edge comes twice");
  for (const auto& [from, to] : edges)
    promise(std::binary_search(edges.begin(), edges.end(), std::pair(to, from)),
            "every edge has its opposite");
  const auto limit = static_cast<int32_t>(1U << base->quantizationBits);
  for (const BaseMesh::Root& root : base->roots) {
    promise(root.isLeaf || root.level <= base->tables.maxLevel, "levels are in range");
    for (const int32_t v : root.position) promise(v >= 0 && v < limit, "roots are on the grid");
  }
  const auto again = decodeBaseMesh(encodeBaseMesh(*base));
  promise(again && again->triangles.size() == base->triangles.size() &&
              again->roots.size() == base->roots.size(),
          "what is written reads the same");
  auto mesh = SelectivelyRefinedMesh::fromBase(std::move(*base));
  promise(mesh.has_value(), "a sound base becomes a mesh");
  // Records of any bits, read by whatever codes the base has.
  constexpr size_t kTries = 64;
  for (NodeIndex node = 0; node < std::min(mesh->nodeCount(), kTries); ++node) {
    if (mesh->isLeaf(node)) continue;
    const uint64_t offset = node % (input.size() * 8);
    BitReader in(input, offset, input.size() * 8);
    const Record record = readRecord(in, mesh->base().tables, mesh->level(node));
    if (!in.overrun()) static_cast<void>(mesh->split(node, input, offset, record.cutEnd));
  }
  return true;
}

bool readChunk(Bytes input) {
  const std::vector<uint8_t> bytes = withChecksum(input);
  bool accepted = false;
  for (size_t i = 0; i < kBases; ++i) {
    const auto chunk = decodeChunk(bytes, baseOf(i).tables);
    if (!chunk) continue;
    accepted = true;
    checkEntries(chunk->entries, bytes.size() * 8);
    for (const RecordEntry& entry : chunk->entries)
      promise(entry.level == chunk->band, "a chunk holds one band");
  }
  return accepted;
}

bool readChunkIndex(Bytes input) {
  const auto index = decodeChunkIndex(withChecksum(input));
  if (!index) return false;
  uint32_t number = 0;
  for (unsigned band = 0; band < index->firstNodes.size(); ++band) {
    const auto& nodes = index->firstNodes[band];
    for (size_t i = 0; i < nodes.size(); ++i) {
      promise(i == 0 || nodes[i - 1] < nodes[i], "first nodes ascend");
      promise(index->find(nodes[i], band) == number, "a first node is in its chunk");
      ++number;
    }
  }
  promise(number == index->chunkCount(), "chunks are counted");
  promise(!index->find(NodeId::root(0), kMaxLevel + 1), "there is no such band");
  return true;
}

}  // namespace meshfront::fuzz
