#include "tests/data/synthetic_mesh.h"

#include <algorithm>
#include <random>

#include "shared/bits/bit_writer.h"
#include "shared/bits/crc32c.h"
#include "shared/codec/record.h"

namespace meshfront {
namespace {

constexpr unsigned kMaxSyntheticLevel = 6;

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(engine_() % n); }

 private:
  std::mt19937 engine_;
};

// A code that has every symbol below `used`, of an alphabet of `symbols`.
HuffmanCode evenCode(size_t symbols, size_t used) {
  std::vector<uint64_t> counts(symbols, 0);
  for (size_t i = 0; i < std::min(used, symbols); ++i) counts[i] = 1;
  return HuffmanCode::fromCounts(counts);
}

CodeTables makeTables(unsigned quantizationBits) {
  CodeTables tables;
  tables.maxLevel = kMaxSyntheticLevel;
  tables.valueClasses = 2 * quantizationBits;
  // The last length makes records of more than 64 bits.
  for (auto& lengths : tables.cutLengths) lengths = {3, 9, 17, 90};
  for (auto& code : tables.header) code = evenCode(tables.headerSymbols(), tables.headerSymbols());
  for (auto& code : tables.levels) code = evenCode(kLevelCount, kMaxSyntheticLevel + 1);
  for (auto& code : tables.levelPairs)
    code = evenCode(size_t{kLevelCount} * kLevelCount, size_t{kLevelCount} * kMaxSyntheticLevel);
  const size_t joint = size_t{tables.valueClasses} * tables.valueClasses;
  for (auto& code : tables.classes) code = evenCode(joint, size_t{tables.valueClasses} * 6);
  for (auto& code : tables.residual) code = evenCode(tables.residualClasses(), 8);
  return tables;
}

// Two poles over a ring of the other roots.
std::vector<Triangle> bipyramid(uint32_t roots) {
  std::vector<Triangle> triangles;
  const uint32_t ring = roots - 2;
  for (uint32_t i = 0; i < ring; ++i) {
    const uint32_t a = 2 + i;
    const uint32_t b = 2 + (i + 1) % ring;
    triangles.push_back({0, a, b});
    triangles.push_back({1, b, a});
  }
  return triangles;
}

class Maker {
 public:
  explicit Maker(const SyntheticOptions& options) : options_(options), random_(options.seed) {}

  SyntheticMesh make() {
    makeBase();
    for (uint32_t tree = 0; tree < mesh_.base.roots.size(); ++tree)
      if (!mesh_.base.roots[tree].isLeaf)
        makeTree(NodeId::root(tree), mesh_.base.roots[tree].level);
    const uint64_t recordBits = out_.bitCount();
    mesh_.bits = out_.take();
    mesh_.base.splitCount = mesh_.entries.size();
    PackContent& content = mesh_.content;
    content.base = encodeBaseMesh(mesh_.base);
    makeChunks(content);
    content.reportJson = "{\"synthetic\":true}";
    MeshMetadata& metadata = content.metadata;
    metadata.name = options_.name;
    metadata.splitCount = mesh_.entries.size();
    metadata.baseVertexCount = mesh_.base.roots.size();
    metadata.baseTriangleCount = mesh_.base.triangles.size();
    metadata.vertexCount = mesh_.base.roots.size() + mesh_.entries.size();
    metadata.triangleCount = mesh_.base.triangles.size() + 2 * mesh_.entries.size();
    metadata.maxLevel = kMaxSyntheticLevel;
    metadata.maxDepth = options_.maxDepth;
    metadata.quantization.bits = mesh_.base.quantizationBits;
    metadata.quantization.step = 0.1;
    metadata.boundsMax = {1, 1, 1};
    metadata.recordBytes = (recordBits + 7) / 8;
    return std::move(mesh_);
  }

 private:
  void makeBase() {
    BaseMesh& base = mesh_.base;
    base.tables = makeTables(base.quantizationBits);
    for (uint32_t i = 0; i < options_.roots; ++i) {
      BaseMesh::Root root;
      for (auto& c : root.position) c = static_cast<int32_t>(random_.below(1U << 14));
      root.isLeaf = i == 3 || i == 4;
      if (!root.isLeaf) root.level = static_cast<uint8_t>(random_.below(2));
      base.roots.push_back(root);
    }
    base.triangles = bipyramid(options_.roots);
  }

