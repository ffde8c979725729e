// What a receiver asks for, in which order, and what it becomes.
#include "shared/receiver/receiver.h"

#include <set>

#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;

TEST_F(ReceiverTest, ConnectsByMetadataAndBase) {
  Receiver& receiver = start();
  EXPECT_EQ(receiver.state(), ReceiverState::connecting);
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_EQ(transport_.held[0].request.url, "http://host/v1/meshes/torus");
  EXPECT_FALSE(receiver.waitForArrival(milliseconds(0)));
  transport_.answer(service_);
  EXPECT_TRUE(receiver.waitForArrival(milliseconds(0)));
  EXPECT_FALSE(receiver.advance());
  EXPECT_EQ(receiver.mesh(), nullptr);
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_EQ(transport_.held[0].request.url,
            "http://host/v1/meshes/torus/" + std::string(32, 'a') + "/base");
  transport_.answer(service_);
  receiver.advance();
  ASSERT_NE(receiver.mesh(), nullptr);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  EXPECT_TRUE(receiver.wantsRanking());
  EXPECT_TRUE(transport_.held.empty());
}

TEST_F(ReceiverTest, AsksForTheTopOfTheFront) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) {
    o.order = RankOrder::pixels;
    o.batch = 3;
    o.window = 1;
  }));
  const SelectivelyRefinedMesh& mesh = *receiver.mesh();
  std::vector<uint32_t> pixels(mesh.vertexSlotCount(), 0);
  std::set<NodeId> expected;
  uint32_t next = 100;
  for (VertexSlot slot = 0; slot < pixels.size() && expected.size() < 3; ++slot) {
    if (mesh.isLeaf(mesh.nodeAt(slot))) continue;
    pixels[slot] = next--;
    expected.insert(mesh.id(mesh.nodeAt(slot)));
  }
  ASSERT_EQ(expected.size(), 3U);
  for (uint32_t& count : pixels) count = std::max(count, 5U);
  receiver.rank(pixels);
  ASSERT_EQ(transport_.held.size(), 1U);
  const std::vector<NodeId> nodes = requested(transport_.held[0]);
  EXPECT_EQ(std::set<NodeId>(nodes.begin(), nodes.end()), expected);
  EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
}

TEST_F(ReceiverTest, IgnoresWhatIsNotVisibleAndSettles) {
  Receiver& receiver = connect();
  receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 0));
  EXPECT_TRUE(transport_.held.empty());
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  EXPECT_FALSE(receiver.isAtWork());
  EXPECT_EQ(receiver.statistics().recordsWhenSettled, 0U);
  // Another view shows something.
  receiver.rank(everywhere(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  EXPECT_FALSE(transport_.held.empty());
}

TEST_F(ReceiverTest, AsksForNothingTwiceWhileItIsUnderWay) {
  Receiver& receiver = connect(batches(4, 2));
  receiver.rank(everywhere(receiver));
  ASSERT_EQ(transport_.held.size(), 2U);
  EXPECT_FALSE(receiver.wantsRanking());
  receiver.rank(everywhere(receiver));  // no room: no third request
  ASSERT_EQ(transport_.held.size(), 2U);
  std::set<NodeId> asked;
  for (int i = 0; i < 20; ++i) {
    for (const NodeId& id : requested(transport_.held.back()))
      EXPECT_TRUE(asked.insert(id).second) << "asked for twice";
    if (i == 0)
      for (const NodeId& id : requested(transport_.held.front())) asked.insert(id);
    transport_.answer(service_);
    EXPECT_TRUE(receiver.advance());
    receiver.rank(everywhere(receiver));
    ASSERT_EQ(transport_.held.size(), 2U);
  }
  EXPECT_EQ(receiver.statistics().records, 80U);
}

TEST_F(ReceiverTest, AppliesAnswersInTheOrderOfTheRequests) {
  Receiver& receiver = connect(batches(4, 2));
  receiver.rank(everywhere(receiver));
  ASSERT_EQ(transport_.held.size(), 2U);
  transport_.answer(service_, 1);
  EXPECT_FALSE(receiver.advance());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 0U);
  EXPECT_FALSE(receiver.waitForArrival(milliseconds(0)));
  transport_.answer(service_, 0);
  EXPECT_TRUE(receiver.advance());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 4U);
  EXPECT_TRUE(receiver.waitForArrival(milliseconds(0)));
  // The next one waits for a ranking of what this one brought.
  EXPECT_FALSE(receiver.advance());
  EXPECT_TRUE(receiver.wantsRanking());
  receiver.rank(everywhere(receiver));
  EXPECT_TRUE(receiver.advance());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 8U);
}

TEST_F(ReceiverTest, GetsTheExactMeshWhenEverythingIsVisible) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) { o.batch = 50; }));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_EQ(receiver.statistics().records, service_.splitCount());
  expectWholeMesh(receiver);
}

TEST_F(ReceiverTest, CompletesWhatNoViewShows) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) { o.goal = Goal::complete; }));
  receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 0));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  EXPECT_FALSE(receiver.wantsRanking());
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_TRUE(MeshService::wantedBy(transport_.held[0].request).expansion.significance);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_EQ(receiver.mesh()->splitsApplied(), service_.splitCount());
  EXPECT_EQ(receiver.statistics().recordsWhenSettled, 0U);
  // By levels, not by generations of the trees.
  EXPECT_LE(receiver.statistics().requests, 14U);
}

