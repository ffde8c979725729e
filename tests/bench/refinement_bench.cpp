// How fast a mesh is refined in one thread: splits a second from bytes as they come over the wire,
// parsing, decoding and applying together; then collapses and splits from kept records.
//
//   refinement-bench igea.pack gcanyon.pack [--runs 5]
//
// Beside them a plain iteration, which reads and writes once, in order, all bytes that the full
// mesh holds: what the machine's memory allows. Times are the processor's; the best run is told.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include "shared/bits/bit_store.h"
#include "shared/bits/crc32c.h"
#include "shared/codec/answer.h"
#include "shared/codec/chunk.h"
#include "shared/refinement/split_records.h"
#include "shared/store/pack.h"

namespace meshfront {
namespace {

constexpr size_t kAnswerRecords = 2'000;  // of a receiver well under way
constexpr size_t kUpdateSplits = 20'000;  // between two updates for a drawer

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct WireAnswer {
  std::vector<NodeId> wanted;
  std::vector<uint8_t> bytes;
};

struct RefinementBench {
  std::vector<uint8_t> base;
  std::vector<std::vector<uint8_t>> chunks;
  std::vector<WireAnswer> answers;  // level by level, each in preorder
};

Result<SelectivelyRefinedMesh> freshMesh(const RefinementBench& bench) {
  auto base = decodeBaseMesh(bench.base);
  if (!base) return tl::unexpected(base.error());
  return SelectivelyRefinedMesh::fromBase(std::move(*base));
}

// The answers to a receiver that sees the whole mesh and ranks by significance.
Result<void> rankAnswers(RefinementBench& bench) {
  auto base = decodeBaseMesh(bench.base);
  if (!base) return tl::unexpected(base.error());
  struct Located {
    RecordEntry entry;
    uint32_t chunk = 0;
  };
  std::vector<Located> records;
  for (uint32_t i = 0; i < bench.chunks.size(); ++i) {
    const auto chunk = decodeChunk(bench.chunks[i], base->tables);
    if (!chunk) return tl::unexpected(chunk.error());
    for (const RecordEntry& entry : chunk->entries) records.push_back({entry, i});
  }
  // Within a level parents come first, and nodes of one depth are asked for together.
  std::sort(records.begin(), records.end(), [](const Located& a, const Located& b) {
    if (a.entry.level != b.entry.level) return a.entry.level < b.entry.level;
    if (a.entry.id.depth != b.entry.id.depth) return a.entry.id.depth < b.entry.id.depth;
    return a.entry.id < b.entry.id;
  });
  for (size_t i = 0; i < records.size();) {
    // No node of an answer is below another one.
    size_t end = i;
    while (end < records.size() && end < i + kAnswerRecords &&
           records[end].entry.id.depth == records[i].entry.id.depth &&
           records[end].entry.level == records[i].entry.level)
      ++end;
    WireAnswer answer;
    BitStore bits;
    for (; i < end; ++i) {
      answer.wanted.push_back(records[i].entry.id);
      bits.append(bench.chunks[records[i].chunk], records[i].entry.bitOffset,
                  records[i].entry.bitLength);
    }
    answer.bytes.assign(bits.bytes().begin(), bits.bytes().end());
    appendChecksum(answer.bytes);
    bench.answers.push_back(std::move(answer));
  }
  return {};
}

Result<RefinementBench> prepare(const std::string& path) {
  const auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  RefinementBench bench;
  bench.base.assign((*pack)->base().begin(), (*pack)->base().end());
  for (uint32_t i = 0; i < (*pack)->metadata().chunkCount; ++i) {
    const auto chunk = (*pack)->chunk(i);
    if (!chunk) return tl::unexpected(chunk.error());
    bench.chunks.emplace_back(chunk->begin(), chunk->end());
  }
  if (auto ranked = rankAnswers(bench); !ranked) return tl::unexpected(ranked.error());
  return bench;
}

class Drawer {  // takes updates and reads them once
 public:
  explicit Drawer(bool draws) : draws_(draws) {}
  void look(SelectivelyRefinedMesh& mesh) {
    if (!draws_ || mesh.changeCount() - seen_ < kUpdateSplits) return;
    seen_ = mesh.changeCount();
    bytes_ += mesh.takeUpdate().byteCount();
  }

