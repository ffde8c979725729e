#include "shared/store/mesh_metadata.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

MeshMetadata example() {
  MeshMetadata m;
  m.name = "bunny-1.0_a";
  m.revision = "0123456789abcdef0123456789abcdef";
  m.vertexCount = 34834;
  m.triangleCount = 69451;
  m.baseVertexCount = 70;
  m.baseTriangleCount = 140;
  m.splitCount = 34764;
  m.maxLevel = 16;
  m.maxDepth = 21;
  m.quantization = {14, {-0.1, 0.03, 1e-17}, 0.0000095367431640625};
  m.boundsMin = {-0.1, 0.03, 0};
  m.boundsMax = {0.1 + 0.2, 1, 2};
  m.attributes = {"colour", "normal"};
  m.baseBytes = 3210;
  m.recordBytes = 160000;
  m.chunkBytes = 162000;
  m.chunkCount = 80;
  return m;
}

std::string without(std::string json, const std::string& key) {
  const size_t at = json.find("\"" + key + "\"");
  return json.replace(at, key.size() + 2, "\"other\"");
}

TEST(MeshMetadata, SurvivesJsonExactly) {
  const MeshMetadata m = example();
  const auto back = metadataFromJson(toJson(m));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, m.name);
  EXPECT_EQ(back->revision, m.revision);
  EXPECT_EQ(back->vertexCount, m.vertexCount);
  EXPECT_EQ(back->triangleCount, m.triangleCount);
  EXPECT_EQ(back->baseVertexCount, m.baseVertexCount);
  EXPECT_EQ(back->baseTriangleCount, m.baseTriangleCount);
  EXPECT_EQ(back->splitCount, m.splitCount);
  EXPECT_EQ(back->maxLevel, m.maxLevel);
  EXPECT_EQ(back->maxDepth, m.maxDepth);
  EXPECT_EQ(back->quantization.bits, m.quantization.bits);
  EXPECT_EQ(back->quantization.origin, m.quantization.origin);  // doubles to the last bit
  EXPECT_EQ(back->quantization.step, m.quantization.step);
  EXPECT_EQ(back->boundsMin, m.boundsMin);
  EXPECT_EQ(back->boundsMax, m.boundsMax);
  EXPECT_EQ(back->attributes, m.attributes);
  EXPECT_EQ(back->baseBytes, m.baseBytes);
  EXPECT_EQ(back->recordBytes, m.recordBytes);
  EXPECT_EQ(back->chunkBytes, m.chunkBytes);
  EXPECT_EQ(back->chunkCount, m.chunkCount);
}

TEST(MeshMetadata, CarriesTheInterfacesUriTemplates) {
  const std::string json = toJson(example());
  const std::string fixed = "/v1/meshes/bunny-1.0_a/0123456789abcdef0123456789abcdef";
  for (const std::string& link :
       {fixed + "/base", fixed + "/splits/{ids}{?levels,significance}",
        fixed + "/splits{?levels,significance}", fixed + "/chunks", fixed + "/chunks/{n}"})
    EXPECT_NE(json.find("\"" + link + "\""), std::string::npos) << link;
}

TEST(MeshMetadata, RefusesWhatIsMissing) {
  const std::string json = toJson(example());
  for (const char* key : {"name", "revision", "splitCount", "maxLevel", "bits", "origin", "step",
                          "min", "max", "attributes", "chunkCount", "quantization", "bounds"}) {
    const auto result = metadataFromJson(without(json, key));
    ASSERT_FALSE(result) << key;
    EXPECT_NE(result.error().message.find(key), std::string::npos) << result.error().message;
  }
}

TEST(MeshMetadata, RefusesWrongTypesAndRanges) {
  const std::string json = toJson(example());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = json;
    const size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return changed.replace(at, from.size(), to);
  };
  EXPECT_FALSE(metadataFromJson(with("\"maxLevel\":16", "\"maxLevel\":-1")));
  EXPECT_FALSE(metadataFromJson(with("\"maxLevel\":16", "\"maxLevel\":4294967296")));
  EXPECT_FALSE(metadataFromJson(with("\"bits\":14", "\"bits\":21")));
  EXPECT_FALSE(metadataFromJson(with("\"bits\":14", "\"bits\":\"14\"")));
  EXPECT_FALSE(metadataFromJson(with("\"step\":9", "\"step\":-9")));
  EXPECT_FALSE(metadataFromJson(with("\"name\":\"bunny-1.0_a\"", "\"name\":\"../a\"")));
  EXPECT_FALSE(metadataFromJson(with("0123456789abcdef\"", "0123456789abcdeF\"")));
}

TEST(MeshMetadata, RefusesEveryTruncation) {
  const std::string json = toJson(example());
  for (size_t length = 0; length + 2 < json.size(); ++length)
    EXPECT_FALSE(metadataFromJson(json.substr(0, length))) << length;
  EXPECT_FALSE(metadataFromJson("[]"));
  EXPECT_FALSE(metadataFromJson("null"));
}

TEST(MeshName, HasAClosedAlphabet) {
  EXPECT_TRUE(isMeshName("a"));
  EXPECT_TRUE(isMeshName(std::string(64, 'x')));
  EXPECT_FALSE(isMeshName(std::string(65, 'x')));
  for (const char* name : {"", ".", "..", ".a", "a/b", "a b", "a%41", "\xC3\xA9", "a\n"})
    EXPECT_FALSE(isMeshName(name)) << name;
}

}  // namespace
}  // namespace meshfront
