#include "encoder/pack_tool/published_mesh.h"

#include "encoder/cleaning/close_mesh.h"
#include "shared/mesh_files/mesh_files.h"

namespace meshfront {
namespace {

// What of the wanted layout a mesh has.
template <typename Mesh>
void carry(const Mesh& mesh, const AttributeLayout& layout, GridMesh& out) {
  out.layout.colours = layout.colours && !mesh.colours.empty();
  out.layout.normalBits = mesh.normals.empty() ? 0 : layout.normalBits;
  out.attributes = packAttributes(mesh.colours, mesh.normals, out.layout);
}

}  // namespace

Result<GridMesh> publishedMesh(const std::filesystem::path& path, std::optional<Quantization>& grid,
                               unsigned bits, const AttributeLayout& layout) {
  auto mesh = readMesh(path);
  if (!mesh) return tl::unexpected(mesh.error());
  CleaningReport report;
  auto closed = closeMesh(std::move(*mesh), report);
  if (!closed) return fail(closed.error().code, path.string() + ": " + closed.error().message);
  if (!grid) grid = quantizationFor(closed->positions, bits);
  GridMesh out;
  for (const auto& p : closed->positions) out.positions.push_back(grid->toGrid(p));
  carry(*closed, layout, out);
  out.triangles = std::move(closed->triangles);
  out.triangles.resize(closed->realTriangleCount);
  return out;
}

Result<GridMesh> meshOnGrid(const std::filesystem::path& path, const Quantization& grid,
                            const AttributeLayout& layout) {
  auto mesh = readMesh(path);
  if (!mesh) return tl::unexpected(mesh.error());
  GridMesh out;
  for (const auto& p : mesh->positions) out.positions.push_back(grid.toGrid(p));
  carry(*mesh, layout, out);
  out.triangles = std::move(mesh->triangles);
  return out;
}

}  // namespace meshfront
