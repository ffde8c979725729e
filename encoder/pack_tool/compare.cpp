// meshfront-pack compare.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "encoder/pack_tool/attribute_names.h"
#include "encoder/pack_tool/commands.h"
#include "encoder/pack_tool/pack_decoding.h"
#include "encoder/pack_tool/published_mesh.h"
#include "shared/mesh/same_triangles.h"

namespace meshfront {
namespace {

using nlohmann::ordered_json;

std::string nothingOr(const std::vector<std::string>& names) {
  return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
}

// A pack's full mesh if the file is one.
Result<std::optional<GridMesh>> fromPack(const std::filesystem::path& path,
                                         std::optional<Quantization>& grid) {
  if (path.extension() != ".pack") return std::optional<GridMesh>();
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  PackStore store(*pack, std::make_shared<MemoryBudget>(kIndexBudget));
  const auto mesh = fullMesh(store);
  if (!mesh) return tl::unexpected(mesh.error());
  grid = (*pack)->metadata().quantization;
  return mesh->snapshot();
}

}  // namespace

Result<int> compareFiles(const std::filesystem::path& a, const std::filesystem::path& b,
                         unsigned bits, unsigned normalBits, bool json) {
  std::optional<Quantization> grid;
  std::optional<Quantization> gridB;
  auto meshA = fromPack(a, grid);
  if (!meshA) return tl::unexpected(meshA.error());
  auto meshB = fromPack(b, gridB);
  if (!meshB) return tl::unexpected(meshB.error());
  if (!grid) grid = gridB;
  const AttributeLayout layout = *meshA   ? (*meshA)->layout
                                 : *meshB ? (*meshB)->layout
                                          : AttributeLayout{true, normalBits};
  if (!*meshA) {
    auto read = publishedMesh(a, grid, bits, layout);
    if (!read) return tl::unexpected(read.error());
    *meshA = std::move(*read);
  }
  if (!*meshB) {
    auto read = meshOnGrid(b, *grid, layout);
    if (!read) return tl::unexpected(read.error());
    *meshB = std::move(*read);
  }
  const GridMesh& first = **meshA;
  const GridMesh& second = **meshB;
  auto difference = compareMeshes(first, second);
  const bool sameLayout = first.layout == second.layout;
  if (json) {
    fmt::print("{}\n", ordered_json{{"equal", difference.equal() && sameLayout},
                                    {"attributesA", attributeNames(first.layout)},
                                    {"attributesB", attributeNames(second.layout)},
                                    {"onlyInA", difference.missingInSecond},
                                    {"onlyInB", difference.missingInFirst},
                                    {"trianglesA", first.triangles.size()},
                                    {"trianglesB", second.triangles.size()}}
                           .dump(2));
  } else if (!sameLayout) {
    fmt::print("different: the vertices of {} carry {}, those of {} {}\n", a.string(),
               nothingOr(attributeNames(first.layout)), b.string(),
               nothingOr(attributeNames(second.layout)));
  } else if (difference.equal()) {
    fmt::print("equal: {} triangles on the same grid positions{}\n", first.triangles.size(),
               first.layout.any() ? ", the same " + nothingOr(attributeNames(first.layout)) : "");
  } else {
    fmt::print("different: {} triangles only in {}, {} only in {}\n", difference.missingInSecond,
               a.string(), difference.missingInFirst, b.string());
  }
  return difference.equal() && sameLayout ? 0 : 1;
}

}  // namespace meshfront
