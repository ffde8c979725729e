#include "shared/http/split_request.h"

#include <gtest/gtest.h>

#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"

namespace meshfront {
namespace {

constexpr unsigned kFinest = 9;
constexpr size_t kMost = 100;

std::vector<NodeId> someNodes() {
  return {NodeId::root(0).child(false), NodeId::root(0).child(true), NodeId::root(5),
          NodeId::root(7).child(true).child(false)};
}

std::string someIds() {
  return base64urlEncode(*encodeTreeBitstring(someNodes()));
}

Result<SplitRequest> parse(std::string_view ids, std::string_view query = {}) {
  return parseSplitUrl(ids, !query.empty(), query, kFinest, kMost);
}

TEST(SplitRequest, ReadsTheOneSpelling) {
  const auto request = parse(someIds());
  ASSERT_TRUE(request) << request.error().message;
  EXPECT_EQ(request->wanted, someNodes());
  EXPECT_TRUE(request->expansion.none());
}

TEST(SplitRequest, KnowsTheWireBytes) {
  // One tree (Exp-Golomb order 3: 1001), number 5 (00110), its root: 00; padded: 93 00.
  const auto root = parse("kwA");
  ASSERT_TRUE(root) << root.error().message;
  ASSERT_EQ(root->wanted.size(), 1U);
  EXPECT_EQ(root->wanted[0], NodeId::root(5));
}

TEST(SplitRequest, ReadsTheExpansion) {
  const auto levels = parse(someIds(), "levels=63");
  ASSERT_TRUE(levels);
  EXPECT_EQ(levels->expansion.levels, 63U);
  EXPECT_FALSE(levels->expansion.significance);
  const auto significance = parse(someIds(), "significance=0");
  ASSERT_TRUE(significance);
  EXPECT_EQ(significance->expansion.significance, 0);
  EXPECT_TRUE(parse(someIds(), "significance=9"));
}

TEST(SplitRequest, RefusesEveryOtherQuery) {
  for (const char* query : {"levels=0",
                            "levels=01",
                            "levels=",
                            "levels=+1",
                            "levels=-1",
                            "levels=1 ",
                            "levels=1.0",
                            "levels=64",
                            "levels=4294967297",
                            "levels=%31",
                            "levels",
                            "levels=1&levels=1",
                            "levels=1&significance=1",
                            "significance=10",
                            "significance=00",
                            "Levels=1",
                            "x=1",
                            "&",
                            "levels=1&",
                            "=",
                            "significance=256"}) {
    const auto request = parse(someIds(), query);
    ASSERT_FALSE(request) << query;
    EXPECT_EQ(request.error().code, ErrorCode::invalid);
  }
  EXPECT_FALSE(parseSplitUrl(someIds(), true, "", kFinest, kMost));  // a bare question mark
}

TEST(SplitRequest, RefusesEveryOtherSpellingOfTheSet) {
  const std::string ids = someIds();
  EXPECT_FALSE(parse(""));
  EXPECT_FALSE(parse(ids + "A"));
  EXPECT_FALSE(parse(ids + "AAAA"));  // trailing zero bytes
  EXPECT_FALSE(parse(ids + "="));
  EXPECT_FALSE(parse(ids.substr(0, ids.size() - 1)));
  EXPECT_FALSE(parse("%41" + ids.substr(1)));
  std::vector<uint8_t> bytes = *encodeTreeBitstring(someNodes());
  bytes.back() |= 1;  // a padding bit
  EXPECT_FALSE(parse(base64urlEncode(bytes)));
  EXPECT_FALSE(parse(base64urlEncode(*encodeTreeBitstring({}))));  // the empty set
}

TEST(SplitRequest, LimitsTheSet) {
  std::vector<NodeId> many;
  for (uint32_t i = 0; i <= kMost; ++i) many.push_back(NodeId::root(i));
  const auto bytes = *encodeTreeBitstring(many);
  const auto request = parseSplitQuery(bytes, false, {}, kFinest, kMost);
  ASSERT_FALSE(request);
  EXPECT_EQ(request.error().code, ErrorCode::tooLarge);
  EXPECT_TRUE(parseSplitQuery(bytes, false, {}, kFinest, kMost + 1));
}

TEST(SplitRequest, WritesTheUrlItReads) {
  Expansion expansion;
  const auto bytes = *encodeTreeBitstring(someNodes());
  EXPECT_EQ(splitTarget("m", "r", bytes, expansion), "/v1/meshes/m/r/splits/" + someIds());
  expansion.levels = 2;
  EXPECT_EQ(splitTarget("m", "r", bytes, expansion),
            "/v1/meshes/m/r/splits/" + someIds() + "?levels=2");
  expansion = {};
  expansion.significance = 0;
  EXPECT_EQ(expansionQuery(expansion), "?significance=0");
}

}  // namespace
}  // namespace meshfront
