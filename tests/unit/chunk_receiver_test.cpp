// The receiver in chunk mode, over a scripted transport.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "shared/receiver/held_chunks.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

const MeshService& chunkedTorus() {
  static const MeshService kService(TestMesh::torus(96, 48));
  return kService;
}

class ChunkReceiverTest : public ReceiverTest {
 protected:
  static ReceiverOptions chunkMode(ReceiverOptions::Goal goal = ReceiverOptions::Goal::settled) {
    ReceiverOptions options;
    options.mode = FetchMode::chunks;
    options.goal = goal;
    return options;
  }
  Receiver& startChunks(const ReceiverOptions& options) {
    asked_.clear();
    transport_.held.clear();
    service_ = chunkedTorus();
    return start(options);
  }
  // Through metadata, base and chunk index.
  Receiver& connectChunks(const ReceiverOptions& options = chunkMode()) {
    Receiver& receiver = startChunks(options);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(transport_.held.size(), 1U);
      transport_.answer(service_);
      receiver.advance();
    }
    EXPECT_TRUE(transport_.held.empty());
    EXPECT_TRUE(receiver.wantsRanking());
    return receiver;
  }
  static std::vector<uint32_t> nothingSeen(const Receiver& receiver) {
    return everywhere(receiver, 0);
  }
  // "7" of .../chunks/7
  static std::string chunkIn(const std::string& url) {
    const size_t at = url.find("/chunks/");
    return at == std::string::npos ? url : url.substr(at + 8);
  }
  void answerAt(size_t index = 0) {
    asked_.push_back(chunkIn(transport_.held.at(index).request.url));
    transport_.answer(service_, index);
  }
  // Ranks with all vertices visible and answers in order until nothing is at work.
  void runChunks(Receiver& receiver, uint32_t pixels = 1) {
    for (int i = 0; i < 10'000 && receiver.isAtWork(); ++i) {
      if (receiver.wantsRanking()) receiver.rank(everywhere(receiver, pixels));
      if (!transport_.held.empty()) answerAt();
      receiver.advance();
    }
  }
  void expectNothingAskedTwice() const {
    const std::set<std::string> distinct(asked_.begin(), asked_.end());
    EXPECT_EQ(distinct.size(), asked_.size());
  }
  void expectTheExactMesh(const Receiver& receiver) const {
    ASSERT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
    EXPECT_EQ(receiver.statistics().records, service_.splitCount());
    expectWholeMesh(receiver);
  }

  std::vector<std::string> asked_;
};

TEST_F(ChunkReceiverTest, AsksForTheIndexOnceAndThenForChunks) {
  Receiver& receiver = startChunks(chunkMode());
  transport_.answer(service_);
  receiver.advance();
  transport_.answer(service_);
  receiver.advance();
  ASSERT_NE(receiver.mesh(), nullptr);  // there is something to draw
  EXPECT_FALSE(receiver.wantsRanking());
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  ASSERT_EQ(transport_.held.size(), 1U);
  const std::string base = "http://host/v1/meshes/torus/" + std::string(32, 'a');
  EXPECT_EQ(transport_.held[0].request.url, base + "/chunks");
  transport_.answer(service_);
  receiver.advance();
  EXPECT_TRUE(receiver.wantsRanking());
  receiver.rank(everywhere(receiver));
  ASSERT_GE(transport_.held.size(), 1U);  // of the few that the base's vertices lie in
  ASSERT_LE(transport_.held.size(), 4U);
  for (const auto& held : transport_.held)
    EXPECT_TRUE(held.request.url.starts_with(base + "/chunks/"));
  EXPECT_EQ(receiver.statistics().requests, transport_.held.size());
}

