#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shared/mesh/vertex_attributes.h"

namespace meshfront {
namespace {

TEST(OctahedralNormal, HasLiteralCoordinates) {
  EXPECT_EQ(toOctahedral({0, 0, 1}, 10), (OctahedralNormal{512, 512}));
  EXPECT_EQ(toOctahedral({5, 0, 0}, 10), (OctahedralNormal{1023, 512}));
  EXPECT_EQ(toOctahedral({0, -2, 0}, 10), (OctahedralNormal{512, 0}));
  EXPECT_EQ(toOctahedral({0, 0, 0}, 10), toOctahedral({0, 0, 1}, 10));
}

TEST(OctahedralNormal, GoesThereAndBackForEveryCode) {
  for (const unsigned bits : {4U, 6U, 8U}) {
    const unsigned end = 1U << bits;
    for (unsigned x = 0; x < end; ++x)
      for (unsigned y = 0; y < end; ++y) {
        const auto direction =
            fromOctahedral({static_cast<uint16_t>(x), static_cast<uint16_t>(y)}, bits);
        const OctahedralNormal code = toOctahedral(direction, bits);
        ASSERT_EQ(toOctahedral(fromOctahedral(code, bits), bits), code) << x << ' ' << y;
        // Only points of the rim have a twin.
        if (x != 0 && y != 0 && x + 1 != end && y + 1 != end) {
          ASSERT_EQ(code, (OctahedralNormal{static_cast<uint16_t>(x), static_cast<uint16_t>(y)}));
        }
      }
  }
}

TEST(OctahedralNormal, StaysCloseAndSettlesAtOnce) {
  std::mt19937 random(4);
  std::normal_distribution<float> part;
  for (const unsigned bits : {10U, 15U}) {
    for (int i = 0; i < 20000; ++i) {
      std::array<float, 3> n{part(random), part(random), part(random)};
      if (i % 5 == 0) n[static_cast<size_t>(i / 5) % 3] = 0;  // seams
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      const OctahedralNormal code = toOctahedral(n, bits);
      const auto back = fromOctahedral(code, bits);
      EXPECT_EQ(toOctahedral(back, bits), code);
      const float cosine = (n[0] * back[0] + n[1] * back[1] + n[2] * back[2]) / length;
      EXPECT_GT(cosine,
                1 - 8.0F / static_cast<float>(1U << bits) / static_cast<float>(1U << bits) - 1e-6F);
    }
  }
}

TEST(PackAttributes, TakesWhatTheLayoutNames) {
  const std::vector<Colour> colours{{1, 2, 3, 4}, {5, 6, 7, 8}};
  const std::vector<std::array<float, 3>> normals{{0, 0, 1}, {1, 0, 0}};
  EXPECT_TRUE(packAttributes(colours, normals, {}).empty());
  const auto onlyColours = packAttributes(colours, normals, {true, 0});
  ASSERT_EQ(onlyColours.size(), 2U);
  EXPECT_EQ(onlyColours[1].colour, colours[1]);
  EXPECT_EQ(onlyColours[1].normal, OctahedralNormal{});
  const auto both = packAttributes(colours, normals, {true, 12});
  EXPECT_EQ(both[1].normal, toOctahedral(normals[1], 12));
}

}  // namespace
}  // namespace meshfront