TEST_F(ReceiverTest, CompletesWithoutExpansionsWhereTheServerRefusesThem) {
  service_.refusesExpansion = true;
  Receiver& receiver = connect(with([](ReceiverOptions& o) { o.goal = Goal::complete; }));
  receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 0));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ReceiverTest, AsksForLessWhereTheServerRefusesMuch) {
  service_.mostNodes = 7;
  Receiver& receiver = connect(with([](ReceiverOptions& o) { o.batch = 60; }));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ReceiverTest, PutsANewViewInFrontOfTheRest) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) {
    o.goal = Goal::complete;
    o.batch = 5;
    o.window = 1;
  }));
  receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 0));
  transport_.answer(service_);
  receiver.advance();
  ASSERT_EQ(transport_.held.size(), 1U);  // more of the rest
  std::vector<uint32_t> pixels(receiver.mesh()->vertexSlotCount(), 0);
  std::set<NodeId> busy;
  for (const NodeId& id : requested(transport_.held[0])) busy.insert(id);
  NodeId seen;
  for (VertexSlot slot = 0; slot < pixels.size(); ++slot) {
    const NodeIndex node = receiver.mesh()->nodeAt(slot);
    if (receiver.mesh()->isLeaf(node) || busy.contains(receiver.mesh()->id(node))) continue;
    pixels[slot] = 9;
    seen = receiver.mesh()->id(node);
    break;
  }
  receiver.rank(pixels);
  transport_.answer(service_);
  receiver.advance();
  receiver.rank(pixels);
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_EQ(requested(transport_.held[0]), std::vector<NodeId>{seen});
  EXPECT_TRUE(MeshService::wantedBy(transport_.held[0].request).expansion.none());
}

TEST_F(ReceiverTest, AppliesInSlicesWithoutAskingForWhatIsThere) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) {
    o.goal = Goal::complete;
    o.window = 2;
  }));
  receiver.rank(std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), 0));
  for (int i = 0; i < 20'000 && receiver.isAtWork(); ++i) {
    for (const auto& held : transport_.held)
      for (const NodeId& id : requested(held)) {
        const auto node = receiver.mesh()->find(id);
        EXPECT_TRUE(node && receiver.mesh()->isActive(*node));
      }
    if (!transport_.held.empty() && i % 3 == 0) transport_.answer(service_);
    receiver.advance(2);
    if (i % 5 == 0) receiver.rank(everywhere(receiver));
  }
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_EQ(receiver.statistics().records, service_.splitCount());
}

TEST_F(ReceiverTest, KeepsToALimitOfRecords) {
  Receiver& receiver = connect(with([](ReceiverOptions& o) {
    o.batch = 50;
    o.limits.records = 123;
  }));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::limitReached);
  EXPECT_EQ(receiver.statistics().records, 123U);
  EXPECT_TRUE(transport_.held.empty());
}

TEST_F(ReceiverTest, KeepsToALimitOfBytes) {
  const uint64_t budget = torusService().mesh().coded.base.size() + 5'000;
  Receiver& receiver = connect(with([budget](ReceiverOptions& o) {
    o.batch = 40;
    o.limits.bytesDown = budget;
  }));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::limitReached);
  EXPECT_LE(receiver.statistics().traffic.bytesDown(), budget + 20);
  EXPECT_GT(receiver.statistics().records, 100U);
}

TEST_F(ReceiverTest, CountsWhatEverythingCost) {
  Receiver& receiver = connect(batches(10, 1));
  receiver.rank(everywhere(receiver));
  FetchResponse response = service_.answer(transport_.held[0].request);
  response.traffic = {3, 1'000, 50, response.body.size()};
  const uint64_t before = receiver.statistics().traffic.bytesDown();
  const uint64_t body = response.body.size();
  transport_.complete(0, response);
  receiver.advance();
  const ReceiverStatistics& statistics = receiver.statistics();
  EXPECT_EQ(statistics.requests, 1U);
  EXPECT_EQ(statistics.answers, 1U);
  EXPECT_EQ(statistics.records, 10U);
  EXPECT_EQ(statistics.requestBytesUp, 1'000U);
  EXPECT_EQ(statistics.answerBytesDown, body);
  EXPECT_EQ(statistics.traffic.attempts, 5U);
  EXPECT_EQ(statistics.traffic.bytesUp, 1'200U);
  EXPECT_EQ(statistics.traffic.bytesDown(), before + 50 + body);
}

TEST_F(ReceiverTest, WakesItsOwnerAndStopsWithItsEnd) {
  int woken = 0;
  Receiver& receiver =
      start(with([&woken](ReceiverOptions& o) { o.onArrival = [&woken] { ++woken; }; }));
  transport_.answer(service_);
  EXPECT_EQ(woken, 1);
  receiver.advance();
  ASSERT_EQ(transport_.held.size(), 1U);
  ScriptedTransport::Held late = transport_.held[0];
  receiver_.reset();
  EXPECT_TRUE(transport_.held.empty());
  late.completion(service_.answer(late.request));  // was already on its way
  EXPECT_EQ(woken, 1);
}

TEST_F(ReceiverTest, TwoReceiversOfOneViewAskForEqualSets) {
  std::vector<std::string> asked[2];
  for (auto& list : asked) {
    Receiver& receiver = connect(with([](ReceiverOptions& o) { o.window = 2; }));
    for (int i = 0; receiver.isAtWork() && i < 1'000; ++i) {
      if (receiver.wantsRanking()) receiver.rank(everywhere(receiver, 7));
      if (transport_.held.empty()) break;
      // Answers arrive in another order the second time.
      const size_t which = &list == &asked[1] ? transport_.held.size() - 1 : 0;
      list.push_back(transport_.held[which].request.url);
      transport_.answer(service_, which);
      receiver.advance();
      receiver.advance();
    }
    std::sort(list.begin(), list.end());
    transport_.held.clear();
  }
  EXPECT_GT(asked[0].size(), 2U);
  EXPECT_EQ(asked[0], asked[1]);
}

}  // namespace
}  // namespace meshfront
