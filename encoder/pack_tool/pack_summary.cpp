#include "encoder/pack_tool/pack_summary.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "shared/bits/crc32c.h"
#include "shared/codec/base_connectivity.h"
#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"

namespace meshfront {

Sizes summarise(std::vector<uint64_t>& sizes) {
  Sizes out;
  if (sizes.empty()) return out;
  std::sort(sizes.begin(), sizes.end());
  out.count = sizes.size();
  out.bytes = std::accumulate(sizes.begin(), sizes.end(), uint64_t{0});
  out.least = sizes.front();
  out.median = sizes[sizes.size() / 2];
  out.most = sizes.back();
  return out;
}

Result<PackSummary> summarise(const Pack& pack) {
  const auto base = decodeBaseMesh(pack.base());
  if (!base) return tl::unexpected(base.error());
  const auto index = decodeChunkIndex(pack.chunkIndex());
  if (!index) return tl::unexpected(index.error());
  PackSummary out;
  out.roots = static_cast<uint32_t>(base->roots.size());
  out.virtualTrees = base->virtualCount;
  out.layout = base->tables.attributes.layout;
  out.treeNumberBits =
      base->treeCount() < 2 ? 0 : static_cast<unsigned>(std::bit_width(base->treeCount() - 1));

  // A part takes what writing it alone takes; the roots take the rest.
  BitWriter tables;
  writeCodeTables(tables, base->tables);
  out.baseTableBits = tables.bitCount();
  BitWriter triangles;
  writeBaseConnectivity(triangles, base->triangles, base->treeCount());
  out.baseTriangleBits = triangles.bitCount();
  const uint64_t all = pack.base().size() * 8;
  const uint64_t known = out.baseTableBits + out.baseTriangleBits;
  const uint64_t rest = all > known ? all - known : 0;
  constexpr uint64_t kMagicBits = 32;
  out.baseOtherBits = std::min<uint64_t>(kMagicBits + kChecksumBytes * 8, rest);
  out.baseRootBits = rest - out.baseOtherBits;

  std::vector<uint64_t> sizes;
  uint32_t number = 0;
  for (const auto& band : index->firstNodes) {
    std::vector<uint64_t> ofBand;
    for (size_t i = 0; i < band.size(); ++i) {
      const auto chunk = pack.chunk(number++);
      if (!chunk) return tl::unexpected(chunk.error());
      ofBand.push_back(chunk->size());
    }
    sizes.insert(sizes.end(), ofBand.begin(), ofBand.end());
    out.chunksByBand.push_back(summarise(ofBand));
  }
  out.chunks = summarise(sizes);
  return out;
}

}  // namespace meshfront
