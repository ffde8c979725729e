// The proxy's stores over a scripted upstream: what is fetched, how often, and what happens when
// the upstream misbehaves.
#include "proxy/cached_catalogue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "service/pack_catalogue.h"
#include "shared/bits/base64url.h"
#include "shared/bits/crc32c.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/record_service.h"
#include "tests/data/scripted_upstream.h"
#include "tests/data/synthetic_mesh.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

class CachedCatalogueTest : public ::testing::Test {
 protected:
  CachedCatalogueTest() {
    EXPECT_TRUE(writePack(folder_ / "a.pack", mesh_.content));
    auto catalogue =
        PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24));
    EXPECT_TRUE(catalogue);
    origin_ = std::move(*catalogue);
    service_ = std::make_unique<RecordService>(*origin_, originMetrics_, RecordService::Options{});
    upstream_ = std::make_unique<ScriptedUpstream>(*service_);
    restart();
  }
  // An empty proxy over the same upstream.
  void restart(size_t bytes = size_t{64} << 20, size_t fetchMemory = size_t{64} << 20) {
    catalogue_.reset();
    documents_.reset();
    counters_.reset();
    budget_ = std::make_unique<MemoryBudget>(bytes);
    metrics_ = std::make_unique<Metrics>();
    counters_ = std::make_unique<ProxyCounters>(*metrics_);
    memory_ = std::make_unique<FetchMemory>(fetchMemory);
    documents_ = std::make_unique<DocumentCache>(
        *upstream_, *budget_, *memory_, *counters_,
        DocumentCache::Options{.refreshWait = refreshWait_, .now = [this] { return now_.load(); }});
    catalogue_ = std::make_unique<CachedCatalogue>(
        CachedStore::Parts{*upstream_, *documents_, *budget_, *memory_, *counters_});
  }
  std::shared_ptr<RecordStore> store() {
    auto opened = catalogue_->open("synthetic", revisionOf(mesh_.content), Waiting::allowed);
    EXPECT_TRUE(opened) << opened.error().message;
    return opened ? *opened : nullptr;
  }
  Result<Answer> collect(std::span<const NodeId> wanted, const Expansion& expansion = {},
                         Waiting waiting = Waiting::allowed) {
    return store()->collect(wanted, expansion, limits_, waiting);
  }
  void expectRight(std::span<const NodeId> wanted, const Expansion& expansion = {}) {
    const auto answer = collect(wanted, expansion);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->bytes, mesh_.answerTo(wanted, expansion));
  }
  void expectError(const Result<Answer>& answer, ErrorCode code) {
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code) << answer.error().message;
  }
  [[nodiscard]] size_t fetches() const { return upstream_->count("/splits"); }
  static Expansion levels(uint32_t k) {
    Expansion expansion;
    expansion.levels = k;
    return expansion;
  }
  static Expansion significance(uint8_t level) {
    Expansion expansion;
    expansion.significance = level;
    return expansion;
  }

  TemporaryFolder folder_;
  SyntheticMesh mesh_ = makeSyntheticMesh();
  Metrics originMetrics_;
  std::unique_ptr<PackCatalogue> origin_;
  std::unique_ptr<RecordService> service_;
  std::unique_ptr<ScriptedUpstream> upstream_;
  std::atomic<DocumentCache::Clock::time_point> now_{DocumentCache::Clock::time_point{}};
  std::unique_ptr<MemoryBudget> budget_;
  std::unique_ptr<Metrics> metrics_;
  std::unique_ptr<ProxyCounters> counters_;
  std::unique_ptr<FetchMemory> memory_;
  std::chrono::milliseconds refreshWait_ = std::chrono::hours(1);
  std::unique_ptr<DocumentCache> documents_;
  std::unique_ptr<CachedCatalogue> catalogue_;
  CollectLimits limits_;
};

TEST_F(CachedCatalogueTest, FetchesEachGenerationOnce) {
  for (unsigned depth = 0; depth < 12; ++depth) {
    expectRight(mesh_.nodesAtDepth(depth));
    EXPECT_EQ(fetches(), depth + 1);
  }
  for (unsigned depth = 0; depth < 12; ++depth) expectRight(mesh_.nodesAtDepth(depth));
  EXPECT_EQ(fetches(), 12U);
  EXPECT_EQ(counters_->recordHits.value(), mesh_.entries.size());
  EXPECT_EQ(counters_->recordMisses.value(), mesh_.entries.size());
}