 private:
  bool draws_;
  uint64_t seen_ = 0;
  size_t bytes_ = 0;
};

bool splitChunks(SelectivelyRefinedMesh& mesh, const RefinementBench& bench, Drawer drawer) {
  for (const auto& bytes : bench.chunks) {
    const auto chunk = decodeChunk(bytes, mesh.base().tables);
    if (!chunk || !splitRecords(mesh, chunk->entries, bytes)) return false;
    drawer.look(mesh);
  }
  return true;
}

bool splitAnswers(SelectivelyRefinedMesh& mesh, const RefinementBench& bench, Drawer drawer) {
  for (const WireAnswer& answer : bench.answers) {
    const auto entries = parseAnswer(answer.bytes, answer.wanted, {}, mesh.base().tables,
                                     [&](const NodeId& id) -> std::optional<unsigned> {
                                       const auto node = mesh.find(id);
                                       if (!node) return std::nullopt;
                                       return mesh.level(*node);
                                     });
    if (!entries || !splitRecords(mesh, *entries, answer.bytes)) return false;
    drawer.look(mesh);
  }
  return true;
}

struct Best {
  std::string name;
  double seconds = std::numeric_limits<double>::infinity();
};

class Timings {
 public:
  template <typename Work>
  void time(const char* name, const Work& work) {
    const double start = processorSeconds();
    work();
    const double seconds = processorSeconds() - start;
    for (Best& best : bests_)
      if (best.name == name) {
        best.seconds = std::min(best.seconds, seconds);
        return;
      }
    bests_.push_back({name, seconds});
  }
  void print(double operations) const {
    for (const Best& best : bests_)
      std::printf("  %-46s %8.3f s  %7.3f M/s  %6.1f x plain\n", best.name.c_str(), best.seconds,
                  1e-6 * operations / best.seconds, best.seconds / bests_.front().seconds);
  }

 private:
  std::vector<Best> bests_;
};

// The nodes that are split, parents first.
std::vector<NodeIndex> splitNodes(const SelectivelyRefinedMesh& mesh) {
  std::vector<NodeIndex> out;
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node)
    if (mesh.leftChild(node) != kNone) out.push_back(node);
  return out;
}

bool runOnce(const RefinementBench& bench, Timings& timings) {
  bool fine = true;
  size_t held = 0;
  {
    auto mesh = freshMesh(bench);
    if (!mesh || !splitChunks(*mesh, bench, Drawer(false))) return false;
    held = mesh->memoryBytes();
  }
  std::vector<uint64_t> plain(held / 8, 1);
  timings.time("plain iteration", [&] {
    for (uint64_t& word : plain) word += 3;
  });
  fine = fine && plain[held / 16] == 4;
  timings.time("parse the chunks", [&] {
    const auto base = decodeBaseMesh(bench.base);
    for (const auto& bytes : bench.chunks) fine = fine && decodeChunk(bytes, base->tables);
  });
  for (const bool draws : {false, true}) {
    auto mesh = freshMesh(bench);
    timings.time(draws ? "split chunks in file order, with updates" : "split chunks in file order",
                 [&] { fine = fine && splitChunks(*mesh, bench, Drawer(draws)); });
    fine = fine && mesh->complete();
  }
  auto mesh = freshMesh(bench);
  timings.time("split answers in ranked order",
               [&] { fine = fine && splitAnswers(*mesh, bench, Drawer(false)); });
  fine = fine && mesh->complete();
  const std::vector<NodeIndex> nodes = splitNodes(*mesh);
  timings.time("collapse all, last first", [&] {
    for (size_t i = nodes.size(); i-- > 0;) mesh->collapse(nodes[i]);
  });
  timings.time("split again from kept records", [&] {
    for (const NodeIndex node : nodes) fine = fine && mesh->resplit(node);
  });
  return fine && mesh->complete();
}

bool benchPack(const std::string& path, unsigned runs) {
  const auto bench = prepare(path);
  if (!bench) {
    std::fprintf(stderr, "refinement-bench: %s: %s\n", path.c_str(), bench.error().message.c_str());
    return false;
  }
  Timings timings;
  for (unsigned run = 0; run < runs; ++run)
    if (!runOnce(*bench, timings)) {
      std::fprintf(stderr, "refinement-bench: %s: a damaged pack\n", path.c_str());
      return false;
    }
  const auto base = decodeBaseMesh(bench->base);
  std::printf("%s: %llu splits\n", path.c_str(), static_cast<unsigned long long>(base->splitCount));
  timings.print(static_cast<double>(base->splitCount));
  return true;
}

}  // namespace
}  // namespace meshfront

int main(int argc, char** argv) {
  CLI::App app{"Splits a second of packs' meshes, beside a plain iteration."};
  std::vector<std::string> packs;
  unsigned runs = 5;
  app.add_option("PACK", packs, "packs, as meshfront-encode writes them")->required();
  app.add_option("--runs", runs, "the best of so many is told")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  for (const std::string& pack : packs)
    if (!meshfront::benchPack(pack, runs)) return 1;
  return 0;
}
