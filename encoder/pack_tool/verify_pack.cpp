#include "encoder/pack_tool/verify_pack.h"

#include <algorithm>
#include <random>

#include "encoder/pack_tool/pack_decoding.h"
#include "encoder/pack_tool/refinement_order.h"
#include "shared/mesh/same_triangles.h"

namespace meshfront {
namespace {

constexpr std::array<size_t, 4> kBatches = {2000, 37, 100000, 1};
constexpr std::array<double, 4> kFronts = {0.03, 0.2, 0.5, 0.85};  // shares of all splits
// Answers of one record cost a request each; after this many the order goes on with larger ones.
constexpr uint64_t kSingleRecords = 2000;

// The full mesh by leaf IDs, from which the mesh at any front follows: all faces whose corners have
// three different active ancestors.
struct Leaves {
  std::vector<NodeId> ids;
  std::vector<Triangle> faces;  // indices into ids
};

Leaves leavesOf(const SelectivelyRefinedMesh& full) {
  Leaves out;
  std::vector<uint32_t> number(full.vertexSlotCount());
  for (VertexSlot slot = 0; slot < full.vertexSlotCount(); ++slot) {
    number[slot] = static_cast<uint32_t>(out.ids.size());
    out.ids.push_back(full.id(full.nodeAt(slot)));
  }
  for (const Triangle& t : full.drawnCorners())
    if (t != Triangle{}) out.faces.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return out;
}

Triangle smallestFirst(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

bool frontIsRight(const SelectivelyRefinedMesh& mesh, const Leaves& leaves) {
  std::vector<NodeIndex> active(leaves.ids.size());
  for (size_t i = 0; i < leaves.ids.size(); ++i) {
    NodeIndex node = leaves.ids[i].tree;
    for (unsigned depth = 0; !mesh.isActive(node); ++depth)
      node = mesh.leftChild(node) + (leaves.ids[i].step(depth) ? 1 : 0);
    active[i] = node;
  }
  std::vector<Triangle> expected;
  for (const Triangle& face : leaves.faces) {
    const Triangle t{active[face[0]], active[face[1]], active[face[2]]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) expected.push_back(smallestFirst(t));
  }
  std::vector<Triangle> there;
  for (const Triangle& t : mesh.drawnCorners())
    if (t != Triangle{})
      there.push_back(smallestFirst({mesh.nodeAt(t[0]), mesh.nodeAt(t[1]), mesh.nodeAt(t[2])}));
  std::sort(expected.begin(), expected.end());
  std::sort(there.begin(), there.end());
  return expected == there && there.size() == mesh.drawnTriangleCount();
}

bool isExpected(const SelectivelyRefinedMesh& mesh, const GridMesh& expected) {
  const GridMesh got = mesh.snapshot();
  return got.layout == expected.layout && compareMeshes(got, expected).equal();
}

// Collapses a random tenth of what can be collapsed, checks the front, and splits it again.
bool collapseAndReturn(SelectivelyRefinedMesh& mesh, const Leaves& leaves, std::mt19937_64& random,
                       OrderResult& result) {
  std::vector<NodeIndex> undone;
  for (NodeIndex node = 0; node < mesh.nodeCount(); ++node) {
    // Upwards along a path, so that deeper parts are undone too.
    for (NodeIndex n = node; n != kNone && mesh.canCollapse(n) && random() % 10 < 3;
         n = mesh.parent(n)) {
      mesh.collapse(n);
      undone.push_back(n);
    }
  }
  result.collapses += undone.size();
  const bool right = frontIsRight(mesh, leaves);
  while (!undone.empty()) {
    // A node is active again once all above it are split: walk back in the reverse order.
    if (!mesh.resplit(undone.back())) return false;
    undone.pop_back();
  }
  return right;
}

Result<OrderResult> runOrder(RecordStore& store, const Leaves& leaves, const GridMesh& expected,
                             unsigned number) {
  OrderResult result;
  const auto kind = static_cast<OrderKind>(number % kOrderKinds);
  result.order = nameOf(kind);
  result.seed = number + 1;
  result.batch = kBatches[(number + number / kOrderKinds) % kBatches.size()];
  auto mesh = baseOf(store);
  if (!mesh) return tl::unexpected(mesh.error());
  RefinementOrder order(kind, result.seed, *mesh);
  for (NodeIndex node = 0; node < mesh->nodeCount(); ++node)
    if (!mesh->isLeaf(node)) order.add(node);
  std::mt19937_64 random(result.seed);
  const bool collapsing = number % 2 == 1;
  size_t nextFront = 0;
  std::vector<NodeIndex> batch;
  while (!order.empty()) {
    const size_t wanted =
        result.batch == 1 && mesh->splitsApplied() >= kSingleRecords ? 5000 : result.batch;
    batch.clear();
    while (!order.empty() && batch.size() < wanted) batch.push_back(order.takeFirst());
    const auto requestBits = refine(store, *mesh, batch);
    if (!requestBits) return tl::unexpected(requestBits.error());
    result.requestBits += *requestBits;
    for (const NodeIndex node : batch)
      for (const NodeIndex child : {mesh->leftChild(node), mesh->leftChild(node) + 1})
        if (!mesh->isLeaf(child)) order.add(child);
    const auto share =
        static_cast<double>(mesh->splitsApplied()) / static_cast<double>(mesh->splitCount());
    if (nextFront < kFronts.size() && share >= kFronts[nextFront]) {
      while (nextFront < kFronts.size() && share >= kFronts[nextFront]) ++nextFront;
      ++result.frontsChecked;
      if (!frontIsRight(*mesh, leaves)) ++result.frontsWrong;
      if (collapsing) {
        ++result.frontsChecked;
        if (!collapseAndReturn(*mesh, leaves, random, result)) ++result.frontsWrong;
      }
    }
  }
  result.finalExact = mesh->complete() && isExpected(*mesh, expected);
  return result;
}

}  // namespace

Result<std::vector<OrderResult>> verifyOrders(
    RecordStore& store, const GridMesh& expected, unsigned orders,
    const std::function<void(const OrderResult&)>& report) {
  const auto full = fullMesh(store);
  if (!full) return tl::unexpected(full.error());
  if (!isExpected(*full, expected))
    return fail("the pack's full mesh is not the input on the pack's grid");
  const Leaves leaves = leavesOf(*full);
  std::vector<OrderResult> results;
  for (unsigned number = 0; number < orders; ++number) {
    auto result = runOrder(store, leaves, expected, number);
    if (!result) return tl::unexpected(result.error());
    results.push_back(*result);
    if (report) report(*result);
  }
  return results;
}

}  // namespace meshfront