TEST_F(CachedCatalogueTest, AnswersCachedSetsWithoutWaiting) {
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  const auto before = collect(roots, {}, Waiting::refused);
  expectError(before, ErrorCode::unavailable);
  EXPECT_EQ(fetches(), 0U);
  expectRight(roots, levels(4));
  for (unsigned depth = 0; depth <= 4; ++depth) {
    const auto wanted = mesh_.nodesAtDepth(depth);
    const auto answer = collect(wanted, levels(4 - depth), Waiting::refused);
    ASSERT_TRUE(answer) << depth;
    EXPECT_EQ(answer->bytes, mesh_.answerTo(wanted, levels(4 - depth)));
  }
  EXPECT_EQ(fetches(), 1U);
}

TEST_F(CachedCatalogueTest, FetchesOnlyWhatLacks) {
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  expectRight(roots);
  std::vector<NodeId> some;
  for (const NodeId& node : mesh_.nodesAtDepth(1))
    if (node.tree % 2 == 0) some.push_back(node);
  expectRight(some);
  EXPECT_EQ(fetches(), 2U);
  expectRight(mesh_.nodesAtDepth(1));
  EXPECT_EQ(fetches(), 3U);
  // Roots and half of their children were known: the last request asks for the other half.
  std::vector<NodeId> rest;
  for (const NodeId& node : mesh_.nodesAtDepth(1))
    if (node.tree % 2 != 0) rest.push_back(node);
  EXPECT_EQ(counters_->recordMisses.value(), roots.size() + some.size() + rest.size());
}

TEST_F(CachedCatalogueTest, FetchesTheRestOfAnExpansionInOneRequest) {
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  expectRight(roots, levels(2));
  expectRight(roots, levels(5));
  EXPECT_EQ(fetches(), 2U);
  expectRight(roots, significance(2));
  EXPECT_LE(fetches(), 3U);
  expectRight(roots, significance(6));
  EXPECT_LE(fetches(), 4U);
  EXPECT_EQ(counters_->recordMisses.value(), mesh_.entries.size());
  expectRight(roots, levels(13));
  EXPECT_LE(fetches(), 4U);
}

TEST_F(CachedCatalogueTest, RecoversDeepNodesAfterARestart) {
  expectRight(mesh_.nodesAtDepth(7));  // eight generations, one request each
  EXPECT_EQ(fetches(), 8U);
  expectRight(mesh_.nodesAtDepth(7));
  for (const unsigned depth : {5U, 2U, 0U}) {  // the ancestors came along
    std::vector<NodeId> above;
    for (const NodeId& node : mesh_.nodesAtDepth(7)) above.push_back(node.ancestor(depth));
    above.erase(std::unique(above.begin(), above.end()), above.end());
    expectRight(above);
  }
  EXPECT_EQ(fetches(), 8U);
}

TEST_F(CachedCatalogueTest, AnswersRandomRequestsUnderAnyBudget) {
  for (const size_t bytes : {size_t{0}, size_t{30000}, size_t{100000}}) {
    restart(bytes);
    std::mt19937 random(3);
    for (int i = 0; i < 60; ++i) {
      std::vector<NodeId> wanted;
      const unsigned depth = random() % 10;
      for (const NodeId& node : mesh_.nodesAtDepth(depth))
        if (random() % 3 == 0) wanted.push_back(node);
      if (wanted.empty()) continue;
      const unsigned kind = random() % 3;
      expectRight(wanted, kind == 0   ? Expansion{}
                          : kind == 1 ? levels(1 + random() % 4)
                                      : significance(static_cast<uint8_t>(random() % 7)));
      EXPECT_LE(budget_->bytes(), bytes);
    }
  }
}

