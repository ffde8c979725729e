// Truncating or changing any byte of a base, chunk, index or answer is an error and never a crash:
// caught by the checksum and, where an attacker has mended that, by every reader itself.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "shared/bits/crc32c.h"
#include "shared/codec/answer.h"
#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

using Bytes = std::vector<uint8_t>;

const RecordsAtHand& torusRecords() {
  static const RecordsAtHand records(encodedContent(torus(40, 24)));
  return records;
}

// An answer: some front nodes' records, two generations below included.
struct SampleAnswer {
  std::vector<NodeId> wanted;
  Expansion expansion;
  Bytes bytes;
};
SampleAnswer sampleAnswer() {
  SampleAnswer sample;
  sample.expansion.levels = 2;
  const auto& records = torusRecords();
  BitWriter out;
  for (uint32_t tree = 0; tree < records.base().roots.size(); tree += 2) {
    if (records.base().roots[tree].isLeaf) continue;
    sample.wanted.push_back(NodeId::root(tree));
    std::vector<std::pair<NodeId, unsigned>> stack{{NodeId::root(tree), 0}};
    while (!stack.empty()) {
      const auto [id, generation] = stack.back();
      stack.pop_back();
      const auto& place = records.of(id);
      out.append(*place.bytes, place.entry.bitOffset, place.entry.bitLength);
      if (generation == 2) continue;
      if (!place.entry.rightIsLeaf) stack.emplace_back(id.child(true), generation + 1);
      if (!place.entry.leftIsLeaf) stack.emplace_back(id.child(false), generation + 1);
    }
  }
  sample.bytes = out.take();
  appendChecksum(sample.bytes);
  return sample;
}

Result<std::vector<RecordEntry>> parse(const SampleAnswer& sample, const Bytes& bytes) {
  const auto& base = torusRecords().base();
  return parseAnswer(
      bytes, sample.wanted, sample.expansion, base.tables,
      [&](const NodeId& id) -> std::optional<unsigned> { return base.roots[id.tree].level; });
}

void expectErrors(const Bytes& good, const std::function<bool(const Bytes&)>& decodes) {
  ASSERT_TRUE(decodes(good));
  for (size_t length = 0; length < good.size(); ++length)
    EXPECT_FALSE(decodes(Bytes(good.begin(), good.begin() + static_cast<ptrdiff_t>(length))));
  for (size_t at = 0; at < good.size(); ++at) {
    for (const int change : {1, 0x80, 0xFF}) {
      Bytes bad = good;
      bad[at] = static_cast<uint8_t>(bad[at] ^ change);
      EXPECT_FALSE(decodes(bad)) << "byte " << at;
    }
  }
  Bytes longer = good;
  longer.push_back(0);
  EXPECT_FALSE(decodes(longer));
}

// The same with the checksum made right again: no crash, whatever the result.
void expectSurvival(const Bytes& good, const std::function<bool(const Bytes&)>& decodes) {
  std::mt19937_64 random(9);
  const Bytes content(good.begin(), good.end() - kChecksumBytes);
  for (size_t at = 0; at < content.size(); ++at) {
    Bytes bad = content;
    bad[at] = static_cast<uint8_t>(random());
    if (random() % 4 == 0) bad.resize(at);
    appendChecksum(bad);
    decodes(bad);
  }
}

TEST(DamagedBytes, BaseIsRefused) {
  const auto decodes = [](const Bytes& b) { return decodeBaseMesh(b).has_value(); };
  expectErrors(torusRecords().content().base, decodes);
}

TEST(DamagedBytes, BaseWithRightChecksumNeverCrashesAMesh) {
  const auto refines = [](const Bytes& b) {
    auto base = decodeBaseMesh(b);
    if (!base) return false;
    auto mesh = SelectivelyRefinedMesh::fromBase(std::move(*base));
    if (!mesh) return false;
    // Real records on a wrong base: most fail, some apply.
    for (const auto& place : torusRecords().all()) {
      const auto node = mesh->find(place.entry.id);
      if (node && mesh->isActive(*node) && !mesh->isLeaf(*node))
        static_cast<void>(
            mesh->split(*node, *place.bytes, place.entry.bitOffset, place.entry.bitLength));
    }
    return true;
  };
  expectSurvival(torusRecords().content().base, refines);
}

