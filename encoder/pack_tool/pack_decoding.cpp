#include "encoder/pack_tool/pack_decoding.h"

#include <algorithm>

#include "shared/hierarchy/tree_bitstring.h"

namespace meshfront {
namespace {

constexpr size_t kFullBatch = 100000;

}  // namespace

Result<SelectivelyRefinedMesh> baseOf(RecordStore& store) {
  const auto bytes = store.base(Waiting::allowed);
  if (!bytes) return tl::unexpected(bytes.error());
  auto base = decodeBaseMesh(bytes->bytes());
  if (!base) return tl::unexpected(base.error());
  return SelectivelyRefinedMesh::fromBase(std::move(*base));
}

Result<uint64_t> refine(RecordStore& store, SelectivelyRefinedMesh& mesh,
                        std::span<const NodeIndex> nodes) {
  std::vector<NodeId> wanted;
  for (const NodeIndex node : nodes) wanted.push_back(mesh.id(node));
  std::sort(wanted.begin(), wanted.end());
  const auto request = encodeTreeBitstring(wanted);
  if (!request) return tl::unexpected(request.error());
  const auto decoded = decodeTreeBitstring(*request, wanted.size());
  if (!decoded) return tl::unexpected(decoded.error());
  if (*decoded != wanted) return fail("request: the bitstring does not give the set back");
  CollectLimits limits;
  limits.maxWanted = wanted.size();
  const auto answer = store.collect(*decoded, {}, limits, Waiting::allowed);
  if (!answer) return tl::unexpected(answer.error());
  const auto entries = parseAnswer(answer->bytes, *decoded, {}, mesh.base().tables,
                                   [&](const NodeId& id) -> std::optional<unsigned> {
                                     const auto node = mesh.find(id);
                                     if (!node) return std::nullopt;
                                     return mesh.level(*node);
                                   });
  if (!entries) return tl::unexpected(entries.error());
  for (const RecordEntry& entry : *entries) {
    const auto done =
        mesh.split(*mesh.find(entry.id), answer->bytes, entry.bitOffset, entry.bitLength);
    if (!done) return tl::unexpected(done.error());
  }
  return request->size() * 8;
}

Result<SelectivelyRefinedMesh> fullMesh(RecordStore& store) {
  auto mesh = baseOf(store);
  if (!mesh) return mesh;
  std::vector<NodeIndex> open;
  for (NodeIndex node = 0; node < mesh->nodeCount(); ++node)
    if (!mesh->isLeaf(node)) open.push_back(node);
  while (!open.empty()) {
    const size_t count = std::min(open.size(), kFullBatch);
    const std::vector<NodeIndex> batch(open.end() - static_cast<ptrdiff_t>(count), open.end());
    open.resize(open.size() - count);
    if (auto done = refine(store, *mesh, batch); !done) return tl::unexpected(done.error());
    for (const NodeIndex node : batch)
      for (const NodeIndex child : {mesh->leftChild(node), mesh->leftChild(node) + 1})
        if (!mesh->isLeaf(child)) open.push_back(child);
  }
  if (!mesh->complete()) return fail("pack: fewer records than its base promises");
  return mesh;
}

}  // namespace meshfront