TEST_F(ChunkReceiverTest, AsksFirstForTheChunkWhoseRootsCoverMostPixels) {
  for (const RankOrder order : {RankOrder::significance, RankOrder::pixels}) {
    ReceiverOptions options = chunkMode();
    options.order = order;
    options.window = 1;
    Receiver& receiver = connectChunks(options);
    const SelectivelyRefinedMesh& mesh = *receiver.mesh();
    const ChunkIndex index = *decodeChunkIndex(service_.mesh().coded.chunkIndex);
    // Each root counts its number; the sums by chunk say what is expected.
    std::vector<uint32_t> pixels = nothingSeen(receiver);
    std::map<std::pair<unsigned, uint32_t>, uint64_t> sums;
    for (VertexSlot slot = 0; slot < pixels.size(); ++slot) {
      const NodeIndex node = mesh.nodeAt(slot);
      if (mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
      pixels[slot] = slot + 1;
      sums[{mesh.level(node), *index.find(mesh.id(node), mesh.level(node))}] += slot + 1;
    }
    ASSERT_GT(sums.size(), 1U);
    const auto best =
        std::max_element(sums.begin(), sums.end(), [order](const auto& a, const auto& b) {
          if (order == RankOrder::significance && a.first.first != b.first.first)
            return a.first.first > b.first.first;
          return a.second < b.second;
        });
    receiver.rank(pixels);
    ASSERT_EQ(transport_.held.size(), 1U);
    EXPECT_EQ(chunkIn(transport_.held[0].request.url), std::to_string(best->first.second));
  }
}

TEST_F(ChunkReceiverTest, GetsTheExactMeshWhenEverythingIsVisible) {
  Receiver& receiver = connectChunks();
  runChunks(receiver);
  expectTheExactMesh(receiver);
  expectNothingAskedTwice();
  EXPECT_EQ(asked_.size(), service_.mesh().coded.chunks.size());
  EXPECT_EQ(receiver.statistics().requests, asked_.size());
  EXPECT_EQ(receiver.statistics().idsRequested, 0U);
}

TEST_F(ChunkReceiverTest, CompletesWhatNoViewShows) {
  Receiver& receiver = connectChunks(chunkMode(ReceiverOptions::Goal::complete));
  receiver.rank(nothingSeen(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  EXPECT_FALSE(receiver.wantsRanking());
  for (int i = 0; i < 1'000 && receiver.isAtWork(); ++i) {
    ASSERT_FALSE(receiver.wantsRanking());
    if (!transport_.held.empty()) answerAt(transport_.held.size() - 1);
    receiver.advance();
  }
  expectTheExactMesh(receiver);
  expectNothingAskedTwice();
  EXPECT_EQ(receiver.statistics().recordsWhenSettled, 0U);
}

// One root is seen: its chunk comes, and only what hangs on this root is split. Another root of the
// chunk is seen later: it is split without a request.
TEST_F(ChunkReceiverTest, SplitsWhatItHoldsAsSoonAsAViewWantsIt) {
  ReceiverOptions options = chunkMode();
  options.window = 1;
  Receiver& receiver = connectChunks(options);
  const SelectivelyRefinedMesh& mesh = *receiver.mesh();
  const ChunkIndex index = *decodeChunkIndex(service_.mesh().coded.chunkIndex);
  std::map<uint32_t, std::vector<NodeIndex>> roots;
  for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (mesh.isLeaf(node) || mesh.isVirtual(node)) continue;
    roots[*index.find(mesh.id(node), mesh.level(node))].push_back(node);
  }
  const auto chunk = std::find_if(roots.begin(), roots.end(),
                                  [](const auto& entry) { return entry.second.size() > 1; });
  ASSERT_NE(chunk, roots.end());
  const NodeIndex first = chunk->second[0];
  const NodeIndex second = chunk->second[1];
  std::vector<uint32_t> pixels = nothingSeen(receiver);
  pixels[mesh.slot(first)] = 5;
  receiver.rank(pixels);
  ASSERT_EQ(transport_.held.size(), 1U);
  answerAt();
  EXPECT_TRUE(receiver.waitForArrival(std::chrono::milliseconds(0)));
  EXPECT_TRUE(receiver.advance());
  EXPECT_FALSE(mesh.isActive(first));
  EXPECT_TRUE(mesh.isActive(second));
  const uint64_t before = receiver.statistics().records;
  EXPECT_GT(before, 0U);

  pixels = nothingSeen(receiver);
  pixels[mesh.slot(second)] = 5;
  receiver.rank(pixels);
  EXPECT_TRUE(transport_.held.empty());
  EXPECT_NE(receiver.state(), ReceiverState::settled);
  EXPECT_TRUE(receiver.waitForArrival(std::chrono::milliseconds(0)));
  EXPECT_TRUE(receiver.advance());
  EXPECT_FALSE(mesh.isActive(second));
  EXPECT_GT(receiver.statistics().records, before);
  EXPECT_EQ(receiver.statistics().requests, 1U);

  // Nothing is seen any more: settled, whatever else is held.
  EXPECT_TRUE(receiver.wantsRanking());
  receiver.rank(nothingSeen(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
}

TEST_F(ChunkReceiverTest, AppliesInSlicesAndAsksForNothingTwice) {
  ReceiverOptions options = chunkMode(ReceiverOptions::Goal::complete);
  options.freshRanking = false;
  Receiver& receiver = connectChunks(options);
  receiver.rank(everywhere(receiver));
  for (int i = 0; i < 200'000 && receiver.isAtWork(); ++i) {
    if (!transport_.held.empty() && i % 3 == 0) answerAt(i % transport_.held.size());
    receiver.advance(3);
    if (i % 50 == 0 || receiver.wantsRanking())
      receiver.rank(i % 7 == 0 ? nothingSeen(receiver) : everywhere(receiver));
  }
  expectTheExactMesh(receiver);
  expectNothingAskedTwice();
}

TEST_F(ChunkReceiverTest, KeepsToALimitOfRecords) {
  ReceiverOptions options = chunkMode();
  options.limits.records = 777;
  Receiver& receiver = connectChunks(options);
  runChunks(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::limitReached);
  EXPECT_EQ(receiver.statistics().records, 777U);
}

TEST_F(ChunkReceiverTest, KeepsToALimitOfBytes) {
  ReceiverOptions options = chunkMode();
  options.limits.bytesDown = service_.mesh().coded.base.size() + 9'000;
  Receiver& receiver = connectChunks(options);
  runChunks(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::limitReached);
  const uint64_t down = receiver.statistics().traffic.bytesDown();
  EXPECT_LE(down, *options.limits.bytesDown + 100);
  EXPECT_GE(receiver.statistics().answers, 2U);
}

TEST_F(ChunkReceiverTest, AsksOnceMoreForADamagedChunk) {
  Receiver& receiver = connectChunks();
  receiver.rank(everywhere(receiver));
  const std::string url = transport_.held[0].request.url;
  FetchResponse damaged = service_.answer(transport_.held[0].request);
  damaged.body[damaged.body.size() / 2] ^= 0x10;
  transport_.complete(0, damaged);
  EXPECT_FALSE(receiver.advance());
  EXPECT_EQ(receiver.statistics().malformed, 1U);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  const auto again = std::find_if(transport_.held.begin(), transport_.held.end(),
                                  [&](const auto& held) { return held.request.url == url; });
  ASSERT_NE(again, transport_.held.end());
  EXPECT_TRUE(again->request.bypassCaches);
  runChunks(receiver);
  expectTheExactMesh(receiver);
}

TEST_F(ChunkReceiverTest, EndsWhenARepetitionIsDamagedToo) {
  ReceiverOptions options = chunkMode();
  options.window = 1;
  Receiver& receiver = connectChunks(options);
  receiver.rank(everywhere(receiver));
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(transport_.held.size(), 1U);
    FetchResponse cut = service_.answer(transport_.held[0].request);
    cut.body.pop_back();
    transport_.complete(0, cut);
    receiver.advance();
  }
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("damaged, and so is its repetition"), std::string::npos)
      << receiver.reason();
  EXPECT_TRUE(transport_.held.empty());
  EXPECT_TRUE(receiver.resume());  // it may heal
}

TEST_F(ChunkReceiverTest, RefusesASoundChunkThatIsAnotherOne) {
  ReceiverOptions options = chunkMode();
  options.window = 1;
  for (const bool sameBand : {true, false}) {
    Receiver& receiver = connectChunks(options);
    receiver.rank(everywhere(receiver));
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(transport_.held.size(), 1U);
      const auto asked = static_cast<uint32_t>(std::stoul(chunkIn(transport_.held[0].request.url)));
      const auto count = static_cast<uint32_t>(service_.mesh().coded.chunks.size());
      FetchRequest other = transport_.held[0].request;
      const uint32_t wrong = sameBand ? (asked + 1) % count : (asked + count / 2) % count;
      other.url = url().chunk(service_.revision, wrong);
      transport_.complete(0, service_.answer(other));
      receiver.advance();
    }
    EXPECT_EQ(receiver.state(), ReceiverState::degraded);
    EXPECT_EQ(receiver.mesh()->splitsApplied(), 0U);
  }
}

TEST_F(ChunkReceiverTest, AsksOnceMoreForADamagedIndex) {
  for (const bool twice : {false, true}) {
    Receiver& receiver = startChunks(chunkMode());
    for (int i = 0; i < 2; ++i) {
      transport_.answer(service_);
      receiver.advance();
    }
    for (int i = 0; i < (twice ? 2 : 1); ++i) {
      ASSERT_EQ(transport_.held.size(), 1U);
      EXPECT_EQ(transport_.held[0].request.bypassCaches, i > 0);
      FetchResponse damaged = service_.answer(transport_.held[0].request);
      damaged.body.back() ^= 1;
      transport_.complete(0, damaged);
      receiver.advance();
    }
    if (twice) {
      EXPECT_EQ(receiver.state(), ReceiverState::degraded);
      EXPECT_NE(receiver.reason().find("chunk index"), std::string::npos) << receiver.reason();
    } else {
      runChunks(receiver);
      expectTheExactMesh(receiver);
    }
  }
}

TEST_F(ChunkReceiverTest, EndsWhereTheIndexLacksWhatTheMeshNeeds) {
  Receiver& receiver = startChunks(chunkMode());
  for (int i = 0; i < 2; ++i) {
    transport_.answer(service_);
    receiver.advance();
  }
  FetchResponse response = service_.answer(transport_.held[0].request);
  response.body = encodeChunkIndex({});
  transport_.complete(0, response);
  receiver.advance();
  receiver.rank(everywhere(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("names no chunk"), std::string::npos) << receiver.reason();
}

TEST_F(ChunkReceiverTest, GoesOnWhenTheServerIsBack) {
  for (const size_t lostAt : {size_t{0}, size_t{1}, size_t{3}}) {  // the index, or a chunk
    Receiver& receiver = startChunks(chunkMode());
    for (int i = 0; i < 2; ++i) {
      transport_.answer(service_);
      receiver.advance();
    }
    for (size_t i = 0; i < lostAt; ++i) {
      answerAt();
      receiver.advance();
      if (receiver.wantsRanking()) receiver.rank(everywhere(receiver));
    }
    FetchResponse lost;
    lost.error = {ErrorCode::unavailable, "no answer from host: Connection refused"};
    transport_.complete(0, lost);
    receiver.advance();
    EXPECT_EQ(receiver.state(), ReceiverState::degraded);
    EXPECT_EQ(receiver.reason(), lost.error.message);
    EXPECT_TRUE(transport_.held.empty());
    EXPECT_TRUE(receiver.resume());
    runChunks(receiver);
    expectTheExactMesh(receiver);
  }
}

TEST_F(ChunkReceiverTest, NoticesANewRevision) {
  Receiver& receiver = connectChunks();
  receiver.rank(everywhere(receiver));
  service_.revision = service_.knownRevision = std::string(32, 'b');
  for (int i = 0; i < 10 && receiver.isAtWork(); ++i) {
    ASSERT_FALSE(transport_.held.empty());
    transport_.answer(service_);
    receiver.advance();
  }
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("published anew"), std::string::npos) << receiver.reason();
}

TEST_F(ChunkReceiverTest, TwoReceiversOfOneViewAskForEqualChunks) {
  std::vector<std::string> lists[2];
  for (const bool reversed : {false, true}) {
    Receiver& receiver = connectChunks();
    for (int i = 0; receiver.isAtWork() && i < 1'000; ++i) {
      if (receiver.wantsRanking()) {
        std::vector<uint32_t> pixels = everywhere(receiver);
        for (size_t slot = 0; slot < pixels.size(); slot += 2) pixels[slot] = 0;
        receiver.rank(pixels);
      }
      if (!transport_.held.empty()) answerAt(reversed ? transport_.held.size() - 1 : 0);
      receiver.advance();
    }
    std::sort(asked_.begin(), asked_.end());
    lists[reversed ? 1 : 0] = asked_;
  }
  EXPECT_GT(lists[0].size(), 4U);
  EXPECT_EQ(lists[0], lists[1]);
}

TEST(HeldChunks, FreesAChunkWhenAllOfItIsApplied) {
  HeldChunks held(3);
  EXPECT_FALSE(held.has(1));
  std::vector<RecordEntry> entries(2);
  entries[0].id = NodeId::root(4);
  entries[1].id = NodeId::root(9);
  entries[1].bitOffset = 30;
  entries[1].bitLength = 7;
  held.hold(1, {1, 2, 3, 4, 5}, entries);
  EXPECT_TRUE(held.has(1));
  EXPECT_FALSE(held.find(1, NodeId::root(5)));
  ASSERT_TRUE(held.find(1, NodeId::root(9)));
  EXPECT_EQ(held.find(1, NodeId::root(9))->bitOffset, 30U);
  held.countApplied(1);
  EXPECT_EQ(held.bytesOf(1).size(), 5U);
  held.countApplied(1);
  EXPECT_TRUE(held.has(1));
  EXPECT_TRUE(held.bytesOf(1).empty());
  EXPECT_TRUE(held.recordsOf(1).empty());
  held.countApplied(1);  // one too many is harmless
  held.forget(1);
  EXPECT_FALSE(held.has(1));
}

}  // namespace
}  // namespace meshfront
