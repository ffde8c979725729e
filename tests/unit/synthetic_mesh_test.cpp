// The synthetic mesh is sound as far as serving goes: what other tests build on.
#include "tests/data/synthetic_mesh.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(SyntheticMesh, BaseAndIndexDecode) {
  const SyntheticMesh mesh = makeSyntheticMesh();
  const auto base = decodeBaseMesh(mesh.content.base);
  ASSERT_TRUE(base) << base.error().message;
  EXPECT_EQ(base->splitCount, mesh.entries.size());
  EXPECT_EQ(base->roots.size(), mesh.base.roots.size());
  const auto index = decodeChunkIndex(mesh.content.chunkIndex);
  ASSERT_TRUE(index) << index.error().message;
  EXPECT_EQ(index->chunkCount(), mesh.content.chunks.size());
}

TEST(SyntheticMesh, ChunksHoldAllRecordsOnce) {
  const SyntheticMesh mesh = makeSyntheticMesh();
  size_t records = 0;
  for (const auto& bytes : mesh.content.chunks) {
    const auto chunk = decodeChunk(bytes, mesh.base.tables);
    ASSERT_TRUE(chunk) << chunk.error().message;
    for (const RecordEntry& entry : chunk->entries) {
      const RecordEntry* original = mesh.find(entry.id);
      ASSERT_NE(original, nullptr);
      EXPECT_EQ(entry.bitLength, original->bitLength);
      EXPECT_EQ(entry.leftIsLeaf, original->leftIsLeaf);
      EXPECT_EQ(entry.rightLevel, original->rightLevel);
      ++records;
    }
  }
  EXPECT_EQ(records, mesh.entries.size());
}

TEST(SyntheticMesh, AnswersParse) {
  const SyntheticMesh mesh = makeSyntheticMesh();
  const std::vector<NodeId> wanted = mesh.nodesAtDepth(3);
  ASSERT_GT(wanted.size(), 20U);
  Expansion expansion;
  expansion.levels = 2;
  const auto levelOf = [&](const NodeId& node) -> std::optional<unsigned> {
    return mesh.find(node)->level;
  };
  const auto bytes = mesh.answerTo(wanted, expansion);
  const auto entries = parseAnswer(bytes, wanted, expansion, mesh.base.tables, levelOf);
  ASSERT_TRUE(entries) << entries.error().message;
  EXPECT_GT(entries->size(), wanted.size());
}

}  // namespace
}  // namespace meshfront
