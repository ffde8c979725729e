// What touches the seen is split, too, once all that is seen is.
#include "shared/scene/seen_rim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <glm/geometric.hpp>

#include "shared/scene/scene_receiver.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

class SeenRimTest : public ReceiverTest {
 protected:
  static std::vector<SceneMesh> scene() {
    SceneMesh mesh;
    mesh.url = url();
    mesh.name = "torus";
    mesh.worldFromMesh = glm::dmat4(1.0);
    return {mesh};
  }

  static SceneOptions untilSettled(bool rim) {
    SceneOptions options;
    options.receiver.goal = Goal::settled;
    options.rim = rim;
    return options;
  }

  static int middle(const SelectivelyRefinedMesh& mesh) {
    int least = INT_MAX;
    int most = INT_MIN;
    for (const GridPosition& position : mesh.positions()) {
      least = std::min(least, position[0]);
      most = std::max(most, position[0]);
    }
    return least + (most - least) / 2;
  }

  // Of the torus one half is seen: what lies beyond its middle in x. Its edges are some ten pixels
  // long.
  static SceneCounts halfSeen(const SceneReceiver& scene, uint32_t pixels = kCoarse) {
    SceneCounts counts;
    counts.camera.eye = kEye;
    counts.picture = {1'000, 1'000};
    MeshCounts& half = counts.meshes.emplace_back();
    const SelectivelyRefinedMesh& mesh = *scene.receiver(0).mesh();
    half.changeCount = mesh.changeCount();
    half.pixels.resize(mesh.vertexSlotCount());
    for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot)
      half.pixels[slot] = mesh.positions()[slot][0] > middle(mesh) ? pixels : 0;
    return counts;
  }

  void lookAround(SceneReceiver& scene) {
    for (int i = 0; i < 10'000; ++i) {
      if (!transport_.held.empty()) transport_.answer(service_);
      scene.advance();
      if (scene.receiver(0).mesh() == nullptr) continue;
      if (scene.wantsRanking()) scene.rank(halfSeen(scene));
      if (!scene.isAtWork() && transport_.held.empty()) break;
    }
  }

  void settle(SceneReceiver& scene) {
    lookAround(scene);
    scene.rank(halfSeen(scene));
    EXPECT_TRUE(transport_.held.empty());
    EXPECT_EQ(scene.status().state, ReceiverState::settled);
    const SelectivelyRefinedMesh& mesh = *scene.receiver(0).mesh();
    EXPECT_EQ(seenPixels(mesh, halfSeen(scene).meshes[0].pixels).open, 0U);
  }

  static std::vector<VertexSlot> rimOf(const SceneReceiver& scene, double pixelsAtOne) {
    return openRim(*scene.receiver(0).mesh(), halfSeen(scene).meshes[0].pixels, kEye, pixelsAtOne);
  }
  static size_t openAtTheRim(const SceneReceiver& scene) {
    const SceneCounts counts = halfSeen(scene);
    return rimOf(scene, pixelsAtOne(counts.camera, counts.picture)).size();
  }

  // What each seen vertex covers: so much that the rim comes last, or so little that it joins.
  static constexpr uint32_t kCoarse = 2 * kRimJoinsAtPixels;
  static constexpr uint32_t kFine = kRimJoinsAtPixels;

  // Of a request's nodes; `open`: of all that is seen, those that can still be split.
  struct Asked {
    size_t seen = 0;
    size_t rim = 0;
    size_t open = 0;
  };
  // One request at a time, until the scene settles.
  std::vector<Asked> requestsOf(SceneOptions options, uint32_t batch, uint32_t pixels) {
    options.receiver.batch = batch;
    options.receiver.window = 1;
    SceneReceiver scene(this->scene(), options, transport_);
    std::vector<Asked> requests;
    for (int i = 0; i < 1'000 && scene.isAtWork(); ++i) {
      if (!transport_.held.empty()) transport_.answer(service_);
      scene.advance();
      if (scene.receiver(0).mesh() == nullptr || !scene.wantsRanking()) continue;
      const SceneCounts counts = halfSeen(scene, pixels);
      scene.rank(counts);
      if (transport_.held.empty()) continue;
      const SelectivelyRefinedMesh& mesh = *scene.receiver(0).mesh();
      Asked& asked = requests.emplace_back();
      asked.open = seenPixels(mesh, counts.meshes[0].pixels).openNodes;
      for (const NodeId& id : requested(transport_.held[0]))
        ++(counts.meshes[0].pixels[mesh.slot(*mesh.find(id))] > 0 ? asked.seen : asked.rim);
    }
    EXPECT_EQ(scene.status().state, ReceiverState::settled) << batch;
    return requests;
  }
  // Those with some of the rim while some of what is seen is neither split nor asked for.
  size_t requestsWithRimAhead(const SceneOptions& options, uint32_t pixels) {
    const std::vector<Asked> requests = requestsOf(options, 40, pixels);
    return static_cast<size_t>(std::count_if(requests.begin(), requests.end(), [](const Asked& a) {
      return a.rim > 0 && a.seen < a.open;
    }));
  }

  // In grid steps, which are those of the world here.
  static constexpr glm::dvec3 kEye{8'000, 8'000, 40'000};
};

