#include "tests/evaluation/sender_driven/sender_model.h"

#include <algorithm>
#include <numeric>

#include "shared/bits/bit_writer.h"
#include "tests/evaluation/sender_driven/full_decoding.h"

namespace meshfront::evaluation {

Result<SenderModel> SenderModel::load(const Pack& pack) {
  std::vector<std::span<const uint8_t>> chunks;
  for (uint32_t i = 0; i < pack.metadata().chunkCount; ++i) {
    const auto chunk = pack.chunk(i);
    if (!chunk) return tl::unexpected(chunk.error());
    chunks.push_back(*chunk);
  }
  return load(pack.metadata().quantization, pack.base(), chunks);
}

Result<SenderModel> SenderModel::load(const Quantization& quantization,
                                      std::span<const uint8_t> base,
                                      std::span<const std::span<const uint8_t>> chunks) {
  SenderModel model;
  model.quantization_ = quantization;
  model.baseBytes_.assign(base.begin(), base.end());
  auto decoded = decodeBaseMesh(base);
  if (!decoded) return tl::unexpected(decoded.error());
  model.base_ = std::move(*decoded);
  auto decoding = FullDecoding::of(model.base_, chunks);
  if (!decoding) return tl::unexpected(decoding.error());
  const std::vector<DecodedRecord>& records = decoding->records();
  if (records.size() >= kNoNode) return fail(ErrorCode::tooLarge, "too many nodes");

  std::vector<uint32_t> order(records.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return records[a].entry.id < records[b].entry.id; });
  // Chunks go by level, so that the place of a record among them is its tag.
  for (size_t i = 0; i < records.size(); ++i)
    while (model.levelTags_.size() <= records[i].entry.level)
      model.levelTags_.push_back(static_cast<uint32_t>(i));
  model.levelTags_.push_back(static_cast<uint32_t>(records.size()));

  BitWriter bits;
  for (const uint32_t i : order) {
    const DecodedRecord& record = records[i];
    const RecordEntry& entry = record.entry;
    const auto node = static_cast<uint32_t>(model.ids_.size());
    if (entry.id.depth == 0) model.roots_.push_back(node);
    model.ids_.push_back(entry.id);
    model.maxDepth_ = std::max<unsigned>(model.maxDepth_, entry.id.depth);
    model.facts_.push_back(
        {i, kNoNode, entry.level,
         static_cast<uint8_t>((entry.leftIsLeaf ? 2 : 0) | (entry.rightIsLeaf ? 1 : 0))});
    model.recordBegins_.push_back(bits.bitCount());
    bits.append(chunks[record.chunk], entry.bitOffset, entry.bitLength);
  }
  model.recordBegins_.push_back(bits.bitCount());
  model.recordBytes_ = bits.take();
  model.recordBytes_.resize(model.recordBytes_.size() + 8);  // readable whole words at a time

  // Children come behind their parents: from the back everything below is known.
  model.criteria_.resize(order.size());
  std::vector<NodeExtent> extents(order.size());
  for (auto node = static_cast<uint32_t>(order.size()); node-- > 0;) {
    const DecodedRecord& record = records[order[node]];
    ViewCriteria& criteria = model.criteria_[node];
    criteria.error = record.error;
    criteria.end = node + 1;
    for (const bool right : {false, true}) {
      const uint32_t child = right ? model.rightChild(node) : model.leftChild(node);
      if (child == kNoNode) {
        extents[node].join(decoding->leafExtent(record, right));
        continue;
      }
      model.facts_[child].parent = node;
      extents[node].join(extents[child]);
      criteria.error = std::max(criteria.error, model.criteria_[child].error);
      criteria.end = model.criteria_[child].end;
    }
    extents[node].writeTo(criteria);
  }
  return model;
}

uint32_t SenderModel::find(const NodeId& id) const {
  const auto place = std::lower_bound(ids_.begin(), ids_.end(), id);
  if (place == ids_.end() || *place != id) return kNoNode;
  return static_cast<uint32_t>(place - ids_.begin());
}

size_t SenderModel::memoryBytes() const {
  return criteria_.capacity() * sizeof(ViewCriteria) + facts_.capacity() * sizeof(Facts) +
         ids_.capacity() * sizeof(NodeId) + recordBegins_.capacity() * sizeof(uint64_t) +
         recordBytes_.capacity() + (roots_.capacity() + levelTags_.capacity()) * sizeof(uint32_t) +
         baseBytes_.capacity();
}

}  // namespace meshfront::evaluation
