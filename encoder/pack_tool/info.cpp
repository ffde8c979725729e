// meshfront-pack info. The report is JSON that another version of the encoder may have written:
// every number and list in it is shown under its own name, whatever it holds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "encoder/pack_tool/attribute_names.h"
#include "encoder/pack_tool/commands.h"
#include "encoder/pack_tool/pack_summary.h"

namespace meshfront {
namespace {

using nlohmann::ordered_json;

// "positionClasses" -> "position classes".
std::string inWords(const std::string& key) {
  std::string out;
  for (const char c : key) {
    if (std::isupper(static_cast<unsigned char>(c)) == 0) {
      out.push_back(c);
    } else {
      out.push_back(' ');
      out.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    }
  }
  return out;
}

const ordered_json& memberOf(const ordered_json& object, const char* key) {
  static const ordered_json kNothing;
  const auto it = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && it != object.end() ? *it : kNothing;
}

double numberOf(const ordered_json& object, const char* key) {
  const ordered_json& member = memberOf(object, key);
  return member.is_number() ? member.get<double>() : 0;
}

double each(double sum, uint64_t count) {
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

struct Depths {
  std::vector<uint64_t> leaves;  // by depth
  double mean = 0;               // of a leaf
};

Depths depthsOf(const ordered_json& report) {
  Depths depths;
  uint64_t count = 0;
  const ordered_json& list = memberOf(report, "leavesByDepth");
  if (!list.is_array()) return depths;
  for (const auto& entry : list)
    depths.leaves.push_back(entry.is_number_unsigned() ? entry.get<uint64_t>() : 0);
  for (size_t depth = 0; depth < depths.leaves.size(); ++depth) {
    count += depths.leaves[depth];
    depths.mean += static_cast<double>(depth) * static_cast<double>(depths.leaves[depth]);
  }
  depths.mean = each(depths.mean, count);
  return depths;
}

// Fields of the records and what they are parts of; "tables" are no part of the records.
ordered_json bitsByField(const ordered_json& report, uint64_t splits) {
  ordered_json out = ordered_json::object();
  const ordered_json& bits = memberOf(report, "bits");
  const double total = numberOf(bits, "total");
  if (!bits.is_object()) return out;
  for (const auto& [key, value] : bits.items()) {
    if (!value.is_number() || key == "splits") continue;
    const double sum = value.get<double>();
    out[key] = {{"bits", value}, {"perSplit", each(sum, splits)}};
    if (key != "tables" && total > 0) out[key]["share"] = sum / total;
  }
  return out;
}

ordered_json toJson(const Sizes& sizes) {
  return {{"count", sizes.count},
          {"bytes", sizes.bytes},
          {"min", sizes.least},
          {"median", sizes.median},
          {"max", sizes.most}};
}

std::string asJson(const MeshMetadata& m, const PackSummary& s, const ordered_json& report) {
  const Depths depths = depthsOf(report);
  ordered_json out;
  out["metadata"] = ordered_json::parse(toJson(m));
  out["attributes"] = {{"colours", s.layout.colours}, {"normalBits", s.layout.normalBits}};
  out["bitsByField"] = bitsByField(report, m.splitCount);
  out["leavesByDepth"] = depths.leaves;
  out["nodeIds"] = {{"treeBits", s.treeNumberBits},
                    {"maxDepth", m.maxDepth},
                    {"meanDepth", depths.mean},
                    {"maxBits", s.treeNumberBits + m.maxDepth},
                    {"meanBits", s.treeNumberBits + depths.mean},
                    {"within32Bits", s.treeNumberBits + m.maxDepth <= 32}};
  out["base"] = {{"roots", s.roots},
                 {"virtualTrees", s.virtualTrees},
                 {"bytes", m.baseBytes},
                 {"tableBits", s.baseTableBits},
                 {"rootBits", s.baseRootBits},
                 {"triangleBits", s.baseTriangleBits},
                 {"otherBits", s.baseOtherBits}};
  out["chunks"] = toJson(s.chunks);
  out["chunks"]["byBand"] = ordered_json::array();
  for (const Sizes& band : s.chunksByBand) out["chunks"]["byBand"].push_back(toJson(band));
  out["report"] = report;
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string countsAsText(const MeshMetadata& m, const PackSummary& s) {
  const auto& [lowX, lowY, lowZ] = m.boundsMin;
  const auto& [highX, highY, highZ] = m.boundsMax;
  const auto& [x, y, z] = m.quantization.origin;
  const auto names = attributeNames(s.layout);
  std::string out;
  out += fmt::format("mesh        {}, revision {}\n", m.name, m.revision);
  out += fmt::format("finest      {} vertices, {} triangles\n", m.vertexCount, m.triangleCount);
  out += fmt::format("base        {} vertices, {} triangles, {} virtual vertices\n",
                     m.baseVertexCount, m.baseTriangleCount, s.virtualTrees);
  out += fmt::format("hierarchy   {} splits, levels 0 to {}, deepest node {}\n", m.splitCount,
                     m.maxLevel, m.maxDepth);
  out +=
      fmt::format("carries     positions{}{}\n", names.empty() ? "" : ", ", fmt::join(names, ", "));
  out += fmt::format("bounds      {} {} {} to {} {} {}\n", lowX, lowY, lowZ, highX, highY, highZ);
  out += fmt::format("grid        {} bits, origin {} {} {}, step {}\n", m.quantization.bits, x, y,
                     z, m.quantization.step);
  return out;
}

std::string basePartsAsText(const MeshMetadata& m, const PackSummary& s) {
  const auto bytes = [](uint64_t bits) { return static_cast<double>(bits) / 8; };
  return fmt::format(
      "base bytes  {}: tables {:.0f}, roots {:.0f}, triangles {:.0f}, magic number and checksum "
      "{:.0f}\n",
      m.baseBytes, bytes(s.baseTableBits), bytes(s.baseRootBits), bytes(s.baseTriangleBits),
      bytes(s.baseOtherBits));
}

std::string fieldsAsText(const MeshMetadata& m, const ordered_json& report) {
  std::string out = fmt::format("records     {} bytes, {:.2f} bits a split\n", m.recordBytes,
                                each(static_cast<double>(m.recordBytes) * 8, m.splitCount));
  const ordered_json fields = bitsByField(report, m.splitCount);
  if (fields.empty()) return out;
  out +=
      fmt::format("bits        {:<20} {:>12} {:>8} {:>7}\n", "field", "in all", "a split", "share");
  for (const auto& [key, field] : fields.items()) {
    const double share = numberOf(field, "share");
    out += fmt::format("            {:<20} {:>12.0f} {:>8.3f} {:>7}\n", inWords(key),
                       numberOf(field, "bits"), numberOf(field, "perSplit"),
                       field.contains("share") ? fmt::format("{:.1f} %", 100 * share) : "");
  }
  return out;
}

std::string depthsAsText(const MeshMetadata& m, const PackSummary& s, const Depths& depths) {
  const unsigned most = s.treeNumberBits + m.maxDepth;
  std::string out = fmt::format(
      "node IDs    tree number {} + path {} = {} bits at most; mean {} + {:.1f} = {:.1f}; within "
      "32 bits: {}\n",
      s.treeNumberBits, m.maxDepth, most, s.treeNumberBits, depths.mean,
      s.treeNumberBits + depths.mean, most <= 32 ? "yes" : "no");
  const auto largest = std::max_element(depths.leaves.begin(), depths.leaves.end());
  if (largest == depths.leaves.end() || *largest == 0) return out;
  constexpr double kBar = 50;
  const auto any = [](uint64_t n) { return n > 0; };
  const auto first = std::find_if(depths.leaves.begin(), depths.leaves.end(), any);
  out += fmt::format("depths      {:>5} {:>10}\n", "depth", "leaves");
  for (auto it = first; it != depths.leaves.end(); ++it) {
    const double bar = kBar * static_cast<double>(*it) / static_cast<double>(*largest);
    const auto length = static_cast<size_t>(*it == 0 ? 0 : std::max(1.0, bar));
    out += fmt::format("            {:>5} {:>10}{}{}\n", it - depths.leaves.begin(), *it,
                       length == 0 ? "" : " ", std::string(length, '#'));
  }
  return out;
}

std::string chunksAsText(const PackSummary& s) {
  const auto row = [](const std::string& band, const Sizes& c) {
    return fmt::format("            {:>5} {:>7} {:>11} {:>7} {:>7} {:>7}\n", band, c.count, c.bytes,
                       c.least, c.median, c.most);
  };
  std::string out = fmt::format("chunks      {:>5} {:>7} {:>11} {:>7} {:>7} {:>7}\n", "band",
                                "chunks", "bytes", "min", "median", "max");
  for (size_t band = 0; band < s.chunksByBand.size(); ++band)
    out += row(std::to_string(band), s.chunksByBand[band]);
  return out + row("all", s.chunks);
}

// What is not zero; a list is shown line by line.
std::string partAsText(const ordered_json& report, const char* part, const char* label) {
  std::string out;
  const ordered_json& object = memberOf(report, part);
  if (!object.is_object()) return out;
  const auto add = [&](const std::string& line) {
    out += fmt::format("{:<11} {}\n", out.empty() ? label : "", line);
  };
  for (const auto& [key, value] : object.items()) {
    if (value.is_number() && value.get<double>() != 0)
      add(fmt::format("{:<24} {:>10}", inWords(key), value.dump()));
    if (value.is_string()) add(fmt::format("{}: {}", inWords(key), value.get<std::string>()));
    if (value.is_array())
      for (const auto& entry : value)
        if (entry.is_string()) add(fmt::format("{}: {}", inWords(key), entry.get<std::string>()));
  }
  return out;
}

std::string notCarriedAsText(const ordered_json& report) {
  std::string out;
  const ordered_json& list = memberOf(report, "notCarried");
  if (!list.is_array()) return out;
  for (const auto& sentence : list)
    if (sentence.is_string()) out += fmt::format("not carried {}\n", sentence.get<std::string>());
  return out.empty() ? "not carried nothing\n" : out;
}

}  // namespace

Result<int> printInfo(const std::filesystem::path& path, bool json) {
  const auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  const MeshMetadata& m = (*pack)->metadata();
  const auto summary = summarise(**pack);
  if (!summary) return tl::unexpected(summary.error());
  const auto parsed = ordered_json::parse((*pack)->reportJson(), nullptr, false);
  const ordered_json report = parsed.is_discarded() ? ordered_json() : parsed;
  if (json) {
    fmt::print("{}", asJson(m, *summary, report));
    return 0;
  }
  fmt::print("{}{}{}{}{}{}{}{}", countsAsText(m, *summary), fieldsAsText(m, report),
             basePartsAsText(m, *summary), depthsAsText(m, *summary, depthsOf(report)),
             chunksAsText(*summary), partAsText(report, "cleaning", "cleaning"),
             notCarriedAsText(report), partAsText(report, "simplification", "simplified"));
  return 0;
}

}  // namespace meshfront
