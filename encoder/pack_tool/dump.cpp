// meshfront-pack dump.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "encoder/pack_tool/commands.h"
#include "encoder/pack_tool/node_name.h"
#include "encoder/pack_tool/node_record.h"
#include "shared/codec/value_class.h"

namespace meshfront {
namespace {

using nlohmann::ordered_json;

GridPosition rightPosition(const NodeRecord& r) {
  GridPosition t = r.position;
  for (size_t i = 0; i < 3; ++i) t[i] += r.delta[i];
  return t;
}

std::string listed(const auto& values) {
  return fmt::format("{} {} {}", values[0], values[1], values[2]);
}

std::string attributesAsText(const VertexAttributes& a, const AttributeLayout& layout) {
  std::string out;
  if (layout.colours)
    out += fmt::format(" colour {} {} {} {}", a.colour[0], a.colour[1], a.colour[2], a.colour[3]);
  if (layout.normalBits != 0) {
    const auto n = fromOctahedral(a.normal, layout.normalBits);
    out += fmt::format("{} normal {} {} = ({:.4f} {:.4f} {:.4f})", out.empty() ? "" : ",",
                       a.normal[0], a.normal[1], n[0], n[1], n[2]);
  }
  return out;
}

std::string childAsText(bool isLeaf, unsigned level) {
  return isLeaf ? "a leaf" : fmt::format("level {}", level);
}

std::string recordAsText(const NodeRecord& r) {
  constexpr std::string_view kAxes = "xyz";
  const char a = kAxes[r.mainAxis];
  const char b = kAxes[(r.mainAxis + 1) % 3];
  const char c = kAxes[(r.mainAxis + 2) % 3];
  std::string out;
  uint64_t at = 0;
  const auto field = [&](const char* name, uint32_t length, const std::string& meaning) {
    out += fmt::format("{:<9} bits {:>3} + {:<3} {:<16} {}\n", name, at, length,
                       r.bits.substr(at, length), meaning);
    at += length;
  };
  field("header", r.headerBits,
        fmt::format("left {}, right {}; cut region of {} bits, class {}",
                    r.record.leftIsLeaf ? "a leaf" : "no leaf",
                    r.record.rightIsLeaf ? "a leaf" : "no leaf",
                    r.record.cutEnd - r.record.cutBegin, r.cutClass));
  field("levels", r.levelBits,
        fmt::format("left {}, right {}", childAsText(r.record.leftIsLeaf, r.record.leftLevel),
                    childAsText(r.record.rightIsLeaf, r.record.rightLevel)));
  field("classes", r.classBits,
        fmt::format("of d{} {}, of d{} {}, of the residual of d{} {}", b,
                    valueClassOf(r.record.deltaB), c, valueClassOf(r.record.deltaC), a,
                    valueClassOf(r.record.residualA)));
  field("values", r.valueBits,
        fmt::format("d{} {}, d{} {}, residual of d{} {}", b, r.record.deltaB, c, r.record.deltaC, a,
                    r.record.residualA));
  const auto& colour = r.record.attributes.colour;
  if (r.layout.colours)
    field("colour", r.colourBits,
          fmt::format("green {:+}, red {:+} and blue {:+} beside it, alpha {:+}", colour[0],
                      colour[1], colour[2], colour[3]));
  const auto& normal = r.record.attributes.normal;
  if (r.layout.normalBits != 0)
    field("normal", r.normalBits, fmt::format("{:+} {:+}", normal[0], normal[1]));
  field("cut", r.record.cutEnd - r.record.cutBegin, "");
  return out;
}

std::string positionAsText(const NodeRecord& r, const Quantization& grid) {
  const GridPosition t = rightPosition(r);
  std::string out = fmt::format("predicted normal {}, d{} is predicted from it\n", listed(r.normal),
                                "xyz"[r.mainAxis]);
  out += fmt::format("d         {}\n", listed(r.delta));
  out += fmt::format("left      {} grid {}, world {}{}\n", nodeName(r.id.child(false)),
                     listed(r.position), listed(grid.toWorld(r.position)),
                     attributesAsText(r.attributes, r.layout));
  out += fmt::format("right     {} grid {}, world {}{}\n", nodeName(r.id.child(true)), listed(t),
                     listed(grid.toWorld(t)), attributesAsText(r.rightAttributes, r.layout));
  return out;
}

std::string cutAsText(const NodeRecord& r) {
  std::string out = fmt::format(
      "ring      {} entries at the front where only its ancestors are split\n", r.ring.size());
  for (uint32_t i = 0; i < r.ring.size(); ++i)
    out += fmt::format("  {:>4}    {}{}{}{}\n", i, nodeName(r.ring[i].node),
                       r.ring[i].isVirtual ? " virtual" : "", i == r.leftEntry ? "  <- l" : "",
                       i == r.rightEntry ? "  <- r" : "");
  if (r.leftEntry == r.rightEntry)
    out += fmt::format("          one edge: {}\n", r.leftFirst ? "l before r, all faces go to right"
                                                               : "r before l, all faces stay left");
  out += fmt::format("decisions {}\n", r.decisions.size());
  for (const auto& d : r.decisions)
    out += fmt::format("          {} context {:>4}, chance of 0 {:>2}/64: {}  {}\n",
                       d.backward ? "backward" : "forward ", d.context, d.chanceOfZero,
                       d.bit ? 1 : 0, d.about);
  return out;
}

std::string asText(const NodeRecord& r, const Quantization& grid, unsigned maxLevel) {
  return fmt::format(
             "node      {}: tree {}, depth {}\n"
             "level     {} of 0 to {}\n"
             "record    chunk {}, bits {} + {}\n",
             nodeName(r.id), r.id.tree, r.id.depth, r.level, maxLevel, r.chunk, r.bitOffset,
             r.bitLength) +
         recordAsText(r) + positionAsText(r, grid) + cutAsText(r);
}

ordered_json attributesAsJson(const VertexAttributes& a, const AttributeLayout& layout) {
  ordered_json out = ordered_json::object();
  if (layout.colours) out["colour"] = a.colour;
  if (layout.normalBits != 0) {
    out["octahedralNormal"] = a.normal;
    out["normal"] = fromOctahedral(a.normal, layout.normalBits);
  }
  return out;
}

ordered_json childAsJson(const NodeRecord& r, bool right, const Quantization& grid) {
  const bool leaf = right ? r.record.rightIsLeaf : r.record.leftIsLeaf;
  const GridPosition position = right ? rightPosition(r) : r.position;
  ordered_json out = {{"id", nodeName(r.id.child(right))}, {"isLeaf", leaf}};
  if (!leaf) out["level"] = right ? r.record.rightLevel : r.record.leftLevel;
  out["grid"] = position;
  out["world"] = grid.toWorld(position);
  out["attributes"] = attributesAsJson(right ? r.rightAttributes : r.attributes, r.layout);
  return out;
}

std::string asJson(const NodeRecord& r, const Quantization& grid) {
  ordered_json out;
  out["id"] = nodeName(r.id);
  out["level"] = r.level;
  out["chunk"] = r.chunk;
  out["bitOffset"] = r.bitOffset;
  out["bitLength"] = r.bitLength;
  out["bits"] = r.bits;
  out["fieldBits"] = {{"header", r.headerBits},   {"levels", r.levelBits},
                      {"classes", r.classBits},   {"values", r.valueBits},
                      {"colour", r.colourBits},   {"normal", r.normalBits},
                      {"cut", r.cutRegion.size()}};
  out["classes"] = {{"deltaB", valueClassOf(r.record.deltaB)},
                    {"deltaC", valueClassOf(r.record.deltaC)},
                    {"residualA", valueClassOf(r.record.residualA)}};
  out["values"] = {
      {"deltaB", r.record.deltaB}, {"deltaC", r.record.deltaC}, {"residualA", r.record.residualA}};
  out["colourDelta"] = r.record.attributes.colour;
  out["normalDelta"] = r.record.attributes.normal;
  out["predictedNormal"] = r.normal;
  out["mainAxis"] = r.mainAxis;
  out["delta"] = r.delta;
  out["left"] = childAsJson(r, false, grid);
  out["right"] = childAsJson(r, true, grid);
  out["cut"] = {{"class", r.cutClass},
                {"region", r.cutRegion},
                {"ring", ordered_json::array()},
                {"left", r.leftEntry},
                {"right", r.rightEntry},
                {"leftFirst", r.leftFirst},
                {"decisions", ordered_json::array()}};
  for (const auto& entry : r.ring)
    out["cut"]["ring"].push_back({{"id", nodeName(entry.node)}, {"virtual", entry.isVirtual}});
  for (const auto& d : r.decisions)
    out["cut"]["decisions"].push_back({{"about", d.about},
                                       {"context", d.context},
                                       {"chanceOfZero", d.chanceOfZero},
                                       {"backward", d.backward},
                                       {"bit", d.bit}});
  return out.dump(2) + "\n";
}

}  // namespace

Result<int> dumpNode(const std::filesystem::path& path, const std::string& name, bool json) {
  const auto id = parseNodeName(name);
  if (!id) return tl::unexpected(id.error());
  const auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  const auto record = nodeRecord(**pack, *id);
  if (!record) return tl::unexpected(record.error());
  const MeshMetadata& m = (*pack)->metadata();
  fmt::print("{}",
             json ? asJson(*record, m.quantization) : asText(*record, m.quantization, m.maxLevel));
  return 0;
}

}  // namespace meshfront
