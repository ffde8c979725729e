#include "encoder/coding/mesh_coder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <unordered_map>

#include "encoder/coding/closed_connectivity.h"
#include "encoder/coding/cut_archive.h"
#include "encoder/coding/cut_length_classes.h"
#include "encoder/coding/static_ring.h"
#include "shared/codec/base_connectivity.h"
#include "shared/codec/cut_coding.h"
#include "shared/codec/position_prediction.h"
#include "shared/codec/record.h"

namespace meshfront {
namespace {

constexpr size_t kMaxCutClasses = 10;  // per value of the leaf flags
constexpr uint32_t kBlock = 8192;      // splits a thread takes at a time

// A block of splits, in preorder: what the first pass over it finds.
struct Block {
  CutArchive cuts;
  CutStatistics statistics;
};

// The parts of a record that are not the cut.
struct Split {
  Record record;
  unsigned level = 0;
};

class MeshCoder {
 public:
  MeshCoder(const CodingInput& input, const VertexForest& forest, unsigned threads,
            const CodingProgress& progress)
      : input_(input), forest_(forest), threads_(std::max(1U, threads)), progress_(progress) {}

  CodedMesh run() {
    makeBase();
    collectCuts();
    trainTables();
    writeChunks();
    base_.tables = tables_;
    out_.base = encodeBaseMesh(base_);
    BitWriter tableWriter;
    writeCodeTables(tableWriter, tables_);
    out_.tableBits = tableWriter.bitCount();
    return std::move(out_);
  }

 private:
  void makeBase();
  void collectCuts();
  void trainTables();
  void writeChunks();
  void walkBlock(uint32_t number, const std::vector<uint32_t>& twins, const FaceOrigins& origins);
  // Calls visit(index in preorder, split) for all splits; normals go down from parents.
  template <typename Visit>
  void forEachSplit(const Visit& visit);

