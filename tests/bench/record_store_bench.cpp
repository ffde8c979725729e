// How fast the service finds records: from the octets of a request's set to the bytes of its
// answer, in one thread, with all chunks indexed.
//
//   record-store-bench PACK [options of Google Benchmark]
//
// The sets are those of a receiver that refines the whole mesh: of its front the first nodes by
// significance, 2,000 a request. items_per_second counts node IDs.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "shared/bits/base64url.h"
#include "shared/codec/base_mesh.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/split_request.h"
#include "shared/store/pack_store.h"

namespace meshfront {
namespace {

struct Request {
  std::string ids;  // as it stands in a URL
  size_t count = 0;
};

struct Bench {
  std::shared_ptr<PackStore> store;
  std::vector<Request> requests;
};

// Every record's node with its children's facts, by level and then in preorder.
Result<std::map<NodeId, RecordEntry>> recordsOf(const Pack& pack) {
  const auto base = decodeBaseMesh(pack.base());
  if (!base) return tl::unexpected(base.error());
  std::map<NodeId, RecordEntry> records;
  for (uint32_t i = 0; i < pack.metadata().chunkCount; ++i) {
    const auto bytes = pack.chunk(i);
    if (!bytes) return tl::unexpected(bytes.error());
    const auto chunk = decodeChunk(*bytes, base->tables);
    if (!chunk) return tl::unexpected(chunk.error());
    for (const RecordEntry& entry : chunk->entries) records.emplace(entry.id, entry);
  }
  return records;
}

Result<std::vector<Request>> requestsOf(const Pack& pack, size_t batch) {
  const auto records = recordsOf(pack);
  if (!records) return tl::unexpected(records.error());
  std::multimap<unsigned, NodeId> front;  // by level
  for (const auto& [id, entry] : *records)
    if (id.depth == 0) front.emplace(entry.level, id);
  std::vector<Request> requests;
  while (!front.empty()) {
    std::vector<NodeId> wanted;
    while (!front.empty() && wanted.size() < batch) {
      wanted.push_back(front.begin()->second);
      front.erase(front.begin());
    }
    for (const NodeId& node : wanted)
      for (const bool right : {false, true})
        if (const auto child = records->find(node.child(right)); child != records->end())
          front.emplace(child->second.level, child->first);
    std::sort(wanted.begin(), wanted.end());
    const auto bitstring = encodeTreeBitstring(wanted);
    if (!bitstring) return tl::unexpected(bitstring.error());
    requests.push_back({base64urlEncode(*bitstring), wanted.size()});
  }
  return requests;
}

Result<Bench> prepare(const char* path) {
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  auto requests = requestsOf(**pack, 2000);
  if (!requests) return tl::unexpected(requests.error());
  return Bench{std::make_shared<PackStore>(*pack, std::make_shared<MemoryBudget>(size_t{4} << 30)),
               std::move(*requests)};
}

void answer(benchmark::State& state, Bench& bench) {
  size_t next = 0;
  int64_t ids = 0;
  int64_t bytes = 0;
  const unsigned maxLevel = bench.store->maxLevel().value_or(0);
  for ([[maybe_unused]] auto _ : state) {
    const Request& request = bench.requests[next];
    next = next + 1 == bench.requests.size() ? 0 : next + 1;
    const auto set = parseSplitUrl(request.ids, false, {}, maxLevel, size_t{1} << 18);
    if (!set) return state.SkipWithError(set.error().message.c_str());
    const auto found = bench.store->collect(set->wanted, set->expansion, {}, Waiting::refused);
    if (!found) return state.SkipWithError(found.error().message.c_str());
    benchmark::DoNotOptimize(found->bytes.data());
    ids += static_cast<int64_t>(request.count);
    bytes += static_cast<int64_t>(found->bytes.size());
  }
  state.SetItemsProcessed(ids);
  state.SetBytesProcessed(bytes);
}

void decodeOnly(benchmark::State& state, Bench& bench) {
  size_t next = 0;
  int64_t ids = 0;
  for ([[maybe_unused]] auto _ : state) {
    const Request& request = bench.requests[next];
    next = next + 1 == bench.requests.size() ? 0 : next + 1;
    const auto set = parseSplitUrl(request.ids, false, {}, 0, size_t{1} << 18);
    benchmark::DoNotOptimize(set->wanted.data());
    ids += static_cast<int64_t>(request.count);
  }
  state.SetItemsProcessed(ids);
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    std::fprintf(stderr, "usage: record-store-bench PACK [options of Google Benchmark]\n");
    return 2;
  }
  auto bench = meshfront::prepare(argv[1]);
  if (!bench) {
    std::fprintf(stderr, "%s: %s\n", argv[1], bench.error().message.c_str());
    return 1;
  }
  std::printf("%zu requests\n", bench->requests.size());
  benchmark::RegisterBenchmark("parse the set", [&](auto& state) {
    meshfront::decodeOnly(state, *bench);
  })->MinWarmUpTime(0.5);
  benchmark::RegisterBenchmark("parse, find and copy", [&](auto& state) {
    meshfront::answer(state, *bench);
  })->MinWarmUpTime(0.5);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
