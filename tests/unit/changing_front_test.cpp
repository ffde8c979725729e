// A receiver whose mesh is collapsed, split and kept small by somebody else between its calls.
#include <set>

#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;

class ChangingFrontTest : public ReceiverTest {
 protected:
  static ReceiverOptions interactive(uint32_t batch = 10, uint32_t window = 2) {
    ReceiverOptions options = batches(batch, window);
    options.freshRanking = false;
    return options;
  }
  static std::vector<uint32_t> nothing(const Receiver& receiver) { return everywhere(receiver, 0); }
  // A split node that collapse() may take.
  static NodeIndex collapsible(const SelectivelyRefinedMesh& mesh) {
    for (NodeIndex node = 0; node < mesh.nodeCount(); ++node)
      if (mesh.hasRecord(node) && mesh.canCollapse(node) && !mesh.isActive(node)) return node;
    return kNone;
  }
  static std::vector<uint32_t> only(const Receiver& receiver, std::vector<NodeIndex> nodes) {
    std::vector<uint32_t> pixels = nothing(receiver);
    for (const NodeIndex node : nodes)
      if (!receiver.mesh()->isLeaf(node)) pixels[receiver.mesh()->slot(node)] = 9;
    return pixels;
  }
  // A front of more than the base's few vertices.
  Receiver& connectAndGrow(const ReceiverOptions& options, uint64_t splits = 200) {
    Receiver& receiver = connect(options);
    receiver.setSplitAllowance(splits);
    runToTheEnd(receiver);
    EXPECT_TRUE(receiver.budgetReached());
    receiver.setSplitAllowance(UINT64_MAX);
    return receiver;
  }
};

class ChangingFrontInAnyMode : public ChangingFrontTest,
                               public ::testing::WithParamInterface<FetchMode> {
 protected:
  static ReceiverOptions interactive(uint32_t batch = 10, uint32_t window = 2) {
    ReceiverOptions options = ChangingFrontTest::interactive(batch, window);
    options.mode = GetParam();
    return options;
  }
};

INSTANTIATE_TEST_SUITE_P(BothModes, ChangingFrontInAnyMode,
                         ::testing::Values(FetchMode::exact, FetchMode::chunks),
                         [](const auto& info) {
                           return info.param == FetchMode::exact ? "exact" : "chunks";
                         });