TEST(DamagedBytes, ChunkIsRefused) {
  const auto decodes = [](const Bytes& b) {
    return decodeChunk(b, torusRecords().base().tables).has_value();
  };
  for (const auto& chunk : torusRecords().content().chunks) {
    expectErrors(chunk, decodes);
    expectSurvival(chunk, decodes);
  }
}

TEST(DamagedBytes, ChunkIndexIsRefused) {
  const auto decodes = [](const Bytes& b) { return decodeChunkIndex(b).has_value(); };
  expectErrors(torusRecords().content().chunkIndex, decodes);
  expectSurvival(torusRecords().content().chunkIndex, decodes);
}

TEST(DamagedBytes, AnswerIsRefused) {
  const SampleAnswer sample = sampleAnswer();
  const auto decodes = [&](const Bytes& b) { return parse(sample, b).has_value(); };
  expectErrors(sample.bytes, decodes);
  expectSurvival(sample.bytes, decodes);
}

TEST(Answer, ParsesParentsBeforeChildren) {
  const SampleAnswer sample = sampleAnswer();
  const auto entries = parse(sample, sample.bytes);
  ASSERT_TRUE(entries) << entries.error().message;
  EXPECT_GT(entries->size(), 2 * sample.wanted.size());
  for (size_t i = 1; i < entries->size(); ++i) EXPECT_LT((*entries)[i - 1].id, (*entries)[i].id);
  for (const RecordEntry& entry : *entries) {
    const RecordEntry& original = torusRecords().of(entry.id).entry;
    EXPECT_EQ(entry.level, original.level);
    EXPECT_EQ(entry.bitLength, original.bitLength);
  }
}

TEST(DamagedBytes, RecordsOnAMeshNeverCrash) {
  std::mt19937_64 random(10);
  for (int round = 0; round < 60; ++round) {
    auto mesh = SelectivelyRefinedMesh::fromBase(torusRecords().base()).value();
    std::vector<NodeIndex> open;
    for (NodeIndex n = 0; n < mesh.nodeCount(); ++n)
      if (!mesh.isLeaf(n)) open.push_back(n);
    while (!open.empty()) {
      const size_t pick = random() % open.size();
      const NodeIndex node = open[pick];
      open[pick] = open.back();
      open.pop_back();
      // Somebody else's record, or one with a bit turned: it may apply, fail, never break.
      const auto& place = torusRecords().all()[random() % torusRecords().all().size()];
      Bytes bytes = *place.bytes;
      const uint64_t bit = place.entry.bitOffset + random() % place.entry.bitLength;
      if (round % 2 == 0) bytes[bit / 8] ^= static_cast<uint8_t>(128U >> bit % 8);
      if (!mesh.split(node, bytes, place.entry.bitOffset, place.entry.bitLength)) continue;
      if (mesh.nodeCount() > 3000) break;
      for (const NodeIndex child : {mesh.leftChild(node), mesh.leftChild(node) + 1})
        if (!mesh.isLeaf(child)) open.push_back(child);
      if (random() % 4 == 0 && mesh.canCollapse(node)) {
        mesh.collapse(node);
        ASSERT_TRUE(mesh.resplit(node));
      }
    }
    const auto drawn = mesh.drawnCorners();
    uint64_t count = 0;
    for (const Triangle& t : drawn) {
      if (t == Triangle{}) continue;
      ++count;
      for (const uint32_t corner : t) ASSERT_LT(corner, mesh.vertexSlotCount());
    }
    EXPECT_EQ(count, mesh.drawnTriangleCount());
  }
}

}  // namespace
}  // namespace meshfront
