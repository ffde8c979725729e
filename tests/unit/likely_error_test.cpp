#include "shared/scene/likely_error.h"

#include <gtest/gtest.h>

#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

constexpr double kPixelsAtOne = 800;

// A coarse sphere, three generations below its base mesh, all of whose vertices cover as many
// pixels.
class LikelyErrorTest : public ::testing::Test {
 protected:
  LikelyErrorTest()
      : records_(encodedContent(sphere(4))),
        mesh_(SelectivelyRefinedMesh::fromBase(records_.base()).value()) {
    for (unsigned generation = 0; generation < 3; ++generation) {
      const auto slots = static_cast<VertexSlot>(mesh_.vertexSlotCount());
      for (VertexSlot slot = 0; slot < slots; ++slot) {
        const NodeIndex node = mesh_.nodeAt(slot);
        if (mesh_.isVirtual(node) || mesh_.isLeaf(node)) continue;
        EXPECT_TRUE(records_.split(mesh_, node).has_value());
      }
    }
  }

  [[nodiscard]] std::vector<uint8_t> liftFrom(const glm::dvec3& eye, uint32_t pixels) const {
    std::vector<uint8_t> lift;
    liftByLikelyError(mesh_, std::vector<uint32_t>(mesh_.vertexSlotCount(), pixels), eye,
                      kPixelsAtOne, lift);
    return lift;
  }

  RecordsAtHand records_;
  SelectivelyRefinedMesh mesh_;
};

TEST_F(LikelyErrorTest, LiftsWhatCoversMorePixels) {
  const glm::dvec3 far(8'000, 8'000, 90'000);
  const auto few = liftFrom(far, 10);
  const auto many = liftFrom(far, 10'000);
  ASSERT_EQ(few.size(), mesh_.vertexSlotCount());
  bool more = false;
  for (size_t slot = 0; slot < few.size(); ++slot) {
    EXPECT_LE(few[slot], many[slot]);
    EXPECT_LE(many[slot], kMostErrorLift);
    more = more || few[slot] + 4 < many[slot];
  }
  EXPECT_TRUE(more);
}

TEST_F(LikelyErrorTest, LiftsTheSilhouetteAboveWhatFacesTheEye) {
  const glm::dvec3 middle(0.5 * (1U << mesh_.base().quantizationBits));
  const auto lift = liftFrom(middle + glm::dvec3(0, 0, 8 * middle.z), 1);
  double facing = 0;
  double rim = 0;
  unsigned facingCount = 0;
  unsigned rimCount = 0;
  for (VertexSlot slot = 0; slot < lift.size(); ++slot) {
    const NodeIndex node = mesh_.nodeAt(slot);
    if (node == kNone || mesh_.isVirtual(node) || mesh_.isLeaf(node)) continue;
    const auto& at = mesh_.positions()[slot];
    const double height = (at[2] - middle.z) / middle.z;
    if (height > 0.6) {
      facing += lift[slot];
      ++facingCount;
    } else if (height > -0.3 && height < 0.3) {
      rim += lift[slot];
      ++rimCount;
    }
  }
  ASSERT_GT(facingCount, 0U);
  ASSERT_GT(rimCount, 0U);
  EXPECT_GT(rim / rimCount, facing / facingCount);
}

TEST_F(LikelyErrorTest, LeavesAloneWhatIsNotSeen) {
  for (const uint8_t lift : liftFrom({0, 0, 90'000}, 0)) EXPECT_EQ(lift, 0);
}

}  // namespace
}  // namespace meshfront