  const CodingInput& input_;
  const VertexForest& forest_;
  unsigned threads_;
  const CodingProgress& progress_;
  CodedMesh out_;
  BaseMesh base_;
  CodeTables tables_;
  FaceOrigins origins_;
  std::unordered_map<uint32_t, uint32_t> baseIndex_;
  std::vector<Block> blocks_;
};

void MeshCoder::makeBase() {
  origins_ = faceOrigins(input_.triangles, forest_);
  base_.quantizationBits = input_.quantizationBits;
  base_.splitCount = forest_.splitCount();
  base_.virtualCount = input_.virtualCount;
  tables_.maxLevel = forest_.maxLevel();
  for (uint32_t tree = 0; tree < forest_.realRootCount(); ++tree) {
    const ForestNode root = forest_.roots()[tree];
    const bool leaf = forest_.isLeaf(root);
    base_.roots.push_back({input_.positions[forest_.vertex(root)], leaf,
                           static_cast<uint8_t>(leaf ? 0 : forest_.level(root))});
  }
  std::vector<Triangle> triangles;
  for (const uint32_t face : origins_.baseFaces) {
    Triangle corners{};
    for (size_t i = 0; i < 3; ++i) corners[i] = forest_.id(input_.triangles[face][i]).tree;
    triangles.push_back(corners);
  }
  // Receivers number base triangles in the order in which they are coded.
  BitWriter coded;
  writeBaseConnectivity(coded, triangles, base_.treeCount());
  const auto bytes = coded.take();
  BitReader in(bytes);
  base_.triangles = readBaseConnectivity(in, base_.treeCount()).value();
  const auto keyOf = [](const Triangle& t) {
    const size_t first = static_cast<size_t>(std::min_element(t.begin(), t.end()) - t.begin());
    return std::array<uint32_t, 3>{t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
  };
  std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> order;
  for (uint32_t i = 0; i < base_.triangles.size(); ++i)
    order.emplace_back(keyOf(base_.triangles[i]), i);
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const auto found =
        std::lower_bound(order.begin(), order.end(), std::pair{keyOf(triangles[i]), uint32_t{0}});
    baseIndex_[origins_.baseFaces[i]] = found->second;
  }
  const uint32_t roots = forest_.realRootCount();
  for (const Triangle& t : base_.triangles)
    if (t[0] < roots && t[1] < roots && t[2] < roots) ++out_.baseTriangles;
}

void MeshCoder::walkBlock(uint32_t number, const std::vector<uint32_t>& twins,
                          const FaceOrigins& origins) {
  Block& block = blocks_[number];
  const auto& splits = forest_.splitsInPreorder();
  StaticRing ring;
  RingWalkSpace space;
  CutSymbols symbols;
  std::vector<NodeId> entries;
  const auto keyOf = [&](uint32_t face) {
    const ForestNode creator = origins.creator[face];
    if (creator == kNoNode) return FaceKey::ofBase(baseIndex_.at(face));
    return FaceKey::of(forest_.id(creator),
                       origins.rightFace[creator - forest_.leafCount()] == face);
  };
  const size_t end = std::min<size_t>(splits.size(), size_t{number + 1} * kBlock);
  for (size_t i = size_t{number} * kBlock; i < end; ++i) {
    walkStaticRing(splits[i], input_.triangles, twins, forest_, origins, ring);
    entries.clear();
    for (const uint32_t leaf : ring.leaves) entries.push_back(forest_.id(leaf));
    CutRecorder recorder(symbols);
    walkRing(
        std::span<const NodeId>(entries), [&](uint32_t gap) { return keyOf(ring.gaps[gap]); },
        recorder, RingCut{0, ring.right, true}, space);
    block.statistics.add(symbols);
    block.cuts.append(symbols);
  }
}

void MeshCoder::collectCuts() {
  const auto twins = twinsOf(input_.triangles, forest_.leafCount());
  const uint32_t splits = forest_.splitCount();
  blocks_.resize((splits + kBlock - 1) / kBlock);
  std::atomic<uint32_t> nextBlock = 0;
  const auto work = [&](bool reporting) {
    for (uint32_t block = nextBlock++; block < blocks_.size(); block = nextBlock++) {
      walkBlock(block, twins, origins_);
      if (reporting && progress_) progress_(uint64_t{block} * kBlock, 2 * uint64_t{splits});
    }
  };
  std::vector<std::thread> others;
  for (unsigned i = 1; i < threads_; ++i) others.emplace_back(work, false);
  work(true);
  for (auto& thread : others) thread.join();
}

template <typename Visit>
void MeshCoder::forEachSplit(const Visit& visit) {
  const auto& splits = forest_.splitsInPreorder();
  const uint32_t leaves = forest_.leafCount();
  const uint32_t roots = forest_.realRootCount();
  std::vector<GridPosition> rootPositions;
  for (const auto& root : base_.roots) rootPositions.push_back(root.position);
  const auto rootNormals = baseNormals(rootPositions, base_.triangles);
  std::vector<PredictedNormal> normals(forest_.splitCount());
  for (uint32_t tree = 0; tree < roots; ++tree)
    if (!forest_.isLeaf(forest_.roots()[tree]))
      normals[forest_.roots()[tree] - leaves] = rootNormals[tree];
  for (uint32_t i = 0; i < splits.size(); ++i) {
    const ForestNode node = splits[i];
    const ForestNode u = forest_.left(node);
    const ForestNode t = forest_.right(node);
    const PredictedNormal normal = normals[node - leaves];
    GridPosition delta{};
    for (size_t k = 0; k < 3; ++k)
      delta[k] = input_.positions[forest_.vertex(t)][k] - input_.positions[forest_.vertex(node)][k];
    const PredictedNormal below = normalAfter(normal, delta);
    Split split;
    split.level = forest_.level(node);
    Record& record = split.record;
    record.leftIsLeaf = forest_.isLeaf(u);
    record.rightIsLeaf = forest_.isLeaf(t);
    if (!record.leftIsLeaf) {
      record.leftLevel = static_cast<uint8_t>(forest_.level(u));
      normals[u - leaves] = below;
    }
    if (!record.rightIsLeaf) {
      record.rightLevel = static_cast<uint8_t>(forest_.level(t));
      normals[t - leaves] = below;
    }
    const unsigned a = mainAxis(normal);
    record.deltaB = delta[(a + 1) % 3];
    record.deltaC = delta[(a + 2) % 3];
    record.residualA = delta[a] - predictedAlong(normal, a, record.deltaB, record.deltaC);
    visit(i, split);
  }
}

void MeshCoder::trainTables() {
  CutStatistics cutStatistics;
  for (const Block& block : blocks_) cutStatistics.add(block.statistics);
  cutStatistics.train(tables_);
  tables_.valueClasses = 2 * input_.quantizationBits;

  // Lengths of the cut regions, now that their codes are known.
  std::vector<uint16_t> cutBits(forest_.splitCount());
  CutBits bits;
  CutSymbols symbols;
  size_t split = 0;
  for (uint32_t b = 0; b < blocks_.size(); ++b) {
    size_t position = 0;
    for (; split < std::min<size_t>(cutBits.size(), size_t{b + 1} * kBlock); ++split) {
      blocks_[b].cuts.read(position, symbols);
      writeCut(bits, symbols, tables_);
      cutBits[split] = static_cast<uint16_t>(bits.length());
      out_.bits.cutCode += bits.length();
    }
  }

  const size_t joint = size_t{tables_.valueClasses} * tables_.valueClasses;
  std::array<std::vector<uint64_t>, 4> lengthHistogram;
  for (auto& h : lengthHistogram)
    h.assign(cutBits.empty() ? 1 : *std::max_element(cutBits.begin(), cutBits.end()) + size_t{1},
             0);
  std::array<std::vector<uint64_t>, kLevelContexts> levels;
  std::array<std::vector<uint64_t>, kLevelContexts> classes;
  std::array<std::vector<uint64_t>, kResidualContexts> residual;
  std::array<std::vector<uint64_t>, kLevelContexts> levelPairs;
  for (auto& h : levels) h.assign(kLevelCount, 0);
  for (auto& h : levelPairs) h.assign(kLevelCount * kLevelCount, 0);
  for (auto& h : classes) h.assign(joint, 0);
  for (auto& h : residual) h.assign(tables_.residualClasses(), 0);
  forEachSplit([&](uint32_t i, const Split& s) {
    const Record& r = s.record;
    const unsigned context = tables_.levelContext(s.level);
    ++lengthHistogram[leafFlagsOf(r)][cutBits[i]];
    const unsigned flags = leafFlagsOf(r);
    if (flags == 0) ++levelPairs[context][levelPairSymbol(r, s.level)];
    if (flags == 1 || flags == 2) ++levels[context][levelSymbol(r, s.level)];
    const unsigned b = valueClassOf(r.deltaB);
    const unsigned c = valueClassOf(r.deltaC);
    ++classes[context][b * tables_.valueClasses + c];
    ++residual[CodeTables::residualContext(std::max(b, c), context)][valueClassOf(r.residualA)];
  });
  for (size_t flags = 0; flags < 4; ++flags)
    tables_.cutLengths[flags] = chooseCutLengths(lengthHistogram[flags], kMaxCutClasses);
  const auto train = [](auto& codes, const auto& counts) {
    for (size_t i = 0; i < codes.size(); ++i) codes[i] = HuffmanCode::fromCounts(counts[i]);
  };
  train(tables_.levels, levels);
  train(tables_.levelPairs, levelPairs);
  train(tables_.classes, classes);
  train(tables_.residual, residual);

  std::array<std::vector<uint64_t>, kLevelContexts> headers;
  for (auto& h : headers) h.assign(tables_.headerSymbols(), 0);
  std::array<std::array<double, 4>, kLevelContexts> flagCounts{};
  forEachSplit([&](uint32_t i, const Split& s) {
    const unsigned flags = leafFlagsOf(s.record);
    const auto& lengths = tables_.cutLengths[flags];
    const auto length = std::lower_bound(lengths.begin(), lengths.end(), cutBits[i]);
    const unsigned context = tables_.levelContext(s.level);
    ++headers[context]
             [tables_.headerSymbol(flags, static_cast<unsigned>(length - lengths.begin()))];
    ++flagCounts[context][flags];
  });
  train(tables_.header, headers);
  for (const auto& counts : flagCounts) {
    const double sum = counts[0] + counts[1] + counts[2] + counts[3];
    for (const double count : counts)
      if (count > 0) out_.bits.leafFlags += count * std::log2(sum / count);
  }
}

void MeshCoder::writeChunks() {
  struct Band {
    BitWriter records;
    std::vector<RecordEntry> entries;
    std::vector<std::vector<uint8_t>> chunks;
    std::vector<NodeId> firstNodes;
  };
  std::vector<Band> bands(tables_.maxLevel + 1);
  const auto flush = [&](unsigned number) {
    Band& band = bands[number];
    if (band.entries.empty()) return;
    band.firstNodes.push_back(band.entries.front().id);
    band.chunks.push_back(encodeChunk(number, band.entries, band.records.take()));
    band.entries.clear();
  };
  FieldBits& sums = out_.bits;
  sums.splits = forest_.splitCount();
  CutBits bits;
  CutSymbols symbols;
  size_t position = 0;
  forEachSplit([&](uint32_t i, const Split& s) {
    if (i % kBlock == 0) {
      position = 0;
      if (progress_) progress_(uint64_t{sums.splits} + i, 2 * sums.splits);
    }
    blocks_[i / kBlock].cuts.read(position, symbols);
    writeCut(bits, symbols, tables_);
    const Record& r = s.record;
    const unsigned flags = leafFlagsOf(r);
    const auto& lengths = tables_.cutLengths[flags];
    const auto length =
        std::lower_bound(lengths.begin(), lengths.end(), std::max<uint64_t>(bits.length(), 1));
    const auto cutClass = static_cast<unsigned>(length - lengths.begin());

    Band& band = bands[s.level];
    const uint64_t begin = band.records.bitCount();
    writeRecordHead(band.records, r, cutClass, tables_, s.level);
    appendRegion(band.records, bits, *length);
    const NodeId id = forest_.id(forest_.splitsInPreorder()[i]);
    band.entries.push_back({id, static_cast<uint8_t>(s.level), r.leftIsLeaf, r.rightIsLeaf,
                            r.leftLevel, r.rightLevel,
                            static_cast<uint32_t>(band.records.bitCount() - begin), begin});
    if (band.entries.size() == kRecordsPerChunk) flush(s.level);

    const unsigned context = tables_.levelContext(s.level);
    sums.header += tables_.header[context].length(tables_.headerSymbol(flags, cutClass));
    if (flags == 0)
      sums.significance += tables_.levelPairs[context].length(levelPairSymbol(r, s.level));
    if (flags == 1 || flags == 2)
      sums.significance += tables_.levels[context].length(levelSymbol(r, s.level));
    const unsigned b = valueClassOf(r.deltaB);
    const unsigned c = valueClassOf(r.deltaC);
    const unsigned a = valueClassOf(r.residualA);
    sums.positionClasses +=
        tables_.classes[context].length(b * tables_.valueClasses + c) +
        tables_.residual[CodeTables::residualContext(std::max(b, c), context)].length(a);
    sums.positionValues += valueBits(r.deltaB) + valueBits(r.deltaC) + valueBits(r.residualA);
    sums.cutPadding += *length - bits.length();
  });
  ChunkIndex index;
  for (unsigned b = 0; b < bands.size(); ++b) {
    flush(b);
    index.firstNodes.push_back(std::move(bands[b].firstNodes));
    std::move(bands[b].chunks.begin(), bands[b].chunks.end(), std::back_inserter(out_.chunks));
  }
  out_.chunkIndex = encodeChunkIndex(index);
}

}  // namespace

CodedMesh codeMesh(const CodingInput& input, const VertexForest& forest, unsigned threads,
                   const CodingProgress& progress) {
  return MeshCoder(input, forest, threads, progress).run();
}

}  // namespace meshfront
