#include <mutex>

#include "proxy/cached_catalogue.h"
#include "shared/bits/crc32c.h"
#include "shared/store/mesh_metadata.h"
#include "tests/fuzz/fuzz_bases.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

constexpr std::array kStatuses{200U, 304U, 404U, 413U, 500U, 503U, 206U, 504U};
constexpr uint8_t kChecksumFlag = 8;
constexpr uint8_t kBaseFlag = 16;
constexpr size_t kMostRecords = 1000;

// Answers with what the input holds, one after the other; away when that is used up.
class FuzzedUpstream final : public Upstream {
 public:
  explicit FuzzedUpstream(Bytes input) : in_(input) {}
  Result<UpstreamResponse> send(const UpstreamRequest& request) override {
    const std::scoped_lock lock(mutex_);
    if (in_.empty()) return fail(ErrorCode::unavailable, "away");
    UpstreamResponse response;
    const uint8_t flags = in_.byte();
    response.status = kStatuses[flags % kStatuses.size()];
    response.etag = in_.line();
    response.cacheControl = in_.line();
    response.age = ageOf(std::string(in_.line()));
    const size_t length = in_.word();
    const Bytes content = in_.take((flags & kBaseFlag) != 0 ? 0 : length);
    response.content.assign(content.begin(), content.end());
    if ((flags & kBaseFlag) != 0) response.content = encodeBaseMesh(baseOf(length));
    if ((flags & kChecksumFlag) != 0) appendChecksum(response.content);
    if (response.content.size() > request.maxBytes) return fail(ErrorCode::tooLarge, "long");
    if (request.memory != nullptr) {
      response.memory = request.memory->share();
      if (!response.memory.take(response.content.size())) return noFetchMemory();
    }
    return response;
  }

 private:
  std::mutex mutex_;
  FuzzInput in_;
};

std::string_view asText(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool checkAnswer(RecordStore& store, const BaseMesh& base, const Expansion& expansion) {
  std::vector<NodeId> wanted;
  for (uint32_t tree = 0; tree < base.roots.size() && wanted.size() < 3; ++tree)
    if (!base.roots[tree].isLeaf) wanted.push_back(NodeId::root(tree));
  if (wanted.empty()) return false;
  CollectLimits limits;
  limits.maxRecords = kMostRecords;
  const auto answer = store.collect(wanted, expansion, limits, Waiting::allowed);
  if (!answer) return false;
  promise(answer->records <= kMostRecords, "limits are kept");
  const auto levelOf = [&](const NodeId& node) -> std::optional<unsigned> {
    return base.roots[node.tree].level;
  };
  const auto entries = parseAnswer(answer->bytes, wanted, expansion, base.tables, levelOf);
  promise(entries && entries->size() == answer->records, "an answer holds what was asked for");
  const auto again = store.collect(wanted, expansion, limits, Waiting::allowed);
  promise(!again || again->bytes == answer->bytes, "records stay what they are");
  return true;
}

bool useStore(RecordStore& store) {
  const auto bytes = store.base(Waiting::allowed);
  if (!bytes) return false;
  const auto base = decodeBaseMesh(bytes->bytes());
  if (!base) return false;  // fetched anew: then only its checksum is looked at
  bool accepted = checkAnswer(store, *base, {});
  Expansion levels;
  levels.levels = 2;
  accepted = checkAnswer(store, *base, levels) || accepted;
  for (const auto& constant :
       {store.chunkIndex(Waiting::allowed), store.chunk(1, Waiting::allowed)})
    promise(!constant || checkedContent(constant->bytes(), "constant").has_value(),
            "constants are sound");
  promise(!store.age() || store.age()->count() >= 0, "time goes on");
  return accepted;
}

}  // namespace

bool readUpstream(Bytes input) {
  FuzzedUpstream upstream(input);
  Metrics metrics;
  ProxyCounters counters(metrics);
  MemoryBudget budget(size_t{1} << 16);
  FetchMemory memory(size_t{1} << 20);
  std::atomic<DocumentCache::Clock::time_point> now{DocumentCache::Clock::time_point{}};
  {
    DocumentCache documents(
        upstream, budget, memory, counters,
        {.refreshWait = std::chrono::hours(1), .now = [&now] { return now.load(); }});
    CachedCatalogue catalogue({upstream, documents, budget, memory, counters});
    bool accepted = false;
    const auto opened = catalogue.open("torus", std::string(32, 'a'), Waiting::allowed);
    if (opened) accepted = useStore(**opened);
    for (int i = 0; i < 2; ++i) {  // the second time both are old
      const auto list = catalogue.list(Waiting::allowed);
      promise(!list || (asText(list->json.bytes()).find("meshes") != std::string_view::npos &&
                        list->age->count() >= 0),
              "a catalogue is one");
      const auto mesh = catalogue.describe("torus", Waiting::allowed);
      promise(!mesh || metadataFromJson(asText(mesh->json.bytes())).has_value(),
              "metadata are sound");
      accepted = accepted || list || mesh;
      now = now.load() + std::chrono::hours(24 * 400);
    }
    promise(budget.bytes() <= budget.limit(), "the cache keeps its budget");
    return accepted;
  }
}

}  // namespace meshfront::fuzz
