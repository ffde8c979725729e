#include "shared/refinement/selectively_refined_mesh.h"
#include "tests/fuzz/fuzz_bases.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

constexpr size_t kMaxNodes = 1500;  // so that an input takes milliseconds

void checkMesh(const SelectivelyRefinedMesh& mesh) {
  uint64_t drawn = 0;
  for (const Triangle& t : mesh.drawnCorners()) {
    if (t == Triangle{}) continue;
    ++drawn;
    promise(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "corners differ");
    for (const uint32_t corner : t) {
      promise(corner < mesh.vertexSlotCount(), "corners are in range");
      const NodeIndex node = mesh.nodeAt(corner);
      promise(node != kNone && mesh.isActive(node), "corners are active");
    }
  }
  promise(drawn == mesh.drawnTriangleCount(), "drawn triangles are counted");
  const auto limit = static_cast<int32_t>(1U << mesh.base().quantizationBits);
  for (VertexSlot slot = 0; slot < mesh.vertexSlotCount(); ++slot) {
    const NodeIndex node = mesh.nodeAt(slot);
    if (node == kNone || mesh.isVirtual(node)) continue;
    for (const int32_t v : mesh.positions()[slot])
      promise(v >= 0 && v < limit, "vertices are on the grid");
    promise(mesh.find(mesh.id(node)) == node, "nodes are found by their IDs");
  }
  const GridMesh snapshot = mesh.snapshot();
  promise(snapshot.triangles.size() == drawn, "a snapshot has all that is drawn");
}

// The record that starts at the input's next byte, however long; what does not parse takes all.
bool splitBy(FuzzInput& in, SelectivelyRefinedMesh& mesh, NodeIndex node) {
  BitReader reader(in.rest());
  const Record record = readRecord(reader, mesh.base().tables, mesh.level(node));
  const auto all = static_cast<uint32_t>(in.rest().size() * 8);
  const uint32_t bits = reader.overrun() ? all : record.cutEnd;
  const auto done = mesh.split(node, in.rest(), 0, bits);
  in.take((bits + 7) / 8);
  return done.has_value();
}

}  // namespace

bool refineMesh(Bytes input) {
  FuzzInput in(input);
  auto mesh = SelectivelyRefinedMesh::fromBase(baseOf(in.byte()));
  if (!mesh) return false;
  bool allApplied = true;
  unsigned checks = 6;  // on the way; each looks at everything
  while (!in.empty() && mesh->nodeCount() < kMaxNodes) {
    const uint8_t what = in.byte();
    const auto node = static_cast<NodeIndex>(in.word() % mesh->nodeCount());
    if (what < 160) {
      if (mesh->isLeaf(node) || !mesh->isActive(node)) {
        promise(!mesh->split(node, in.rest(), 0, 8), "only active inner nodes are split");
        allApplied = false;
      } else {
        allApplied = splitBy(in, *mesh, node) && allApplied;
      }
    } else if (what < 208) {
      if (mesh->canCollapse(node)) mesh->collapse(node);
    } else {
      const bool able = mesh->hasRecord(node) && mesh->isActive(node);
      promise(mesh->resplit(node).has_value() == able, "what was split can be split again");
    }
    if (what % 16 == 15 && checks > 0) {
      --checks;
      checkMesh(*mesh);
    }
  }
  checkMesh(*mesh);
  return allApplied;
}

}  // namespace meshfront::fuzz