TEST_F(ChangingFrontTest, KeepsTheRecordOfANodeThatWasCollapsedMeanwhile) {
  Receiver& receiver = connect(interactive(200, 1));
  receiver.rank(everywhere(receiver));
  transport_.answer(service_);
  receiver.advance();
  SelectivelyRefinedMesh& mesh = *receiver.meshToRefine();
  NodeIndex parent = kNone;
  NodeIndex child = kNone;
  for (NodeIndex node = 0; node < mesh.nodeCount() && child == kNone; ++node) {
    if (!mesh.canCollapse(node)) continue;
    for (const NodeIndex c : {mesh.leftChild(node), mesh.leftChild(node) + 1})
      if (!mesh.isLeaf(c)) {
        parent = node;
        child = c;
      }
  }
  ASSERT_NE(child, kNone);
  receiver.rank(only(receiver, {child}));
  ASSERT_EQ(transport_.held.size(), 1U);
  ASSERT_EQ(requested(transport_.held[0]), std::vector<NodeId>{mesh.id(child)});
  mesh.collapse(parent);
  transport_.answer(service_);
  EXPECT_TRUE(receiver.advance());
  EXPECT_EQ(receiver.statistics().malformed, 0U);
  EXPECT_TRUE(mesh.hasRecord(child));
  EXPECT_FALSE(mesh.isActive(child));
  // Seen again: parent and child are split without a request.
  receiver.rank(only(receiver, {parent}));
  EXPECT_TRUE(transport_.held.empty());
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  EXPECT_TRUE(receiver.waitForArrival(milliseconds(0)));
  EXPECT_TRUE(receiver.advance());
  EXPECT_FALSE(mesh.isActive(parent));
  EXPECT_FALSE(mesh.isActive(child));
  EXPECT_TRUE(receiver.wantsRanking());
  receiver.rank(nothing(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  EXPECT_EQ(receiver.statistics().requests, 2U);
}

TEST_P(ChangingFrontInAnyMode, GoesOnWhateverIsCollapsedUnderIt) {
  Receiver& receiver = connect(interactive(40, 3));
  SelectivelyRefinedMesh& mesh = *receiver.meshToRefine();
  uint32_t state = 1;
  for (int i = 0; i < 3'000 && receiver.isAtWork(); ++i) {
    state = state * 1'664'525 + 1'013'904'223;
    if (!transport_.held.empty() && i % 2 == 0)
      transport_.answer(service_, state % transport_.held.size());
    receiver.advance(20);
    if (i < 1'500 && i % 3 == 0)
      for (NodeIndex node = state % 7; node < mesh.nodeCount(); node += 5)
        if (mesh.hasRecord(node) && mesh.canCollapse(node)) mesh.collapse(node);
    if (i < 1'500 && i % 17 == 0) {
      std::vector<NodeId> forgotten;
      for (NodeIndex node = state % 11; node < mesh.nodeCount(); node += 13)
        if (mesh.isKnown(node) && mesh.isActive(node)) mesh.forgetBelow(node, &forgotten);
      receiver.forgot(forgotten);
    }
    if (i % 2 == 0 || receiver.wantsRanking()) receiver.rank(everywhere(receiver, 1 + i % 4));
  }
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_EQ(receiver.statistics().malformed, 0U);
  EXPECT_GE(receiver.statistics().records, service_.splitCount());
  expectWholeMesh(receiver);
}

TEST_P(ChangingFrontInAnyMode, AsksAgainForWhatTheMeshHasForgotten) {
  Receiver& receiver = connect(interactive(100, 2));
  SelectivelyRefinedMesh& mesh = *receiver.meshToRefine();
  runToTheEnd(receiver);
  ASSERT_EQ(receiver.state(), ReceiverState::complete);
  const uint64_t requests = receiver.statistics().requests;
  // Back to the base, and nothing is kept but the roots' records.
  for (NodeIndex node = static_cast<NodeIndex>(mesh.nodeCount()); node-- > 0;)
    if (mesh.isKnown(node) && mesh.canCollapse(node)) mesh.collapse(node);
  ASSERT_EQ(mesh.splitsApplied(), 0U);
  std::vector<NodeId> forgotten;
  for (NodeIndex root = 0; root < mesh.base().treeCount(); ++root)
    mesh.forgetBelow(root, &forgotten);
  ASSERT_GT(forgotten.size(), 1'000U);
  receiver.forgot(forgotten);
  receiver.rank(everywhere(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_GT(receiver.statistics().requests, requests);
  EXPECT_EQ(receiver.statistics().malformed, 0U);
  expectWholeMesh(receiver);
}

TEST_F(ChangingFrontTest, AsksAgainForAKeptRecordThatDoesNotApply) {
  Receiver& receiver = connect(interactive(30, 1));
  SelectivelyRefinedMesh& mesh = *receiver.meshToRefine();
  NodeIndex node = 0;
  while (mesh.isLeaf(node)) ++node;
  const std::vector<uint8_t> nonsense(40, 0xFF);
  ASSERT_TRUE(mesh.keepRecord(node, nonsense, 0, 300));
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
  EXPECT_EQ(receiver.statistics().malformed, 1U);
}

TEST_P(ChangingFrontInAnyMode, SplitsNoMoreThanItIsAllowed) {
  Receiver& receiver = connect(interactive());
  receiver.setSplitAllowance(25);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::limitReached);
  EXPECT_TRUE(receiver.budgetReached());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 25U);
  EXPECT_TRUE(transport_.held.empty());
  if (GetParam() == FetchMode::exact) {
    EXPECT_EQ(receiver.statistics().idsRequested, 25U);
  }
  receiver.rank(nothing(receiver));  // a view that needs nothing is not short of anything
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  receiver.setSplitAllowance(UINT64_MAX);
  receiver.rank(everywhere(receiver));
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ChangingFrontTest, KeepsWhatArrivesBeyondTheAllowance) {
  Receiver& receiver = connectAndGrow(interactive(30, 1));
  const uint64_t held = receiver.mesh()->recordsHeld();
  const uint64_t requests = receiver.statistics().requests;
  receiver.rank(everywhere(receiver));
  receiver.setSplitAllowance(10);  // the budgets are met by something else
  transport_.answer(service_);
  EXPECT_TRUE(receiver.advance());
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 210U);
  EXPECT_EQ(receiver.mesh()->recordsHeld(), held + 30);
  receiver.rank(everywhere(receiver));
  EXPECT_TRUE(receiver.budgetReached());
  receiver.setSplitAllowance(20);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  receiver.advance();
  EXPECT_EQ(receiver.mesh()->splitsApplied(), 230U);
  EXPECT_EQ(receiver.statistics().requests, requests + 1);
}

TEST_F(ChangingFrontTest, DropsNodesThatTheViewNoLongerShows) {
  Receiver& receiver = connectAndGrow(interactive(5, 2));
  receiver.rank(everywhere(receiver));
  ASSERT_EQ(transport_.held.size(), 2U);
  std::vector<uint32_t> pixels = everywhere(receiver);
  std::set<std::string> dropped;
  for (const auto& held : transport_.held) {
    dropped.insert(held.request.url);
    for (const NodeId& id : requested(held))
      pixels[receiver.mesh()->slot(*receiver.mesh()->find(id))] = 0;
  }
  receiver.rank(pixels);
  ASSERT_EQ(transport_.held.size(), 2U);
  EXPECT_EQ(receiver.statistics().cancelled, 2U);
  for (const auto& held : transport_.held) EXPECT_FALSE(dropped.contains(held.request.url));
  runToTheEnd(receiver);  // asks for what was dropped again
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ChangingFrontTest, DropsChunksThatTheViewNoLongerShows) {
  ReceiverOptions options = interactive(5, 1);
  options.mode = FetchMode::chunks;
  Receiver& receiver = connect(options);
  const SelectivelyRefinedMesh& mesh = *receiver.mesh();
  const ChunkIndex index = *decodeChunkIndex(service_.mesh().coded.chunkIndex);
  for (int i = 0; i < 500 && receiver.isAtWork() && receiver.statistics().cancelled == 0; ++i) {
    receiver.rank(everywhere(receiver));
    if (!transport_.held.empty() &&
        transport_.held[0].request.url.find("chunks/") != std::string::npos) {
      // Nothing of it is seen any more.
      const std::string dropped = transport_.held[0].request.url;
      std::vector<uint32_t> pixels = everywhere(receiver);
      for (VertexSlot slot = 0; slot < pixels.size(); ++slot) {
        const NodeIndex node = mesh.nodeAt(slot);
        if (mesh.isLeaf(node)) continue;
        const auto chunk = index.find(mesh.id(node), mesh.level(node));
        if (dropped.ends_with("/" + std::to_string(*chunk))) pixels[slot] = 0;
      }
      receiver.rank(pixels);
      ASSERT_EQ(transport_.held.size(), 1U);
      EXPECT_EQ(transport_.held[0].request.url == dropped, receiver.statistics().cancelled == 0);
    }
    if (!transport_.held.empty()) transport_.answer(service_);
    receiver.advance();
  }
  EXPECT_EQ(receiver.statistics().cancelled, 1U);
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

TEST_F(ChangingFrontTest, DropsNothingWhileNothingElseWaitsOrRunsMustRepeat) {
  Receiver& receiver = connectAndGrow(interactive(5, 2));
  receiver.rank(everywhere(receiver));
  receiver.rank(nothing(receiver));
  EXPECT_EQ(transport_.held.size(), 2U);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  transport_.held.clear();
  Receiver& other = connect(batches(5, 2));
  other.rank(everywhere(other));
  std::vector<uint32_t> pixels = everywhere(other);
  for (const auto& held : transport_.held)
    for (const NodeId& id : requested(held)) pixels[other.mesh()->slot(id.tree)] = 0;
  other.rank(pixels);
  EXPECT_EQ(other.statistics().cancelled, 0U);
}

TEST_F(ChangingFrontTest, FetchesAheadWhileTheViewNeedsNothing) {
  Receiver& receiver = connectAndGrow(interactive(5, 2));
  const uint64_t before = receiver.statistics().answers;
  std::vector<uint32_t> later = nothing(receiver);
  std::vector<uint32_t> now = nothing(receiver);
  for (VertexSlot slot = 0; slot < later.size(); ++slot)
    (slot < later.size() / 2 ? later : now)[slot] = 3;
  receiver.rank(nothing(receiver));
  receiver.rankAhead(later);
  ASSERT_EQ(transport_.held.size(), 1U);  // one at a time
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  transport_.answer(service_);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  EXPECT_EQ(receiver.statistics().answers, before + 1);
  receiver.rankAhead(later);
  ASSERT_EQ(transport_.held.size(), 1U);
  const std::string ahead = transport_.held[0].request.url;
  now.resize(receiver.mesh()->vertexSlotCount(), 0);
  receiver.rank(now);  // the present view wants something
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  ASSERT_FALSE(transport_.held.empty());
  for (const auto& held : transport_.held) EXPECT_NE(held.request.url, ahead);
  EXPECT_EQ(receiver.statistics().cancelled, 1U);
}

TEST_F(ChangingFrontTest, FetchesChunksAhead) {
  ReceiverOptions options = interactive(5, 3);
  options.mode = FetchMode::chunks;
  Receiver& receiver = connect(options);
  transport_.answer(service_);  // the index
  receiver.advance();
  receiver.rank(nothing(receiver));
  receiver.rankAhead(everywhere(receiver));
  ASSERT_EQ(transport_.held.size(), 1U);
  const std::string ahead = transport_.held[0].request.url;
  EXPECT_EQ(receiver.state(), ReceiverState::settled);
  receiver.rank(everywhere(receiver));  // what is under way is what the view wants, too
  EXPECT_EQ(transport_.held[0].request.url, ahead);
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  transport_.answer(service_);
  receiver.advance();
  EXPECT_GT(receiver.statistics().records, 0U);
}

TEST_F(ChangingFrontTest, WaitsForNothingWithoutEnd) {
  std::chrono::steady_clock::time_point time{std::chrono::hours(1)};
  ReceiverOptions options = interactive();
  options.clock = [&time] { return time; };
  Receiver& receiver = start(options);
  time += std::chrono::seconds(29);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::connecting);
  time += std::chrono::seconds(2);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_NE(receiver.reason().find("nothing has come from http://host for 30 s"), std::string::npos)
      << receiver.reason();
  EXPECT_TRUE(transport_.held.empty());
  ASSERT_TRUE(receiver.resume());
  for (int i = 0; i < 2; ++i) {
    transport_.answer(service_);
    receiver.advance();
  }
  receiver.rank(everywhere(receiver));
  ASSERT_FALSE(transport_.held.empty());
  time += std::chrono::seconds(29);
  receiver.advance();
  *transport_.held[0].request.received += 1;  // slow, but not dead
  time += std::chrono::seconds(29);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::refining);
  time += std::chrono::seconds(31);
  receiver.advance();
  EXPECT_EQ(receiver.state(), ReceiverState::degraded);
  EXPECT_TRUE(transport_.held.empty());
  ASSERT_TRUE(receiver.resume());
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
}

}  // namespace
}  // namespace meshfront
