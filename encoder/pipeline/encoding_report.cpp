#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "encoder/pipeline/base_advice.h"
#include "encoder/pipeline/encode_mesh.h"

namespace meshfront {
namespace {

using nlohmann::ordered_json;

const char* describe(StopReason why) {
  switch (why) {
    case StopReason::reachedBase:
      return "the base is as small as asked for";
    case StopReason::noValidCollapse:
      return "no collapse is valid any more";
    case StopReason::notClosed:
      return "the mesh is not closed";
  }
  return "";
}

double each(double bits, uint64_t splits) {
  return splits == 0 ? 0 : bits / static_cast<double>(splits);
}

}  // namespace

std::string toJson(const EncodingReport& report, bool withTimes) {
  const CleaningReport& c = report.cleaning;
  const SimplifyReport& s = report.simplification;
  const FieldBits& b = report.bits;
  ordered_json json;
  json["notCarried"] = report.notCarried;
  json["cleaning"] = {{"verticesIn", c.verticesIn},
                      {"trianglesIn", c.trianglesIn},
                      {"weldedVertices", c.weldedVertices},
                      {"weldedDifferently", c.weldedDifferently},
                      {"degenerateFaces", c.degenerateFaces},
                      {"repeatedFaces", c.repeatedFaces},
                      {"oppositeDuplicates", c.oppositeDuplicates},
                      {"nonManifoldEdges", c.nonManifoldEdges},
                      {"inconsistentEdges", c.inconsistentEdges},
                      {"rejoinedEdges", c.rejoinedEdges},
                      {"verticesSplit", c.verticesSplit},
                      {"unreferencedVertices", c.unreferencedVertices},
                      {"boundaryLoops", c.boundaryLoops},
                      {"components", c.components}};
  json["simplification"] = {
      {"stopped", describe(s.why)},         {"wantedVertices", s.wantedVertices},
      {"baseVertices", s.baseVertices},     {"refusedByLink", s.refusedByLink},
      {"refusedByDepth", s.refusedByDepth}, {"refusedByValence", s.refusedByValence},
      {"refusedVirtual", s.refusedVirtual}, {"postponedFlips", s.postponedFlips},
      {"acceptedFlips", s.acceptedFlips}};
  if (s.why == StopReason::noValidCollapse) {
    const EndState& e = s.endState;
    json["simplification"]["endState"] = {{"directions", e.directions},
                                          {"refusedBySmallestComponent", e.smallestComponent},
                                          {"refusedVirtual", e.virtualVertex},
                                          {"refusedByLink", e.link},
                                          {"refusedByDepth", e.depth},
                                          {"refusedByValence", e.valence},
                                          {"refusedByDepthAlone", e.depthAlone},
                                          {"refusedByValenceAlone", e.valenceAlone},
                                          {"valenceNeeded", e.valenceNeeded},
                                          {"components", e.components},
                                          {"smallestComponents", e.smallestComponents},
                                          {"handles", e.handles}};
  }
  json["simplification"]["advice"] = adviceOnBase(s, b.splits + s.baseVertices);
  json["bits"] = {{"splits", b.splits},
                  {"header", b.header},
                  {"leafFlagsEntropy", b.leafFlags},
                  {"significance", b.significance},
                  {"positionClasses", b.positionClasses},
                  {"positionValues", b.positionValues},
                  {"colours", b.colours},
                  {"normals", b.normals},
                  {"cutRegions", b.cutRegions},
                  {"ofThosePadding", b.cutPadding},
                  {"total", b.total()},
                  {"tables", report.tableBits}};
  json["bitsPerSplit"] = {
      {"cutRegionsWithLength",
       each(static_cast<double>(b.header + b.cutRegions) - b.leafFlags, b.splits)},
      {"leafFlags", each(b.leafFlags, b.splits)},
      {"significance", each(static_cast<double>(b.significance), b.splits)},
      {"position", each(static_cast<double>(b.positionClasses + b.positionValues), b.splits)},
      {"colours", each(static_cast<double>(b.colours), b.splits)},
      {"normals", each(static_cast<double>(b.normals), b.splits)},
      {"total", each(static_cast<double>(b.total()), b.splits)}};
  json["maxDepth"] = report.maxDepth;
  json["leavesByDepth"] = report.leavesByDepth;
  if (withTimes) {
    json["estimatedPeakMiB"] = static_cast<double>(report.estimatedPeakBytes) / 1048576.0;
    for (const PhaseTime& phase : report.phases)
      json["phases"].push_back({{"name", phase.name},
                                {"seconds", phase.seconds},
                                {"peakMiB", static_cast<double>(phase.peakBytes) / 1048576.0}});
  }
  return json.dump(2);
}

std::string describe(const EncodingReport& report) {
  const CleaningReport& c = report.cleaning;
  const SimplifyReport& s = report.simplification;
  const FieldBits& b = report.bits;
  std::string out =
      fmt::format("read        {} vertices, {} triangles\n", c.verticesIn, c.trianglesIn);
  for (const std::string& sentence : report.notCarried)
    out += fmt::format("not carried {}\n", sentence);
  const auto count = [&](uint64_t n, const char* what) {
    if (n > 0) out += fmt::format("cleaned     {} {}\n", n, what);
  };
  count(c.weldedVertices, "vertices welded");
  count(c.weldedDifferently, "of them had another colour or normal, which is lost");
  count(c.degenerateFaces, "degenerate faces dropped");
  count(c.repeatedFaces, "repeated faces dropped");
  count(c.oppositeDuplicates, "opposite duplicate faces given vertices of their own");
  count(c.nonManifoldEdges, "non-manifold edges cut");
  count(c.inconsistentEdges, "edges of inconsistent orientation cut");
  count(c.rejoinedEdges, "cut edges joined again");
  count(c.verticesSplit, "vertex copies made");
  count(c.unreferencedVertices, "unreferenced vertices dropped");
  count(c.boundaryLoops, "boundary loops closed with virtual vertices");
  out += fmt::format("components  {}\n", c.components);
  out += fmt::format("base        {} vertices (wanted {}): {}\n", s.baseVertices, s.wantedVertices,
                     describe(s.why));
  for (const std::string& advice : adviceOnBase(s, b.splits + s.baseVertices))
    out += fmt::format("base        {}\n", advice);
  out += fmt::format("hierarchy   {} splits, deepest node {}\n", b.splits, report.maxDepth);
  std::string carried;
  if (b.colours > 0)
    carried += fmt::format("colours {:.2f}, ", each(static_cast<double>(b.colours), b.splits));
  if (b.normals > 0)
    carried += fmt::format("normals {:.2f}, ", each(static_cast<double>(b.normals), b.splits));
  out += fmt::format(
      "bits/split  cut code with length {:.2f}, leaf flags {:.2f}, significance {:.2f}, "
      "position {:.2f}, {}total {:.2f}\n",
      each(static_cast<double>(b.header + b.cutRegions) - b.leafFlags, b.splits),
      each(b.leafFlags, b.splits), each(static_cast<double>(b.significance), b.splits),
      each(static_cast<double>(b.positionClasses + b.positionValues), b.splits), carried,
      each(static_cast<double>(b.total()), b.splits));
  for (const PhaseTime& phase : report.phases)
    out += fmt::format("time        {:<9} {:7.3f} s, peak {:.0f} MiB\n", phase.name, phase.seconds,
                       static_cast<double>(phase.peakBytes) / 1048576.0);
  return out;
}

}  // namespace meshfront
