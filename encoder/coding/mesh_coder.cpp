#include "encoder/coding/mesh_coder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "encoder/coding/closed_connectivity.h"
#include "encoder/coding/cut_length_classes.h"
#include "encoder/coding/cut_regions.h"
#include "encoder/coding/split_fields.h"
#include "shared/codec/base_connectivity.h"
#include "shared/codec/record.h"

namespace meshfront {
namespace {

constexpr size_t kMaxCutClasses = 10;  // per value of the leaf flags

class MeshCoder {
 public:
  MeshCoder(const CodingInput& input, const VertexForest& forest, unsigned threads,
            const CodingProgress& progress)
      : input_(input), forest_(forest), threads_(std::max(1U, threads)), progress_(progress) {}

  CodedMesh run() {
    makeBase();
    fields_.emplace(input_, forest_, base_);
    cuts_.emplace(input_, forest_, *fields_, origins_, baseNumber_, threads_,
                  [&](uint64_t done) { report(done); });
    origins_ = {};
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
  void trainTables();
  void trainHeaders();
  void writeChunks();
  void addBits(const Record& record, unsigned level, unsigned cutClass, unsigned cutLength);
  // In splits, each of which is passed over four times.
  void report(uint64_t done) const {
    if (progress_) progress_(done, 4 * uint64_t{forest_.splitCount()});
  }

  const CodingInput& input_;
  const VertexForest& forest_;
  unsigned threads_;
  const CodingProgress& progress_;
  CodedMesh out_;
  BaseMesh base_;
  CodeTables tables_;
  FaceOrigins origins_;
  std::unordered_map<uint32_t, uint32_t> baseNumber_;  // of base faces
  std::optional<SplitFields> fields_;
  std::optional<CutRegions> cuts_;
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
    const uint32_t vertex = forest_.vertex(root);
    base_.roots.push_back(
        {input_.positions[vertex], leaf, static_cast<uint8_t>(leaf ? 0 : forest_.level(root)),
         input_.attributes.empty() ? VertexAttributes{} : input_.attributes[vertex]});
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
    baseNumber_[origins_.baseFaces[i]] = found->second;
  }
  const uint32_t roots = forest_.realRootCount();
  for (const Triangle& t : base_.triangles)
    if (t[0] < roots && t[1] < roots && t[2] < roots) ++out_.baseTriangles;
}

void MeshCoder::trainTables() {
  tables_.cutChances = cuts_->chances();
  tables_.valueClasses = 2 * input_.quantizationBits;
  const size_t joint = size_t{tables_.valueClasses} * tables_.valueClasses;
  std::array<std::vector<uint64_t>, 4> lengths;
  std::array<std::vector<uint64_t>, kLevelContexts> levels;
  std::array<std::vector<uint64_t>, kLevelContexts> classes;
  std::array<std::vector<uint64_t>, kResidualContexts> residual;
  std::array<std::vector<uint64_t>, kLevelContexts> levelPairs;
  AttributeStatistics attributes(input_.layout);
  for (auto& h : lengths) h.assign(cuts_->safe() + size_t{1}, 0);
  for (auto& h : levels) h.assign(kLevelCount, 0);
  for (auto& h : levelPairs) h.assign(kLevelCount * kLevelCount, 0);
  for (auto& h : classes) h.assign(joint, 0);
  for (auto& h : residual) h.assign(tables_.residualClasses(), 0);
  for (uint32_t i = 0; i < fields_->size(); ++i) {
    const Record r = fields_->record(i);
    const unsigned level = fields_->level(i);
    const unsigned context = tables_.levelContext(level);
    const unsigned flags = leafFlagsOf(r);
    ++lengths[flags][cuts_->shortest(i)];
    if (flags == 0) ++levelPairs[context][levelPairSymbol(r, level)];
    if (flags == 1 || flags == 2) ++levels[context][levelSymbol(r, level)];
    const unsigned b = valueClassOf(r.deltaB);
    const unsigned c = valueClassOf(r.deltaC);
    ++classes[context][b * tables_.valueClasses + c];
    ++residual[CodeTables::residualContext(std::max(b, c), context)][valueClassOf(r.residualA)];
    attributes.add(r.attributes, context);
  }
  for (size_t flags = 0; flags < 4; ++flags) {
    const bool used =
        std::any_of(lengths[flags].begin(), lengths[flags].end(), [](uint64_t n) { return n > 0; });
    // So that every region has a length to go to.
    if (used) lengths[flags].back() = std::max<uint64_t>(lengths[flags].back(), 1);
    tables_.cutLengths[flags] = chooseCutLengths(lengths[flags], kMaxCutClasses);
  }
  const auto train = [](auto& codes, const auto& counts) {
    for (size_t i = 0; i < codes.size(); ++i) codes[i] = HuffmanCode::fromCounts(counts[i]);
  };
  train(tables_.levels, levels);
  train(tables_.levelPairs, levelPairs);
  train(tables_.classes, classes);
  train(tables_.residual, residual);
  tables_.attributes = attributes.train();
  trainHeaders();
}

void MeshCoder::trainHeaders() {
  std::array<std::vector<uint64_t>, kLevelContexts> headers;
  for (auto& h : headers) h.assign(tables_.headerSymbols(), 0);
  std::array<std::array<double, 4>, kLevelContexts> flagCounts{};
  cuts_->fit(tables_.cutLengths, [&](uint32_t split) { return fields_->leafFlags(split); });
  for (uint32_t i = 0; i < fields_->size(); ++i) {
    const unsigned flags = fields_->leafFlags(i);
    const unsigned context = tables_.levelContext(fields_->level(i));
    ++headers[context][tables_.headerSymbol(flags, cuts_->cutClass(i))];
    ++flagCounts[context][flags];
  }
  for (size_t i = 0; i < headers.size(); ++i)
    tables_.header[i] = HuffmanCode::fromCounts(headers[i]);
  for (const auto& counts : flagCounts) {
    const double sum = counts[0] + counts[1] + counts[2] + counts[3];
    for (const double count : counts)
      if (count > 0) out_.bits.leafFlags += count * std::log2(sum / count);
  }
}

void MeshCoder::addBits(const Record& r, unsigned level, unsigned cutClass, unsigned cutLength) {
  FieldBits& sums = out_.bits;
  const unsigned context = tables_.levelContext(level);
  const unsigned flags = leafFlagsOf(r);
  sums.header += tables_.header[context].length(tables_.headerSymbol(flags, cutClass));
  if (flags == 0)
    sums.significance += tables_.levelPairs[context].length(levelPairSymbol(r, level));
  if (flags == 1 || flags == 2)
    sums.significance += tables_.levels[context].length(levelSymbol(r, level));
  const unsigned a = valueClassOf(r.residualA);
  const unsigned b = valueClassOf(r.deltaB);
  const unsigned c = valueClassOf(r.deltaC);
  sums.positionClasses +=
      tables_.classes[context].length(b * tables_.valueClasses + c) +
      tables_.residual[CodeTables::residualContext(std::max(b, c), context)].length(a);
  sums.positionValues += valueBits(r.deltaB) + valueBits(r.deltaC) + valueBits(r.residualA);
  const AttributeBits attributes = attributeBits(r.attributes, tables_.attributes, context);
  sums.colours += attributes.colour;
  sums.normals += attributes.normal;
  sums.cutRegions += tables_.cutLengths[flags][cutClass];
  sums.cutPadding += tables_.cutLengths[flags][cutClass] - cutLength;
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
  constexpr uint32_t kReportedTogether = 8192;
  out_.bits.splits = forest_.splitCount();
  for (uint32_t i = 0; i < fields_->size(); ++i) {
    if (i % kReportedTogether == 0) report(3 * out_.bits.splits + i);
    const Record r = fields_->record(i);
    const unsigned level = fields_->level(i);
    const unsigned cutClass = cuts_->cutClass(i);
    Band& band = bands[level];
    const uint64_t begin = band.records.bitCount();
    writeRecordHead(band.records, r, cutClass, tables_, level);
    cuts_->append(band.records, i, tables_.cutLengths[leafFlagsOf(r)][cutClass]);
    const NodeId id = forest_.id(forest_.splitsInPreorder()[i]);
    band.entries.push_back({id, static_cast<uint8_t>(level), r.leftIsLeaf, r.rightIsLeaf,
                            r.leftLevel, r.rightLevel,
                            static_cast<uint32_t>(band.records.bitCount() - begin), begin});
    if (band.entries.size() == kRecordsPerChunk) flush(level);
    addBits(r, level, cutClass, cuts_->shortest(i));
  }
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
