#include <gtest/gtest.h>

#include <cmath>

#include "encoder/pack_tool/node_name.h"
#include "encoder/pack_tool/node_record.h"
#include "encoder/pack_tool/pack_summary.h"
#include "encoder/pack_tool/static_export.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront {
namespace {

TEST(NodeName, GoesThereAndBack) {
  NodeId deepest = NodeId::root(UINT32_MAX);
  for (unsigned i = 0; i < kMaxDepth; ++i) deepest = deepest.child(i % 3 == 0);
  for (const NodeId& node : {NodeId::root(0), NodeId::root(17).child(false).child(true), deepest}) {
    const auto parsed = parseNodeName(nodeName(node));
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_EQ(*parsed, node);
  }
  EXPECT_EQ(nodeName(NodeId::root(17).child(false).child(true)), "17:01");
  EXPECT_EQ(nodeName(NodeId::root(5)), "5:");
}

TEST(NodeName, RefusesWhatIsNone) {
  for (const std::string text :
       {"", ":", "5", "5;01", "-1:0", "+1:0", " 1:0", "1:0 ", "4294967296:", "1:2", "x:"})
    EXPECT_FALSE(parseNodeName(text)) << text;
  EXPECT_TRUE(parseNodeName("1:" + std::string(kMaxDepth, '1')));
  EXPECT_FALSE(parseNodeName("1:" + std::string(kMaxDepth + 1, '1')));
}

TEST(Sizes, AreSummarised) {
  std::vector<uint64_t> none;
  EXPECT_EQ(summarise(none).count, 0U);
  std::vector<uint64_t> sizes{9, 1, 5, 7, 3};
  const Sizes s = summarise(sizes);
  EXPECT_EQ(s.count, 5U);
  EXPECT_EQ(s.bytes, 25U);
  EXPECT_EQ(s.least, 1U);
  EXPECT_EQ(s.median, 5U);
  EXPECT_EQ(s.most, 9U);
}

// A sheet with a hole, so that there are virtual vertices, with colours and normals.
IndexedMesh colouredSheet() {
  IndexedMesh mesh =
      gridPatchWithout(14, 14, [](uint32_t x, uint32_t y) { return x > 4 && x < 8 && y == 6; });
  for (auto& p : mesh.positions) {
    p[2] = std::sin(p[0]) + std::cos(2 * p[1]);
    const auto shade = static_cast<uint8_t>(128 + 40 * p[2]);
    mesh.colours.push_back({shade, 100, static_cast<uint8_t>(9 * p[0]), 255});
    mesh.normals.push_back({static_cast<float>(std::sin(p[0])), 0.5F, 1});
  }
  return mesh;
}

class NodeRecordTest : public ::testing::Test {
 protected:
  NodeRecordTest() : records_(encodedContent(colouredSheet())) {
    EXPECT_TRUE(writePack(folder_ / "a.pack", records_.content()));
    pack_ = Pack::open(folder_ / "a.pack").value();
  }
  // The mesh at the front where only the node's ancestors are split.
  [[nodiscard]] SelectivelyRefinedMesh meshAbove(const NodeId& id) const {
    auto mesh = SelectivelyRefinedMesh::fromBase(records_.base()).value();
    for (unsigned depth = 0; depth < id.depth; ++depth)
      EXPECT_TRUE(records_.split(mesh, *mesh.find(id.ancestor(depth))));
    return mesh;
  }
  TemporaryFolder folder_;
  RecordsAtHand records_;
  std::shared_ptr<const Pack> pack_;
};

TEST_F(NodeRecordTest, IsWhatASplitDoes) {
  for (const auto& place : records_.all()) {
    const NodeId id = place.entry.id;
    const auto record = nodeRecord(*pack_, id);
    ASSERT_TRUE(record) << nodeName(id) << ": " << record.error().message;
    EXPECT_EQ(record->level, place.entry.level);
    EXPECT_EQ(record->bitOffset, place.entry.bitOffset);
    EXPECT_EQ(record->bitLength, place.entry.bitLength);
    EXPECT_EQ(record->bits.size(), record->bitLength);
    EXPECT_EQ(record->headerBits + record->levelBits + record->classBits + record->valueBits +
                  record->colourBits + record->normalBits,
              record->record.cutBegin);
    auto mesh = meshAbove(id);
    const NodeIndex node = *mesh.find(id);
    const uint32_t faces = mesh.edges().faceSlots();
    EXPECT_EQ(record->attributes, mesh.attributes()[mesh.slot(node)]);
    ASSERT_TRUE(records_.split(mesh, node));
    const NodeIndex right = mesh.leftChild(node) + 1;
    for (size_t i = 0; i < 3; ++i)
      EXPECT_EQ(record->position[i] + record->delta[i], mesh.positions()[mesh.slot(right)][i]);
    EXPECT_EQ(record->rightAttributes, mesh.attributes()[mesh.slot(right)]);
    // The new faces are (u, t, l) and (u, r, t).
    ASSERT_EQ(mesh.edges().faceSlots(), faces + 2);
    const auto corner = [&](uint32_t face, uint32_t i) {
      return mesh.id(mesh.nodeAt(mesh.edges().origin(HalfEdgeMesh::halfEdge(face, i))));
    };
    EXPECT_EQ(corner(faces, 2), record->ring[record->leftEntry].node);
    EXPECT_EQ(corner(faces + 1, 1), record->ring[record->rightEntry].node);
    for (const auto& entry : record->ring)
      EXPECT_EQ(entry.isVirtual, entry.node.tree >= records_.base().roots.size());
  }
}

TEST_F(NodeRecordTest, SaysWhyThereIsNone) {
  const auto problem = [&](const NodeId& id) {
    const auto record = nodeRecord(*pack_, id);
    EXPECT_FALSE(record);
    EXPECT_EQ(record.error().code, ErrorCode::notFound);
    return record.error().message;
  };
  const BaseMesh& base = records_.base();
  const NodeId virtualVertex = NodeId::root(static_cast<uint32_t>(base.roots.size()));
  EXPECT_NE(problem(virtualVertex).find("virtual"), std::string::npos);
  EXPECT_NE(problem(NodeId::root(base.treeCount())).find("no tree"), std::string::npos);
  for (const auto& place : records_.all()) {
    if (!place.entry.leftIsLeaf) continue;
    const NodeId leaf = place.entry.id.child(false);
    EXPECT_NE(problem(leaf).find("is a leaf, a vertex"), std::string::npos);
    EXPECT_NE(problem(leaf.child(true)).find("above it is a leaf"), std::string::npos);
    break;
  }
}

TEST_F(NodeRecordTest, SummaryCountsThePack) {
  const auto summary = summarise(*pack_);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->roots, records_.base().roots.size());
  EXPECT_EQ(summary->virtualTrees, 2U);
  EXPECT_TRUE(summary->layout.colours);
  EXPECT_EQ(summary->chunks.count, records_.content().chunks.size());
  EXPECT_EQ(summary->baseTableBits + summary->baseRootBits + summary->baseTriangleBits +
                summary->baseOtherBits,
            records_.content().base.size() * 8);
  EXPECT_GE(1U << summary->treeNumberBits, records_.base().treeCount());
}

TEST_F(NodeRecordTest, ExportLeavesNothingWhenCancelled) {
  const auto countFiles = [&] {
    return std::distance(std::filesystem::directory_iterator(folder_.path()), {});
  };
  const auto before = countFiles();
  for (int last = 0; last < 8; ++last) {
    int asked = 0;
    EXPECT_FALSE(
        exportStaticFiles(*pack_, folder_ / "site", false, [&] { return asked++ == last; }));
    EXPECT_EQ(countFiles(), before);
  }
  const auto done = exportStaticFiles(*pack_, folder_ / "site", false);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->files, 8 + records_.content().chunks.size());
  EXPECT_EQ(countFiles(), before + 1);
}

}  // namespace
}  // namespace meshfront
