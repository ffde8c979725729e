#include "proxy/record_gathering.h"

#include <algorithm>

#include "shared/bits/crc32c.h"

namespace meshfront {
namespace {

constexpr unsigned kMaxRounds = 4 * kMaxDepth;  // more of them only if the cache forgets at once
constexpr size_t kMaxBatch = 32768;             // nodes; any set of them fits into a QUERY
// Of a need and of its copies in a batch and among the fetches under way.
constexpr size_t kNeedBytes = 256;

tl::unexpected<Error> noSuchNode() {
  return fail(ErrorCode::notFound, "no such node, or a leaf, which has no record");
}

bool isTransient(const Error& error) {
  return isAway(error) || error.code == ErrorCode::overloaded;
}

bool sameExpansion(const Expansion& a, const Expansion& b) {
  return a.levels == b.levels && a.significance == b.significance;
}

}  // namespace

Result<Answer> RecordGathering::collect(std::span<const NodeId> wanted,
                                        const Expansion& expansion) {
  for (unsigned round = 0; round < kMaxRounds; ++round) {
    FetchMemory::Share memory = context_.memory.share();
    Needs needs;
    if (auto walked = walk(wanted, expansion, needs, memory); !walked)
      return tl::unexpected(walked.error());
    if (needs.empty()) {
      context_.counters.recordHits.add(records_ - missed_);
      context_.counters.recordMisses.add(missed_);
      Answer answer{out_.take(), records_, missed_};
      appendChecksum(answer.bytes);
      return answer;
    }
    const auto obtained = obtain(needs);
    context_.budget.enforce();
    if (!obtained) return tl::unexpected(obtained.error());
  }
  return fail(ErrorCode::unavailable, "the cache is too small for this request");
}

std::optional<ChildFacts> RecordGathering::find(const NodeId& node, Reader& reader,
                                                BitWriter* out) {
  const Held* held = held_.find(node);
  if (held == nullptr) return reader.find(node, out);
  const FetchedRecords& records = *fetched_[held->fetch];
  const RecordEntry& entry = records.entries[held->entry];
  if (out != nullptr) {
    out->append(records.bytes, entry.bitOffset, entry.bitLength);
    ++missed_;
  }
  return ChildFacts{entry.leftIsLeaf, entry.rightIsLeaf, entry.leftLevel, entry.rightLevel};
}

Result<void> RecordGathering::walk(std::span<const NodeId> wanted, const Expansion& expansion,
                                   Needs& needs, FetchMemory::Share& memory) {
  out_.clear();
  records_ = missed_ = 0;
  Reader reader(context_.cache);
  Result<void> status;
  walkRequest(
      wanted, expansion,
      [&](const NodeId& node, const Expansion& rest) -> std::optional<ChildFacts> {
        const auto facts = find(node, reader, &out_);
        if (!facts) {
          status = note(node, rest, reader, needs, memory);
        } else if (++records_ > limits_.maxRecords || out_.bitCount() / 8 > limits_.maxBytes) {
          status = fail(ErrorCode::tooLarge, "the answer would be too large; ask for fewer nodes");
        }
        return facts;
      },
      [&] { return !status; });
  return status;
}

Result<void> RecordGathering::note(const NodeId& node, const Expansion& rest, Reader& reader,
                                   Needs& needs, FetchMemory::Share& memory) {
  if (!memory.take(kNeedBytes)) return noFetchMemory();
  NodeId top = node;
  while (true) {
    Need need{top == node ? rest : Expansion{}, 0};
    if (top.depth == 0) {
      if (top.tree >= context_.roots.size() || context_.roots[top.tree].isLeaf) return noSuchNode();
      need.level = context_.roots[top.tree].level;
    } else {
      const auto above = find(top.parent(), reader, nullptr);
      if (!above) {
        top = top.parent();
        continue;
      }
      const bool right = top.step(top.depth - 1U);
      if (above->isLeaf(right)) return noSuchNode();
      need.level = above->level(right);
    }
    needs.emplace(top, need);
    return {};
  }
}

Result<void> RecordGathering::obtain(const Needs& needs) {
  std::set<FetchesUnderWay::Fetch> others;
  std::vector<Batch> batches = claim(needs, others);
  Result<void> status;
  for (Batch& batch : batches) {
    // After a failure the rest is settled too: others may be waiting for it.
    Result<SharedRecords> records =
        status ? fetch(batch, needs) : Result<SharedRecords>(tl::unexpected(status.error()));
    if (records && status) {
      status = hold(*records);
    } else if (status) {
      status = tl::unexpected(records.error());
    }
    settle(batch, records);
  }
  if (!status) return status;
  context_.counters.sharedFetches.add(others.size());
  for (const auto& other : others) {
    const Result<SharedRecords>& records = other->get();
    if (records) status = hold(*records);
    // Another error may concern the other request alone: the next round asks for itself.
    if (!records && isTransient(records.error())) status = tl::unexpected(records.error());
    if (!status) return status;
  }
  return {};
}

std::vector<RecordGathering::Batch> RecordGathering::claim(
    const Needs& needs, std::set<FetchesUnderWay::Fetch>& others) {
  std::vector<Batch> batches;
  const auto batchFor = [&](const NodeId& node, const Expansion& rest) -> Batch& {
    for (Batch& batch : batches)
      if (sameExpansion(batch.expansion, rest) && batch.nodes.size() < kMaxBatch &&
          !batch.nodes.back().isAncestorOf(node))
        return batch;
    return batches.emplace_back(Batch{rest, {}, {}});
  };
  const std::scoped_lock lock(context_.underWay.mutex);
  Reader reader(context_.cache);
  for (const auto& [node, need] : needs) {
    const auto it = context_.underWay.nodes.find(node);
    if (it != context_.underWay.nodes.end()) {
      others.insert(it->second);
    } else if (!reader.find(node, nullptr)) {  // else it has arrived since the walk
      batchFor(node, need.rest).nodes.push_back(node);
    }
  }
  for (Batch& batch : batches) {
    const auto fetch = std::make_shared<const std::shared_future<Result<SharedRecords>>>(
        batch.promise.get_future().share());
    for (const NodeId& node : batch.nodes) context_.underWay.nodes.emplace(node, fetch);
  }
  return batches;
}

Result<SharedRecords> RecordGathering::fetch(const Batch& batch, const Needs& needs) {
  return context_.fetcher.fetch(
      batch.nodes, batch.expansion, context_.tables,
      [&](const NodeId& node) -> std::optional<unsigned> {
        const auto it = needs.find(node);
        if (it == needs.end()) return std::nullopt;
        return it->second.level;
      },
      limits_);
}

void RecordGathering::settle(Batch& batch, const Result<SharedRecords>& records) {
  // Descendants first: who finds a record meanwhile finds all that came with it below, and does not
  // ask for that once more.
  if (records)
    for (auto entry = (*records)->entries.rbegin(); entry != (*records)->entries.rend(); ++entry)
      context_.cache.insert(*entry, (*records)->bytes);
  {
    const std::scoped_lock lock(context_.underWay.mutex);
    for (const NodeId& node : batch.nodes) context_.underWay.nodes.erase(node);
  }
  batch.promise.set_value(records);
}

Result<void> RecordGathering::hold(const SharedRecords& records) {
  // Twice, because the table is copied when it grows.
  if (!memory_.take(records->entries.size() * 2 * NodeTable<Held>::kBytesPerEntry))
    return noFetchMemory();
  const auto fetch = static_cast<uint32_t>(fetched_.size());
  fetched_.push_back(records);
  for (uint32_t i = 0; i < records->entries.size(); ++i)
    held_.insert(records->entries[i].id, Held{fetch, i});
  return {};
}

}  // namespace meshfront
