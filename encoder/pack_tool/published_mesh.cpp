#include "encoder/pack_tool/published_mesh.h"

#include "encoder/cleaning/close_mesh.h"
#include "shared/mesh_files/mesh_files.h"

namespace meshfront {

Result<ExpectedMesh> publishedMesh(const std::filesystem::path& path,
                                   std::optional<Quantization>& grid, unsigned bits) {
  auto mesh = readMesh(path);
  if (!mesh) return tl::unexpected(mesh.error());
  CleaningReport report;
  auto closed = closeMesh(std::move(*mesh), report);
  if (!closed) return fail(closed.error().code, path.string() + ": " + closed.error().message);
  if (!grid) grid = quantizationFor(closed->positions, bits);
  ExpectedMesh out;
  for (const auto& p : closed->positions) out.positions.push_back(grid->toGrid(p));
  out.triangles = std::move(closed->triangles);
  out.triangles.resize(closed->realTriangleCount);
  return out;
}

Result<ExpectedMesh> meshOnGrid(const std::filesystem::path& path, const Quantization& grid) {
  auto mesh = readMesh(path);
  if (!mesh) return tl::unexpected(mesh.error());
  ExpectedMesh out;
  for (const auto& p : mesh->positions) out.positions.push_back(grid.toGrid(p));
  out.triangles = std::move(mesh->triangles);
  return out;
}

}  // namespace meshfront
