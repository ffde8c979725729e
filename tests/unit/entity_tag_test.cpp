#include "shared/store/entity_tag.h"

#include <gtest/gtest.h>

#include <set>

namespace meshfront {
namespace {

const std::string kRevision(32, 'a');

TEST(EntityTag, NamesItsResource) {
  const uint32_t key = resourceKey(kRevision, "chunks/5");
  const std::string tag = constantTag(kRevision, key);
  EXPECT_EQ(tag.substr(0, 34), "\"" + kRevision + "-");
  EXPECT_FALSE(isTagOfOtherResource(tag, key));
  EXPECT_TRUE(isTagOfOtherResource(tag, resourceKey(kRevision, "chunks/6")));
  EXPECT_TRUE(isTagOfOtherResource(tag, resourceKey(std::string(32, 'b'), "chunks/5")));
  const std::vector<uint8_t> bits{1, 2, 3};
  const std::vector<uint8_t> content{9, 8, 7, 6, 5};
  Expansion levels;
  levels.levels = 3;
  Expansion significance;
  significance.significance = 3;
  const std::set<uint32_t> keys{
      recordsKey(kRevision, bits, {}), recordsKey(kRevision, bits, levels),
      recordsKey(kRevision, bits, significance), recordsKey(kRevision, content, {})};
  EXPECT_EQ(keys.size(), 4U);
  const std::string records = recordsTag(content, *keys.begin());
  EXPECT_EQ(records.substr(0, 12), "\"08070605-5-");
  EXPECT_FALSE(isTagOfOtherResource(records, *keys.begin()));
  EXPECT_TRUE(isTagOfOtherResource(records, *keys.rbegin()));
}

TEST(EntityTag, OtherFormsTellNothing) {
  for (const char* tag :
       {"", "\"", "\"\"", "\"abc\"", "W/\"08070605-5-00000000\"", "\"-\"", "\"--\"",
        "\"08070605-x-00000000\"", "\"5f3e1a2b-7d0\"", "\"0-00000000\"", "*"})
    EXPECT_FALSE(isTagOfOtherResource(tag, 1)) << tag;
  EXPECT_TRUE(isTagOfOtherResource("\"08070605-5-00000000\"", 1));
  const std::vector<uint8_t> content{1, 2};
  EXPECT_FALSE(isTagOfOtherDocument(documentTag(content), content));
  EXPECT_FALSE(isTagOfOtherDocument("\"x\"", content));
  EXPECT_TRUE(isTagOfOtherDocument("\"" + kRevision + "\"", content));
}

}  // namespace
}  // namespace meshfront
