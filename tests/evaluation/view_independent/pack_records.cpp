#include "tests/evaluation/view_independent/pack_records.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace meshfront::evaluation {

Result<PackRecords> PackRecords::read(const std::filesystem::path& path) {
  Result<std::shared_ptr<const Pack>> opened = Pack::open(path);
  if (!opened) return tl::unexpected(opened.error());
  PackRecords pack;
  pack.pack_ = std::move(*opened);
  Result<BaseMesh> base = decodeBaseMesh(pack.pack_->base());
  if (!base) return fail(path.string() + ": " + base.error().message);
  pack.base_ = std::move(*base);
  for (uint32_t number = 0; number < pack.metadata().chunkCount; ++number) {
    const Result<std::span<const uint8_t>> bytes = pack.pack_->chunk(number);
    if (!bytes) return tl::unexpected(bytes.error());
    const Result<Chunk> chunk = decodeChunk(*bytes, pack.base_.tables);
    if (!chunk)
      return fail(path.string() + ": chunk " + std::to_string(number) + ": " +
                  chunk.error().message);
    pack.chunks_.push_back(*bytes);
    for (const RecordEntry& entry : chunk->entries) {
      PackRecord& record = pack.records_.emplace_back();
      record.entry = entry;
      record.chunk = number;
    }
  }
  std::sort(pack.records_.begin(), pack.records_.end(),
            [](const PackRecord& a, const PackRecord& b) { return a.entry.id < b.entry.id; });
  for (RecordIndex i = 0; i < pack.records_.size(); ++i) {
    PackRecord& record = pack.records_[i];
    const NodeId& id = record.entry.id;
    if (id.depth == 0) continue;
    record.parent = pack.find(id.parent());
    if (record.parent == kNoRecord) return fail(path.string() + ": a node's parent has no record");
    pack.records_[record.parent].children.at(id.step(id.depth - 1U) ? 1 : 0) = i;
  }
  return pack;
}

RecordIndex PackRecords::find(const NodeId& id) const {
  const auto found = std::lower_bound(
      records_.begin(), records_.end(), id,
      [](const PackRecord& record, const NodeId& wanted) { return record.entry.id < wanted; });
  if (found == records_.end() || found->entry.id != id) return kNoRecord;
  return static_cast<RecordIndex>(found - records_.begin());
}

std::vector<RecordIndex> PackRecords::byLevel() const {
  std::vector<RecordIndex> order(records_.size());
  std::iota(order.begin(), order.end(), RecordIndex{0});
  // Within a level preorder, in which they stand.
  std::stable_sort(order.begin(), order.end(), [this](RecordIndex a, RecordIndex b) {
    return records_[a].entry.level < records_[b].entry.level;
  });
  return order;
}

// --- refining ------------------------------------------------------------------------------------

RefinedPack::RefinedPack(const PackRecords& pack, SelectivelyRefinedMesh mesh)
    : pack_(&pack), mesh_(std::move(mesh)), nodeOf_(pack.records().size(), kNone) {
  for (NodeIndex root = 0; root < pack.base().treeCount(); ++root)
    setRecord(root, pack.find(NodeId::root(root)));
}

Result<RefinedPack> RefinedPack::fromBase(const PackRecords& pack) {
  Result<SelectivelyRefinedMesh> mesh = SelectivelyRefinedMesh::fromBase(pack.base());
  if (!mesh) return tl::unexpected(mesh.error());
  return RefinedPack(pack, std::move(*mesh));
}

void RefinedPack::setRecord(NodeIndex node, RecordIndex record) {
  if (node >= recordOf_.size()) recordOf_.resize(size_t{node} + 1, kNoRecord);
  recordOf_[node] = record;
  if (record != kNoRecord) nodeOf_[record] = node;
}

Result<void> RefinedPack::split(RecordIndex index) {
  const PackRecord& record = pack_->records()[index];
  const NodeIndex node = nodeOf_[index];
  if (node == kNone || !mesh_.isActive(node))
    return fail("a node was to be split that is not active");
  const bool known = mesh_.leftChild(node) != kNone;
  Result<void> done =
      mesh_.split(node, pack_->chunk(record.chunk), record.entry.bitOffset, record.entry.bitLength);
  if (!done || known) return done;
  const NodeIndex left = mesh_.leftChild(node);
  setRecord(left, record.children[0]);
  setRecord(left + 1, record.children[1]);
  return {};
}

Result<void> RefinedPack::splitAll(std::span<const RecordIndex> records) {
  for (const RecordIndex record : records)
    if (Result<void> done = split(record); !done) return done;
  return {};
}

}  // namespace meshfront::evaluation
