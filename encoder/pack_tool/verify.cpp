// meshfront-pack verify.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "encoder/pack_tool/commands.h"
#include "encoder/pack_tool/pack_decoding.h"
#include "encoder/pack_tool/published_mesh.h"
#include "encoder/pack_tool/verify_pack.h"

namespace meshfront {

using nlohmann::ordered_json;

Result<int> verifyAgainst(const std::filesystem::path& path, const std::filesystem::path& mesh,
                          unsigned orders, bool json) {
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  std::optional<Quantization> grid = (*pack)->metadata().quantization;
  const auto store =
      std::make_unique<PackStore>(*pack, std::make_shared<MemoryBudget>(kIndexBudget));
  const auto base = baseOf(*store);
  if (!base) return tl::unexpected(base.error());
  const auto expected =
      publishedMesh(mesh, grid, grid->bits, base->base().tables.attributes.layout);
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

}  // namespace meshfront