TEST_F(SeenRimTest, IsSplitOnceAllThatIsSeenIs) {
  SceneReceiver without(scene(), untilSettled(false), transport_);
  settle(without);
  EXPECT_GT(openAtTheRim(without), 10U);
  SceneReceiver with(scene(), untilSettled(true), transport_);
  settle(with);
  EXPECT_EQ(openAtTheRim(with), 0U);
  const uint64_t splits = with.receiver(0).mesh()->splitsApplied();
  EXPECT_GT(splits, without.receiver(0).mesh()->splitsApplied());
  EXPECT_LT(splits, service_.splitCount());
  EXPECT_EQ(with.status().finalShare, 1);
}

TEST_F(SeenRimTest, HasEdgesToTheSeenThatAreLongEnoughToShow) {
  SceneReceiver seen(scene(), untilSettled(false), transport_);
  settle(seen);
  const SelectivelyRefinedMesh& mesh = *seen.receiver(0).mesh();
  const std::vector<uint32_t> pixels = halfSeen(seen).meshes[0].pixels;
  const auto longest = [&](VertexSlot slot, double pixelsAtOne) {
    const auto at = [&](VertexSlot v) {
      const GridPosition& p = mesh.positions()[v];
      return glm::dvec3(p[0], p[1], p[2]);
    };
    double most = 0;
    mesh.edges().forEachOutgoing(slot, [&](HalfEdge edge) {
      const VertexSlot next = mesh.edges().destination(edge);
      if (pixels[next] > 0) most = std::max(most, glm::distance(at(slot), at(next)));
    });
    return most * pixelsAtOne / glm::distance(kEye, at(slot));
  };
  std::vector<double> lengths;
  for (const VertexSlot slot : rimOf(seen, 1e6)) lengths.push_back(longest(slot, 1));
  ASSERT_GT(lengths.size(), 10U);
  std::sort(lengths.begin(), lengths.end());
  const double halfShow = 2 / lengths[lengths.size() / 2];
  size_t last = SIZE_MAX;
  for (const double pixelsAtOne : {1e6, halfShow, 1.0}) {
    const std::vector<VertexSlot> rim = rimOf(seen, pixelsAtOne);
    std::vector<VertexSlot> expected;
    for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
      const NodeIndex node = mesh.nodeAt(slot);
      if (node == kNone || mesh.isLeaf(node) || mesh.isVirtual(node) || pixels[slot] > 0) continue;
      if (longest(slot, pixelsAtOne) >= 2) expected.push_back(slot);
    }
    EXPECT_EQ(rim, expected) << pixelsAtOne;
    EXPECT_LT(rim.size(), last) << "as many with edges that are shorter: " << pixelsAtOne;
    last = rim.size();
  }
  EXPECT_EQ(last, 0U);
}

TEST_F(SeenRimTest, WaitsForWhatIsSeen) {
  SceneOptions options;
  options.receiver.batch = 10'000;
  options.receiver.window = 1;
  SceneReceiver scene(this->scene(), options, transport_);
  for (int i = 0; i < 20 && !transport_.held.empty(); ++i) {
    transport_.answer(service_);
    scene.advance();
  }
  const SceneCounts counts = halfSeen(scene);
  scene.rank(counts);
  ASSERT_EQ(transport_.held.size(), 1U);
  const SelectivelyRefinedMesh& mesh = *scene.receiver(0).mesh();
  ASSERT_GT(openAtTheRim(scene), 0U);
  for (const NodeId& id : requested(transport_.held[0]))
    EXPECT_GT(counts.meshes[0].pixels[mesh.slot(*mesh.find(id))], 0U);
}

