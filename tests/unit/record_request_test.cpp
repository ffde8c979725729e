#include "shared/receiver/record_request.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "shared/hierarchy/tree_bitstring.h"
#include "tests/unit/mesh_service.h"

namespace meshfront {
namespace {

RecordRequest requestOf(size_t count) {
  std::mt19937_64 random(5);
  std::set<NodeId> nodes;
  while (nodes.size() < count) {
    NodeId id = NodeId::root(static_cast<uint32_t>(random() % 400));
    for (int i = 0; i < 12; ++i) id = id.child((random() & 1) != 0);
    nodes.insert(id);
  }
  RecordRequest request;
  request.nodes.assign(nodes.begin(), nodes.end());
  request.levels.assign(count, 3);
  return request;
}

TEST(RecordRequest, IsAGetWhileTheUrlIsShortAndAQueryBeyond) {
  const MeshUrl url = *parseMeshUrl("http://host:8080/v1/meshes/igea");
  const std::string revision(32, 'f');
  bool sawGet = false;
  bool sawQuery = false;
  size_t longestGet = 0;
  for (const size_t count : {1, 10, 500, 2'000, 3'000, 3'300, 3'600, 4'000, 6'000, 20'000}) {
    const RecordRequest request = requestOf(count);
    const auto http = toFetch(url, revision, request);
    ASSERT_TRUE(http) << http.error().message;
    EXPECT_EQ(MeshService::wantedBy(*http).nodes, request.nodes);
    EXPECT_GE(http->maxBodyBytes, count * 64);
    if (http->method == FetchRequest::Method::get) {
      sawGet = true;
      EXPECT_LE(http->url.size(), kMaxUrlOctets);
      EXPECT_TRUE(http->content.empty());
      longestGet = std::max(longestGet, http->url.size());
    } else {
      sawQuery = true;
      EXPECT_TRUE(http->url.ends_with(revision + "/splits"));
      EXPECT_EQ(http->contentType, "application/octet-stream");
      // The GET would have been too long.
      EXPECT_GT(url.splits(revision, "", "").size() + (http->content.size() * 4 + 2) / 3,
                kMaxUrlOctets);
    }
  }
  EXPECT_TRUE(sawGet);
  EXPECT_TRUE(sawQuery);
  EXPECT_GT(longestGet, 4'000U);
}

TEST(RecordRequest, SpellsTheExpansionOnlyWhereItAddsSomething) {
  EXPECT_EQ(expansionParameter({}), "");
  EXPECT_EQ(expansionParameter({2, std::nullopt}), "levels=2");
  EXPECT_EQ(expansionParameter({0, uint8_t{7}}), "significance=7");
}

TEST(RecordRequest, RefusesNodesThatAreNoAntichain) {
  RecordRequest request;
  request.nodes = {NodeId::root(1), NodeId::root(1).child(true)};
  request.levels = {0, 0};
  EXPECT_FALSE(toFetch(*parseMeshUrl("http://h/v1/meshes/x"), "r", request));
}

}  // namespace
}  // namespace meshfront