TEST_F(CachedCatalogueTest, RefusesNodesWithoutRecordsItself) {
  expectRight(mesh_.nodesAtDepth(0), levels(12));
  const size_t before = fetches();
  expectError(collect(std::vector{NodeId::root(3)}), ErrorCode::notFound);
  expectError(collect(std::vector{NodeId::root(99)}), ErrorCode::notFound);
  for (const RecordEntry& entry : mesh_.entries)
    if (entry.leftIsLeaf)
      expectError(collect(std::vector{entry.id.child(false).child(true)}), ErrorCode::notFound);
  EXPECT_EQ(fetches(), before);
}

TEST_F(CachedCatalogueTest, SharesFetchesBetweenThreads) {
  expectRight(mesh_.nodesAtDepth(0), levels(5));
  const std::vector<NodeId> wanted = mesh_.nodesAtDepth(6);
  const auto expected = mesh_.answerTo(wanted, {});
  const size_t before = fetches();
  constexpr int kThreads = 8;
  std::atomic<int> started{0};
  upstream_->play([&](const UpstreamRequest&, Result<UpstreamResponse>&) {
    // Holds the first fetch until all have asked, or a while has passed.
    for (int i = 0; i < 500 && started < kThreads; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&] {
      ++started;
      const auto answer = collect(wanted);
      if (!answer || answer->bytes != expected) ++wrong;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(fetches(), before + 1);
}

TEST_F(CachedCatalogueTest, ManyThreadsWithOverlappingSetsFetchNothingTwice) {
  expectRight(mesh_.nodesAtDepth(0), levels(4));
  const std::vector<NodeId> all = mesh_.nodesAtDepth(5);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 6; ++t)
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      for (int i = 0; i < 20; ++i) {
        std::vector<NodeId> wanted;
        for (const NodeId& node : all)
          if (random() % 2 == 0) wanted.push_back(node);
        const auto answer = collect(wanted);
        if (!answer || answer->bytes != mesh_.answerTo(wanted, {})) ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  // Every record of this depth was sent upstream's way once: the nodes of all requests are
  // disjoint.
  std::vector<NodeId> asked;
  for (const UpstreamRequest& request : upstream_->requests()) {
    const size_t at = request.target.find("/splits/");
    if (at == std::string::npos || request.target.find('?') != std::string::npos) continue;
    const auto bits = base64urlDecode(request.target.substr(at + 8));
    ASSERT_TRUE(bits);
    const auto nodes = decodeTreeBitstring(*bits, mesh_.entries.size());
    ASSERT_TRUE(nodes);
    asked.insert(asked.end(), nodes->begin(), nodes->end());
  }
  std::sort(asked.begin(), asked.end());
  EXPECT_TRUE(std::adjacent_find(asked.begin(), asked.end()) == asked.end());
  EXPECT_EQ(asked.size(), all.size());
}

TEST_F(CachedCatalogueTest, NeverKeepsAWrongAnswer) {
  static_cast<void>(store());
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  const std::vector<std::function<void(std::vector<uint8_t>&)>> damages{
      [](std::vector<uint8_t>& bytes) { bytes[bytes.size() / 2] ^= 4; },
      [](std::vector<uint8_t>& bytes) { bytes.pop_back(); },
      [](std::vector<uint8_t>& bytes) { bytes.clear(); },
      [](std::vector<uint8_t>& bytes) { bytes.push_back(0); },
      [this](std::vector<uint8_t>& bytes) {  // sound, but of another set
        bytes = mesh_.answerTo(mesh_.nodesAtDepth(1), {});
      },
  };
  for (const auto& damage : damages) {
    const size_t before = fetches();
    upstream_->play([&](const UpstreamRequest&, Result<UpstreamResponse>& response) {
      damage(response->content);
    });
    expectError(collect(roots), ErrorCode::unavailable);
    EXPECT_EQ(fetches(), before + 2);  // asked once more
  }
  EXPECT_EQ(counters_->wrongAnswers.value(), 2 * damages.size());
  upstream_->play({});
  expectRight(roots);
}

TEST_F(CachedCatalogueTest, AWrongAnswerOnceIsMended) {
  static_cast<void>(store());
  std::atomic<int> calls{0};
  upstream_->play([&](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    if (calls++ == 0) response->content.resize(response->content.size() / 2);
  });
  expectRight(mesh_.nodesAtDepth(0));
  EXPECT_EQ(fetches(), 2U);
}

TEST_F(CachedCatalogueTest, PassesTroubleOnAndForgetsIt) {
  static_cast<void>(store());
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  upstream_->play([](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response = fail(ErrorCode::timedOut, "slow");
  });
  expectError(collect(roots), ErrorCode::timedOut);
  for (const auto& [status, code] :
       {std::pair(404U, ErrorCode::notFound), std::pair(413U, ErrorCode::tooLarge),
        std::pair(500U, ErrorCode::unavailable), std::pair(400U, ErrorCode::unavailable)}) {
    upstream_->play([status = status](const UpstreamRequest&, Result<UpstreamResponse>& response) {
      response->status = status;
    });
    expectError(collect(roots), code);
  }
  upstream_->play({});
  expectRight(roots);
}

TEST_F(CachedCatalogueTest, RefusesWhatTheMemoryForFetchesCannotHold) {
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  const auto everything = levels(12);
  restart(size_t{64} << 20, 16'000);
  ASSERT_TRUE(store());
  expectError(collect(roots, everything), ErrorCode::overloaded);
  EXPECT_EQ(memory_->bytes(), 0U);
  expectRight(std::vector{roots.front()});  // smaller ones go on
  EXPECT_EQ(memory_->bytes(), 0U);
  restart(size_t{64} << 20, size_t{16} << 20);
  expectRight(roots, everything);
  EXPECT_EQ(memory_->bytes(), 0U);
}

TEST_F(CachedCatalogueTest, NeverKeepsTheAnswerToAnotherRequest) {
  static_cast<void>(store());
  // As a cache does that mixed two entries up: sound, with its own entity tag.
  const std::vector<NodeId> roots = mesh_.nodesAtDepth(0);
  upstream_->play([&](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response->etag = "\"00000000-12-00000000\"";
  });
  expectError(collect(roots), ErrorCode::unavailable);
  EXPECT_FALSE(store()->chunk(2, Waiting::allowed));
  upstream_->play([&](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response->etag = "\"" + std::string(32, 'a') + "\"";
  });
  EXPECT_FALSE(catalogue_->describe("synthetic", Waiting::allowed));
  EXPECT_FALSE(catalogue_->list(Waiting::allowed));
  upstream_->play({});
  expectRight(roots);
  EXPECT_TRUE(store()->chunk(2, Waiting::allowed));
  EXPECT_TRUE(catalogue_->describe("synthetic", Waiting::allowed));
}

TEST_F(CachedCatalogueTest, NeverKeepsAConstantThatIsCutWithARightChecksum) {
  const auto opened = store();
  upstream_->play([](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response->content.resize(response->content.size() / 2);
    appendChecksum(response->content);
  });
  EXPECT_FALSE(opened->chunkIndex(Waiting::allowed));
  EXPECT_FALSE(opened->chunk(2, Waiting::allowed));
  upstream_->play({});
  EXPECT_TRUE(opened->chunkIndex(Waiting::allowed));
  EXPECT_TRUE(opened->chunk(2, Waiting::allowed));
}

TEST_F(CachedCatalogueTest, KeepsLimits) {
  limits_.maxRecords = 100;
  expectError(collect(mesh_.nodesAtDepth(0), levels(12)), ErrorCode::tooLarge);
}

TEST_F(CachedCatalogueTest, ServesDocumentsFromTheCache) {
  const auto opened = store();
  for (int i = 0; i < 3; ++i) {
    const auto base = opened->base(i == 0 ? Waiting::allowed : Waiting::refused);
    ASSERT_TRUE(base);
    EXPECT_TRUE(std::ranges::equal(base->bytes(), mesh_.content.base));
    const auto index = opened->chunkIndex(i == 0 ? Waiting::allowed : Waiting::refused);
    ASSERT_TRUE(index);
    EXPECT_TRUE(std::ranges::equal(index->bytes(), mesh_.content.chunkIndex));
    const auto chunk = opened->chunk(2, i == 0 ? Waiting::allowed : Waiting::refused);
    ASSERT_TRUE(chunk);
    EXPECT_TRUE(std::ranges::equal(chunk->bytes(), mesh_.content.chunks[2]));
  }
  EXPECT_EQ(upstream_->count("/base"), 1U);
  EXPECT_EQ(upstream_->count("/chunks"), 2U);
  EXPECT_FALSE(opened->chunk(99999, Waiting::allowed));
  EXPECT_FALSE(opened->chunk(99999, Waiting::allowed));
  EXPECT_EQ(upstream_->count("/chunks/99999"), 1U);  // 404 too is kept for its time
}

TEST_F(CachedCatalogueTest, RevalidatesMetadataWhenItIsOld) {
  ASSERT_TRUE(catalogue_->describe("synthetic", Waiting::allowed));
  now_ = now_.load() + std::chrono::seconds(9);
  const auto fresh = catalogue_->describe("synthetic", Waiting::refused);
  ASSERT_TRUE(fresh);
  EXPECT_EQ(fresh->age, std::chrono::seconds(9));
  now_ = now_.load() + std::chrono::seconds(2);
  EXPECT_FALSE(catalogue_->describe("synthetic", Waiting::refused));
  const auto again = catalogue_->describe("synthetic", Waiting::allowed);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->age, std::chrono::seconds(0));
  const auto requests = upstream_->requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_TRUE(requests[0].ifNoneMatch.empty());
  EXPECT_FALSE(requests[1].ifNoneMatch.empty());
}

TEST_F(CachedCatalogueTest, AnswersOldMetadataWhileTheUpstreamIsAway) {
  ASSERT_TRUE(catalogue_->list(Waiting::allowed));
  now_ = now_.load() + std::chrono::seconds(60);
  upstream_->play([](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response = fail(ErrorCode::unavailable, "away");
  });
  const auto stale = catalogue_->list(Waiting::allowed);
  ASSERT_TRUE(stale);
  EXPECT_EQ(stale->age, std::chrono::seconds(60));
  EXPECT_EQ(counters_->staleDocuments.value(), 1U);
  const auto unknown = catalogue_->describe("synthetic", Waiting::allowed);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::unavailable);
}

TEST_F(CachedCatalogueTest, RefusesDamagedDocuments) {
  upstream_->play([](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response->content[response->content.size() / 2] ^= 1;
  });
  const std::string revision = revisionOf(mesh_.content);
  EXPECT_FALSE(catalogue_->open("synthetic", revision, Waiting::allowed));
  upstream_->play([](const UpstreamRequest&, Result<UpstreamResponse>& response) {
    response->content.resize(response->content.size() / 2);
  });
  EXPECT_FALSE(catalogue_->describe("synthetic", Waiting::allowed));
  EXPECT_FALSE(catalogue_->list(Waiting::allowed));
  upstream_->play({});
  EXPECT_TRUE(catalogue_->open("synthetic", revision, Waiting::allowed));
  EXPECT_TRUE(catalogue_->describe("synthetic", Waiting::allowed));
}

TEST_F(CachedCatalogueTest, KnowsNoRevisionThatTheUpstreamDoesNotKnow) {
  const auto opened = catalogue_->open("synthetic", std::string(32, 'a'), Waiting::allowed);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::notFound);
}

TEST_F(CachedCatalogueTest, UsesQueryForLargeSets) {
  const SyntheticMesh large = makeSyntheticMesh({.name = "large", .roots = 3000, .maxDepth = 5});
  ASSERT_TRUE(writePack(folder_ / "b.pack", large.content));
  auto origin =
      PackCatalogue::read(folder_.path(), std::make_shared<MemoryBudget>(size_t{1} << 24));
  ASSERT_TRUE(origin);
  RecordService service(**origin, originMetrics_, {});
  ScriptedUpstream upstream(service);
  DocumentCache documents(upstream, *budget_, *memory_, *counters_, {});
  CachedCatalogue catalogue({upstream, documents, *budget_, *memory_, *counters_});
  const auto opened = catalogue.open("large", revisionOf(large.content), Waiting::allowed);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto wanted = large.nodesAtDepth(4);
  const auto answer = (*opened)->collect(wanted, {}, limits_, Waiting::allowed);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->bytes, large.answerTo(wanted, {}));
  EXPECT_TRUE(upstream.requests().back().query);
  EXPECT_EQ(upstream.count("/splits"), 5U);
}

}  // namespace
}  // namespace meshfront
