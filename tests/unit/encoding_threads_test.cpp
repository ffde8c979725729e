#include <gtest/gtest.h>

#include "encoder/pipeline/encode_mesh.h"
#include "tests/data/mesh_shapes.h"

namespace meshfront {
namespace {

TEST(EncodingThreads, DoNotChangeThePack) {
  // Several blocks of splits, so that threads have something to share.
  const IndexedMesh mesh = torus(200, 90);
  const auto packWith = [&](unsigned threads) {
    EncodeOptions options;
    options.name = "threads";
    options.threads = threads;
    auto encoded = encodeMesh(mesh, options);
    EXPECT_TRUE(encoded) << encoded.error().message;
    return std::move(encoded->pack);
  };
  const PackContent one = packWith(1);
  EXPECT_GT(one.metadata.splitCount, 16384U);
  for (const unsigned threads : {2U, 5U}) {
    const PackContent many = packWith(threads);
    EXPECT_EQ(many.base, one.base);
    EXPECT_EQ(many.chunks, one.chunks);
    EXPECT_EQ(many.chunkIndex, one.chunkIndex);
    EXPECT_EQ(many.reportJson, one.reportJson);
  }
}

}  // namespace
}  // namespace meshfront
