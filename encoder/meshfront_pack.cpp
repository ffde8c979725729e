// meshfront-pack: what is in a pack, and proof that it is right.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "encoder/pack_tool/pack_decoding.h"
#include "encoder/pack_tool/published_mesh.h"
#include "encoder/pack_tool/verify_pack.h"
#include "shared/mesh/same_triangles.h"
#include "shared/store/pack.h"

namespace {

using namespace meshfront;
using nlohmann::ordered_json;

constexpr size_t kIndexBudget = size_t{4} << 30;  // a verification touches every chunk

Result<int> info(const std::string& path, bool json) {
  const auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  const MeshMetadata& m = (*pack)->metadata();
  const auto report = ordered_json::parse((*pack)->reportJson(), nullptr, false);
  if (json) {
    ordered_json out;
    out["metadata"] = ordered_json::parse(toJson(m));
    out["report"] = report;
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  const double splits = static_cast<double>(std::max<uint64_t>(m.splitCount, 1));
  fmt::print("mesh        {}, revision {}\n", m.name, m.revision);
  fmt::print("finest      {} vertices, {} triangles\n", m.vertexCount, m.triangleCount);
  fmt::print("base        {} vertices, {} triangles, {} bytes\n", m.baseVertexCount,
             m.baseTriangleCount, m.baseBytes);
  fmt::print("hierarchy   {} splits, levels 0 to {}, deepest node {}\n", m.splitCount, m.maxLevel,
             m.maxDepth);
  fmt::print("bounds      {} {} {} to {} {} {}\n", m.boundsMin[0], m.boundsMin[1], m.boundsMin[2],
             m.boundsMax[0], m.boundsMax[1], m.boundsMax[2]);
  fmt::print("grid        {} bits, step {}\n", m.quantization.bits, m.quantization.step);
  fmt::print("records     {} bytes, {:.2f} bits a split\n", m.recordBytes,
             static_cast<double>(m.recordBytes) * 8 / splits);
  fmt::print("chunks      {}, {} bytes\n", m.chunkCount, m.chunkBytes);
  if (report.is_object()) {
    for (const char* part : {"bitsPerSplit", "cleaning", "simplification"}) {
      if (!report.contains(part)) continue;
      for (const auto& [key, value] : report[part].items())
        fmt::print(
            "{:<11} {} {}\n", part, key,
            value.is_number_float() ? fmt::format("{:.3f}", value.get<double>()) : value.dump());
    }
  }
  return 0;
}

Result<int> verify(const std::string& path, const std::string& against, unsigned orders,
                   bool json) {
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  std::optional<Quantization> grid = (*pack)->metadata().quantization;
  const auto store =
      std::make_unique<PackStore>(*pack, std::make_shared<MemoryBudget>(kIndexBudget));
  const auto base = baseOf(*store);
  if (!base) return tl::unexpected(base.error());
  const auto expected =
      publishedMesh(against, grid, grid->bits, base->base().tables.attributes.layout);
  if (!expected) return tl::unexpected(expected.error());
  unsigned wrong = 0;
  ordered_json rows = ordered_json::array();
  const auto results = verifyOrders(*store, *expected, orders, [&](const OrderResult& r) {
    if (!r.exact()) ++wrong;
    rows.push_back({{"order", r.order},
                    {"seed", r.seed},
                    {"batch", r.batch},
                    {"fronts", r.frontsChecked},
                    {"frontsWrong", r.frontsWrong},
                    {"collapses", r.collapses},
                    {"requestBits", r.requestBits},
                    {"finalExact", r.finalExact}});
    if (!json)
      fmt::print(
          "{:<20} answers of {:>6}: {} fronts {}, {} collapses, full mesh {}, {:.1f} bits an ID\n",
          r.order, r.batch, r.frontsChecked,
          r.frontsWrong == 0 ? "exact" : fmt::format("{} WRONG", r.frontsWrong), r.collapses,
          r.finalExact ? "exact" : "WRONG",
          static_cast<double>(r.requestBits) /
              static_cast<double>(std::max<uint64_t>((*pack)->metadata().splitCount, 1)));
  });
  if (!results) return tl::unexpected(results.error());
  if (json) {
    fmt::print("{}\n", ordered_json{{"exact", wrong == 0}, {"orders", rows}}.dump(2));
  } else if (wrong == 0) {
    fmt::print("exact: all {} orders, every front and the full mesh of {} triangles\n", orders,
               expected->triangles.size());
  } else {
    fmt::print("NOT exact: {} of {} orders\n", wrong, orders);
  }
  return wrong == 0 ? 0 : 1;
}

std::vector<std::string> attributeNames(const AttributeLayout& layout) {
  std::vector<std::string> names;
  if (layout.colours) names.emplace_back("colours");
  if (layout.normalBits != 0) names.push_back(fmt::format("normals of {} bits", layout.normalBits));
  return names;
}

std::string nothingOr(const std::vector<std::string>& names) {
  return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
}

// A pack's full mesh if the file is one.
Result<std::optional<GridMesh>> fromPack(const std::string& path,
                                         std::optional<Quantization>& grid) {
  const auto extension = std::filesystem::path(path).extension();
  if (extension != ".pack") return std::optional<GridMesh>();
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  PackStore store(*pack, std::make_shared<MemoryBudget>(kIndexBudget));
  const auto mesh = fullMesh(store);
  if (!mesh) return tl::unexpected(mesh.error());
  grid = (*pack)->metadata().quantization;
  return mesh->snapshot();
}

Result<int> compare(const std::string& a, const std::string& b, unsigned bits, unsigned normalBits,
                    bool json) {
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
    fmt::print("different: the vertices of {} carry {}, those of {} {}\n", a,
               nothingOr(attributeNames(first.layout)), b,
               nothingOr(attributeNames(second.layout)));
  } else if (difference.equal()) {
    fmt::print("equal: {} triangles on the same grid positions{}\n", first.triangles.size(),
               first.layout.any() ? ", the same " + nothingOr(attributeNames(first.layout)) : "");
  } else {
    fmt::print("different: {} triangles only in {}, {} only in {}\n", difference.missingInSecond, a,
               difference.missingInFirst, b);
  }
  return difference.equal() && sameLayout ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Looks into packs: info, verify, compare."};
  app.require_subcommand(1);
  bool json = false;
  std::string a;
  std::string b;
  unsigned orders = 12;
  unsigned bits = kDefaultQuantizationBits;
  unsigned normalBits = kDefaultNormalBits;

  auto* infoCommand = app.add_subcommand("info", "Counts, bounds, bytes and the encoder's report");
  infoCommand->add_option("PACK", a, "Pack")->required();
  auto* verifyCommand = app.add_subcommand(
      "verify", "Decodes in many orders and checks every front and the full mesh exactly");
  verifyCommand->add_option("PACK", a, "Pack")->required();
  verifyCommand->add_option("--against", b, "Mesh file the pack was encoded from")->required();
  verifyCommand->add_option("--orders", orders, "Orders to try")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  auto* compareCommand =
      app.add_subcommand("compare",
                         "Are A (a mesh file, cleaned as the encoder does, or a .pack) and B (a "
                         "mesh file as it is, or "
                         "a .pack) the same triangles on the same quantised positions, with the "
                         "same colours and normals?");
  compareCommand->add_option("A", a, "Mesh file or pack")->required();
  compareCommand->add_option("B", b, "Mesh file or pack")->required();
  compareCommand->add_option("--quantization", bits, "Bits of A's grid, unless one is a pack")
      ->check(CLI::Range(kMinQuantizationBits, kMaxQuantizationBits))
      ->capture_default_str();
  compareCommand
      ->add_option("--normal-bits", normalBits,
                   "Bits of a normal's coordinate, unless one is a pack")
      ->check(CLI::Range(kMinNormalBits, kMaxNormalBits))
      ->capture_default_str();
  for (auto* command : {infoCommand, verifyCommand, compareCommand})
    command->add_flag("--json", json, "Print JSON");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    Result<int> done = *infoCommand     ? info(a, json)
                       : *verifyCommand ? verify(a, b, orders, json)
                                        : compare(a, b, bits, normalBits, json);
    if (done) return *done;
    fmt::print(stderr, "meshfront-pack: {}\n", done.error().message);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "meshfront-pack: out of memory\n");
  }
  return 1;
}