  void makeTree(const NodeId& node, unsigned level) {
    Record record;
    const bool atBottom = node.depth + 1U >= options_.maxDepth;
    const auto childLevel = [&] {
      return static_cast<uint8_t>(
          std::min(kMaxSyntheticLevel, level + (random_.below(3) == 0 ? 1U : 0U)));
    };
    record.leftIsLeaf = atBottom || random_.below(5) == 0;
    record.rightIsLeaf = atBottom || random_.below(4) == 0;
    if (!record.leftIsLeaf) record.leftLevel = childLevel();
    if (!record.rightIsLeaf) record.rightLevel = childLevel();
    record.deltaB = static_cast<int32_t>(random_.below(7)) - 3;
    record.deltaC = static_cast<int32_t>(random_.below(7)) - 3;
    record.residualA = static_cast<int32_t>(random_.below(7)) - 3;
    const unsigned cutClass = random_.below(20) == 0 ? 3 : random_.below(3);

    const uint64_t begin = out_.bitCount();
    writeRecordHead(out_, record, cutClass, mesh_.base.tables, level);
    for (unsigned i = 0; i < mesh_.base.tables.cutLengths[0][cutClass]; ++i)
      out_.writeBit(random_.below(2) == 0);
    mesh_.entries.push_back({node, static_cast<uint8_t>(level), record.leftIsLeaf,
                             record.rightIsLeaf, record.leftLevel, record.rightLevel,
                             static_cast<uint32_t>(out_.bitCount() - begin), begin});
    if (!record.leftIsLeaf) makeTree(node.child(false), record.leftLevel);
    if (!record.rightIsLeaf) makeTree(node.child(true), record.rightLevel);
  }

  void makeChunks(PackContent& content) {
    ChunkIndex index;
    index.firstNodes.resize(kMaxSyntheticLevel + 1);
    for (unsigned band = 0; band <= kMaxSyntheticLevel; ++band) {
      std::vector<RecordEntry> ofBand;
      for (const RecordEntry& entry : mesh_.entries)
        if (entry.level == band) ofBand.push_back(entry);
      for (size_t begin = 0; begin < ofBand.size(); begin += options_.recordsPerChunk) {
        const auto run = std::span(ofBand).subspan(
            begin, std::min<size_t>(options_.recordsPerChunk, ofBand.size() - begin));
        content.chunks.push_back(encodeChunk(band, run, mesh_.bits));
        index.firstNodes[band].push_back(run.front().id);
      }
    }
    content.chunkIndex = encodeChunkIndex(index);
  }

  const SyntheticOptions& options_;
  Random random_;
  SyntheticMesh mesh_;
  BitWriter out_;
};

}  // namespace

SyntheticMesh makeSyntheticMesh(const SyntheticOptions& options) {
  return Maker(options).make();
}

const RecordEntry* SyntheticMesh::find(const NodeId& node) const {
  const auto it = std::lower_bound(entries.begin(), entries.end(), node,
                                   [](const RecordEntry& e, const NodeId& n) { return e.id < n; });
  return it != entries.end() && it->id == node ? &*it : nullptr;
}

std::vector<NodeId> SyntheticMesh::nodesAtDepth(unsigned depth) const {
  std::vector<NodeId> nodes;
  for (const RecordEntry& entry : entries)
    if (entry.id.depth == depth) nodes.push_back(entry.id);
  return nodes;
}

std::vector<uint8_t> SyntheticMesh::answerTo(std::span<const NodeId> wanted,
                                             const Expansion& expansion) const {
  const auto belongs = [&](const RecordEntry& entry) {
    return std::any_of(wanted.begin(), wanted.end(), [&](const NodeId& top) {
      if (entry.id == top) return true;
      if (!top.isAncestorOf(entry.id)) return false;
      if (expansion.significance) return entry.level <= *expansion.significance;
      return entry.id.depth - top.depth <= static_cast<int>(expansion.levels);
    });
  };
  BitWriter out;
  for (const RecordEntry& entry : entries)
    if (belongs(entry)) out.append(bits, entry.bitOffset, entry.bitLength);
  std::vector<uint8_t> bytes = out.take();
  appendChecksum(bytes);
  return bytes;
}

}  // namespace meshfront
