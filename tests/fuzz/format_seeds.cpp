#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "shared/bits/base64url.h"
#include "shared/bits/crc32c.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/synthetic_mesh.h"
#include "tests/fuzz/fuzz_bases.h"
#include "tests/fuzz/seeds.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront::fuzz {
namespace {

PackContent encodedShape(IndexedMesh mesh, const char* name) {
  EncodeOptions options;
  options.name = name;
  options.quantizationBits = 10;
  options.baseFraction = 0.05;
  options.threads = 1;
  return std::move(encodeMesh(std::move(mesh), options).value().pack);
}

// Closed, with colours and normals.
PackContent colouredTorus() {
  IndexedMesh mesh = torus(16, 10);
  for (const auto& p : mesh.positions) {
    const auto shade = [](double v) { return static_cast<uint8_t>(128 + 50 * std::sin(3 * v)); };
    mesh.colours.push_back({shade(p[0]), shade(p[1]), shade(p[2]), 255});
    mesh.normals.push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return encodedShape(std::move(mesh), "torus");
}

// With a boundary and a hole: virtual vertices; no attributes.
PackContent sheetWithHole() {
  IndexedMesh mesh = gridPatchWithout(
      12, 12, [](uint32_t x, uint32_t y) { return x > 3 && x < 7 && y > 3 && y < 6; });
  for (auto& p : mesh.positions) p[2] = std::sin(p[0]) + std::cos(2 * p[1]);
  return encodedShape(std::move(mesh), "sheet");
}

std::string textOf(std::span<const uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}
// Targets append the checksum.
std::string withoutChecksum(std::span<const uint8_t> bytes) {
  return textOf(bytes.first(bytes.size() - kChecksumBytes));
}
void putWord(std::string& out, size_t word) {
  out.push_back(static_cast<char>(word));
  out.push_back(static_cast<char>(word >> 8));
}

std::vector<uint8_t> bitsOf(const RecordsAtHand::Place& place) {
  BitWriter out;
  out.append(*place.bytes, place.entry.bitOffset, place.entry.bitLength);
  return out.take();
}

std::vector<NodeId> innerRoots(const BaseMesh& base) {
  std::vector<NodeId> roots;
  for (uint32_t tree = 0; tree < base.roots.size(); ++tree)
    if (!base.roots[tree].isLeaf) roots.push_back(NodeId::root(tree));
  return roots;
}

// The records of some roots and what is below them.
std::string answerSeed(const RecordsAtHand& records, unsigned levels, size_t count) {
  std::vector<NodeId> wanted = innerRoots(records.base());
  wanted.resize(std::min(wanted.size(), count));
  const auto bitstring = encodeTreeBitstring(wanted).value();
  BitWriter bits;
  for (const auto& place : records.all()) {
    const NodeId& id = place.entry.id;
    if (id.depth <= levels && std::ranges::binary_search(wanted, NodeId::root(id.tree)))
      bits.append(*place.bytes, place.entry.bitOffset, place.entry.bitLength);
  }
  std::string out(1, static_cast<char>(levels));
  putWord(out, bitstring.size());
  return out + textOf(bitstring) + textOf(bits.take());
}

// Splits all, in preorder or with the last ones first, collapsing and splitting again on the way.
std::string refineSeed(const RecordsAtHand& records, uint8_t base, bool newestFirst) {
  std::string out(1, static_cast<char>(base));
  std::map<NodeId, size_t> numbers;  // as the mesh numbers its nodes: children from an even one on
  for (uint32_t tree = 0; tree < records.base().treeCount(); ++tree)
    numbers.emplace(NodeId::root(tree), numbers.size());
  size_t next = (numbers.size() + 1) / 2 * 2;
  std::vector<NodeId> open = innerRoots(records.base());
  while (!open.empty() && out.size() < 3500) {
    const auto at = newestFirst ? open.end() - 1 : open.begin();
    const NodeId id = *at;
    open.erase(at);
    const auto& place = records.of(id);
    out.push_back(open.size() % 7 == 0 ? 15 : 0);
    putWord(out, numbers.at(id));
    out += textOf(bitsOf(place));
    for (const bool right : {false, true}) {
      numbers.emplace(id.child(right), next++);
      if (!(right ? place.entry.rightIsLeaf : place.entry.leftIsLeaf))
        open.push_back(id.child(right));
    }
    if (open.size() % 3 != 0) continue;
    for (const int step : {160, 208}) {
      out.push_back(static_cast<char>(step));
      putWord(out, numbers.at(id));
    }
  }
  return out;
}

std::string packSeed(const PackContent& content) {
  std::string out;
  const auto add = [&](size_t which, const std::string& entry) {
    out.push_back(static_cast<char>(which));
    putWord(out, entry.size());
    out += entry;
  };
  MeshMetadata metadata = content.metadata;
  metadata.revision = revisionOf(content);
  metadata.chunkCount = static_cast<uint32_t>(content.chunks.size());
  std::string json = toJson(metadata);
  const size_t links = json.find("\"links\"");  // which nobody reads back
  json.erase(links, json.find("\"maxDepth\"") - links);
  add(0, json);
  add(1, withoutChecksum(content.base));
  add(2, withoutChecksum(content.chunkIndex));
  add(3, "{}");
  for (size_t i = 0; i < content.chunks.size(); ++i) add(4 + i, withoutChecksum(content.chunks[i]));
  return out;
}

void addResources(std::vector<Seed>& seeds, const std::string& name, const PackContent& content) {
  const std::string base = withoutChecksum(content.base);
  seeds.push_back({"base", "valid-" + name, base});
  seeds.push_back({"base", "cut-" + name, base.substr(0, base.size() * 3 / 4)});
  seeds.push_back({"chunk-index", "valid-" + name, withoutChecksum(content.chunkIndex)});
  for (size_t i = 0; i < std::min<size_t>(content.chunks.size(), 4); ++i) {
    const std::string chunk = withoutChecksum(content.chunks[i]);
    seeds.push_back({"chunk", "valid-" + name + "-" + std::to_string(i), chunk});
    if (i == 0) seeds.push_back({"chunk", "cut-" + name, chunk.substr(0, chunk.size() / 2)});
  }
}

void addRequests(std::vector<Seed>& seeds, std::span<const NodeId> wanted) {
  const std::string mesh = "/v1/meshes/a.b-c/0123456789abcdef0123456789abcdef";
  const std::string condition = R"(W/"a", "0123456789abcdef0123456789abcdef", *)";
  const auto bitstring = encodeTreeBitstring(wanted).value();
  const std::string ids = base64urlEncode(bitstring);
  const auto add = [&](const char* name, const std::string& target, const std::string& content) {
    seeds.push_back({"request", name, target + "\n" + condition + "\n" + content});
  };
  add("valid-url", mesh + "/splits/" + ids, "");
  add("valid-levels", mesh + "/splits/" + ids + "?levels=3", "");
  add("valid-absolute", "http://host:80" + mesh + "/splits/" + ids + "?significance=0", "");
  add("valid-query", mesh + "/splits?significance=9", textOf(bitstring));
  add("odd-spelling", mesh + "/splits/" + ids + "=?levels=03", textOf(bitstring) + '\0');
  add("odd-chunk", mesh + "/chunks/4294967296", "");
  add("odd-names", "/v1/meshes/../" + std::string(70, 'x') + "//splits", "");
  add("odd-none", "*", std::string(40, '\xff'));
}

}  // namespace

std::vector<Seed> formatSeeds() {
  std::vector<Seed> seeds;
  const RecordsAtHand coloured(colouredTorus());
  const RecordsAtHand sheet(sheetWithHole());
  SyntheticOptions small;
  small.roots = 5;
  small.maxDepth = 4;
  const SyntheticMesh synthetic = makeSyntheticMesh(small);
  addResources(seeds, "coloured-torus", coloured.content());
  addResources(seeds, "sheet-with-hole", sheet.content());
  seeds.push_back(
      {"base", "valid-tetrahedron", withoutChecksum(encodeBaseMesh(tetrahedronBase()))});
  seeds.push_back({"base", "valid-synthetic", withoutChecksum(synthetic.content.base)});
  seeds.push_back(
      {"chunk-index", "valid-synthetic", withoutChecksum(synthetic.content.chunkIndex)});
  seeds.push_back(
      {"chunk-index", "cut-synthetic", withoutChecksum(synthetic.content.chunkIndex).substr(0, 9)});
  seeds.push_back({"answer", "valid-coloured", answerSeed(coloured, 1, 6)});
  seeds.push_back({"answer", "valid-sheet", answerSeed(sheet, 2, 4)});
  const std::string answer = answerSeed(sheet, 0, 5);
  seeds.push_back({"answer", "valid-plain", answer});
  seeds.push_back({"answer", "cut-plain", answer.substr(0, answer.size() - 3)});
  seeds.push_back({"refine", "valid-coloured", refineSeed(coloured, 0, true)});
  seeds.push_back({"refine", "valid-sheet", refineSeed(sheet, 1, false)});
  seeds.push_back({"refine", "valid-sheet-newest-first", refineSeed(sheet, 1, true)});
  std::string noise(1, '\2');
  uint32_t state = 1;
  while (noise.size() < 1500) {
    state = state * 1664525 + 1013904223;
    noise.push_back(static_cast<char>(state >> 24));
  }
  seeds.push_back({"refine", "odd-noise", noise});
  seeds.push_back({"pack", "valid-coloured", packSeed(coloured.content())});
  seeds.push_back({"pack", "valid-sheet", packSeed(sheet.content())});
  seeds.push_back({"pack", "odd-synthetic", packSeed(synthetic.content)});
  seeds.push_back({"pack", "odd-no-chunks", packSeed(sheet.content()).substr(0, 1500)});
  MeshMetadata metadata = coloured.content().metadata;
  metadata.revision = std::string(32, 'a');
  metadata.attributes = {"colours", "normals"};
  const std::string json = toJson(metadata);
  seeds.push_back({"metadata", "valid-torus", json});
  seeds.push_back({"metadata", "cut", json.substr(0, json.size() / 2)});
  seeds.push_back({"metadata", "odd-nesting", std::string(3000, '[')});
  seeds.push_back({"metadata", "odd-types",
                   R"({"name":1,"revision":[],"vertexCount":-1,"quantization":{"step":1e999}})"});
  const std::vector<Seed> ofUpstreams = upstreamSeeds(json);
  seeds.insert(seeds.end(), ofUpstreams.begin(), ofUpstreams.end());
  addRequests(seeds, innerRoots(sheet.base()));
  return seeds;
}

}  // namespace meshfront::fuzz
