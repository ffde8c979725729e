#include "encoder/pipeline/base_advice.h"

#include <fmt/format.h>

namespace meshfront {

namespace {

constexpr uint32_t kFewest = 4;  // vertices; nothing smaller can be asked for

std::string refusals(const EndState& e) {
  std::string out = fmt::format("of {} directions left", e.directions);
  const auto add = [&](uint64_t count, const char* rule) {
    if (count > 0) out += fmt::format(", {} {}", count, rule);
  };
  add(e.smallestComponent, "lie in components that are down to 4 vertices");
  add(e.virtualVertex, "lead onto a hole's virtual vertex");
  add(e.link, "would pinch the surface (link condition)");
  add(e.depth, "would make a tree too deep");
  add(e.valence, "start at a vertex with too many neighbours");
  return out;
}

}  // namespace

std::vector<std::string> adviceOnBase(const SimplifyReport& report, uint64_t vertexCount) {
  std::vector<std::string> out;
  const double share = vertexCount == 0 ? 0
                                        : static_cast<double>(report.baseVertices) /
                                              static_cast<double>(vertexCount);
  if (report.why == StopReason::reachedBase && share > kLargeBase &&
      report.wantedVertices > kFewest) {
    out.push_back(
        fmt::format("the base mesh is {:.1f} % of the vertices because --base-fraction asks for "
                    "it; receivers load it whole at the start, the default is 0.002",
                    100 * share));
  }
  if (report.why != StopReason::noValidCollapse) return out;

  const EndState& e = report.endState;
  out.push_back(fmt::format("the base mesh has {} vertices ({:.1f} %) instead of {}: {}",
                            report.baseVertices, 100 * share, report.wantedVertices, refusals(e)));
  if (e.depthAlone > 0) {
    out.push_back(
        fmt::format("the limit on depth alone refuses {} directions: use --balance 2, which makes "
                    "shallower trees, or fewer bits with --quantization",
                    e.depthAlone));
  }
  if (e.valenceAlone > 0) {
    out.push_back(
        e.valenceNeeded <= kLargestMaxValence
            ? fmt::format("the limit on neighbours alone refuses {} directions: use --max-valence "
                          "{} or more",
                          e.valenceAlone, e.valenceNeeded)
            : fmt::format("the limit on neighbours alone refuses {} directions, and {} or more "
                          "neighbours are beyond what --max-valence can be: split such hubs in "
                          "the input",
                          e.valenceAlone, e.valenceNeeded));
  }
  if (e.depthAlone == 0 && e.valenceAlone == 0) {
    out.push_back(fmt::format(
        "the mesh's own topology is the bound, which no option relaxes: {} components, {} of them "
        "down to 4 vertices (3 and a hole's virtual one, or a tetrahedron), and {} handles. To get "
        "below, drop small components or weld seams in the input",
        e.components, e.smallestComponents, e.handles));
  }
  return out;
}

}  // namespace meshfront