// Towards the end a request holds what is left to be seen and the rim, if both fit.
TEST_F(SeenRimTest, ComesAlongOnlyWithAllThatIsSeen) {
  size_t mixed = 0;
  for (uint32_t batch = 20; batch <= 160; batch += 5) {
    for (const Asked& asked : requestsOf(untilSettled(true), batch, kCoarse)) {
      if (asked.rim == 0) continue;
      EXPECT_EQ(asked.seen, asked.open) << "the rim in the place of what is seen, batch " << batch;
      mixed += asked.seen > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(mixed, 0U);
}

TEST_F(SeenRimTest, JoinsWhatIsSeenInAFinePicture) {
  SceneOptions options = untilSettled(true);
  EXPECT_GT(requestsWithRimAhead(options, kFine), 2U);
  EXPECT_EQ(requestsWithRimAhead(options, kFine + 1), 0U);
  options.limits.bytes = uint64_t{1} << 30;  // room for all
  EXPECT_GT(requestsWithRimAhead(options, kFine), 2U);
}

TEST_F(SeenRimTest, ComesLastWhereRoomMayBeScarceOrPixelsAloneCount) {
  SceneOptions triangles = untilSettled(true);
  triangles.limits.triangles = 2 * service_.mesh().triangles.size();
  EXPECT_EQ(requestsWithRimAhead(triangles, kFine), 0U);
  SceneOptions pixels = untilSettled(true);
  pixels.receiver.order = RankOrder::pixels;
  EXPECT_EQ(requestsWithRimAhead(pixels, kFine), 0U);
  EXPECT_EQ(requestsWithRimAhead(untilSettled(false), kFine), 0U);
  // Memory for what is seen and the rim, but not for all of the mesh.
  SceneReceiver roomy(scene(), untilSettled(true), transport_);
  settle(roomy);
  SceneOptions memory = untilSettled(true);
  memory.limits.bytes = roomy.receiver(0).mesh()->bytes();
  // At first there are so few pixels here that their vertices have room.
  EXPECT_LE(requestsWithRimAhead(memory, kFine), 1U);
}

TEST_F(SeenRimTest, TakesNoRoomThatABudgetDoesNotHave) {
  SceneOptions options = untilSettled(false);
  SceneReceiver unlimited(scene(), options, transport_);
  settle(unlimited);
  // Too few triangles for what is seen: all goes on as if there were no rim.
  options.limits.triangles = unlimited.receiver(0).mesh()->drawnTriangleCount() * 3 / 4;
  SceneReceiver seenAlone(scene(), options, transport_);
  lookAround(seenAlone);
  options.rim = true;
  SceneReceiver tight(scene(), options, transport_);
  lookAround(tight);
  EXPECT_GT(openAtTheRim(tight), 0U);
  EXPECT_EQ(tight.status().splits, seenAlone.status().splits);
  EXPECT_EQ(tight.status().statistics.records, seenAlone.status().statistics.records);
  EXPECT_EQ(tight.status().collapses, seenAlone.status().collapses);
  // Enough for the rim, too; a view that comes back needs nothing then.
  options.limits.triangles = 2 * service_.mesh().triangles.size();
  SceneReceiver roomy(scene(), options, transport_);
  settle(roomy);
  EXPECT_EQ(openAtTheRim(roomy), 0U);
  const uint64_t requests = roomy.status().statistics.requests;
  settle(roomy);
  EXPECT_EQ(roomy.status().statistics.requests, requests);
}

// Between the two: what is seen has room, the rim not all. It comes to rest.
TEST_F(SeenRimTest, ComesToRestUnderEveryBudget) {
  for (const double share : {0.4, 0.5, 0.55, 0.6, 0.65, 0.7}) {
    SceneOptions options = untilSettled(true);
    options.limits.triangles =
        static_cast<uint64_t>(share * static_cast<double>(service_.mesh().triangles.size()));
    options.limits.unneededShare = 0.25;
    SceneReceiver scene(this->scene(), options, transport_);
    lookAround(scene);
    const uint64_t collapses = scene.status().collapses;
    const uint64_t requests = scene.status().statistics.requests;
    for (int i = 0; i < 50; ++i) {
      scene.rank(halfSeen(scene));
      scene.advance();
    }
    EXPECT_TRUE(transport_.held.empty()) << share;
    EXPECT_EQ(scene.status().collapses, collapses) << share;
    EXPECT_EQ(scene.status().statistics.requests, requests) << share;
    EXPECT_LE(scene.status().triangles, options.limits.triangles) << share;
  }
}

}  // namespace
}  // namespace meshfront
