#include "encoder/pack_tool/node_record.h"

#include <algorithm>
#include <map>

#include "encoder/pack_tool/node_name.h"
#include "shared/codec/chunk.h"
#include "shared/codec/cut_coding.h"
#include "shared/refinement/selectively_refined_mesh.h"

namespace meshfront {
namespace {

struct Place {
  uint32_t chunk = 0;
  std::span<const uint8_t> bytes;
  RecordEntry entry;
};

// Finds records by way of the index, as a receiver of chunks does.
class ChunkRecords {
 public:
  ChunkRecords(const Pack& pack, ChunkIndex index, const CodeTables& tables)
      : pack_(pack), index_(std::move(index)), tables_(tables) {}

  Result<Place> find(const NodeId& id, unsigned level) {
    const auto number = index_.find(id, level);
    if (!number) return missing(id);
    const auto bytes = pack_.chunk(*number);
    if (!bytes) return tl::unexpected(bytes.error());
    auto known = chunks_.find(*number);
    if (known == chunks_.end()) {
      auto chunk = decodeChunk(*bytes, tables_);
      if (!chunk) return tl::unexpected(chunk.error());
      known = chunks_.emplace(*number, std::move(*chunk)).first;
    }
    const auto& entries = known->second.entries;
    const auto at =
        std::lower_bound(entries.begin(), entries.end(), id,
                         [](const RecordEntry& entry, const NodeId& n) { return entry.id < n; });
    if (at == entries.end() || at->id != id) return missing(id);
    return Place{*number, *bytes, *at};
  }

 private:
  static tl::unexpected<Error> missing(const NodeId& id) {
    return fail("pack: the record of " + nodeName(id) +
                " is not in its chunk; encode the mesh again");
  }
  const Pack& pack_;
  ChunkIndex index_;
  const CodeTables& tables_;
  std::map<uint32_t, Chunk> chunks_;
};

const char* subjectOf(unsigned context) {
  if (context < cut_contexts::kLinearBegin) return "runs of l and r around the ring";
  if (context < cut_contexts::kStepBegin) return "sub-runs of l and r in one run";
  if (context < kCutContexts) return "next sub-run";
  return "one of many runs";
}

class TracingDecoder {
 public:
  static constexpr bool kDecodes = true;
  TracingDecoder(const CodeTables& tables, CutDecoder inner, std::vector<NodeRecord::Decision>& out)
      : chances_(tables.cutChances), inner_(inner), out_(out) {}

  bool decide(unsigned context, bool) { return add(context, false, inner_.decide(context, false)); }
  bool decideBackward(unsigned context, bool) {
    return add(context, true, inner_.decideBackward(context, false));
  }

 private:
  bool add(unsigned context, bool backward, bool bit) {
    out_.push_back({subjectOf(context), context, chances_[context], backward, bit});
    return bit;
  }
  const CutChances& chances_;
  CutDecoder inner_;
  std::vector<NodeRecord::Decision>& out_;
};

std::string bitsOf(std::span<const uint8_t> bytes, uint64_t begin, uint64_t end) {
  BitReader in(bytes, begin, end);
  std::string text;
  while (in.left() > 0) text.push_back(in.readBit() ? '1' : '0');
  return text;
}

// As the encoder counts them.
void measureFields(NodeRecord& out, const CodeTables& tables) {
  const Record& r = out.record;
  const unsigned context = tables.levelContext(out.level);
  const unsigned flags = leafFlagsOf(r);
  const auto& lengths = tables.cutLengths[flags];
  const auto length = std::find(lengths.begin(), lengths.end(), r.cutEnd - r.cutBegin);
  out.cutClass = static_cast<unsigned>(length - lengths.begin());
  out.headerBits = tables.header[context].length(tables.headerSymbol(flags, out.cutClass));
  if (flags == 0) out.levelBits = tables.levelPairs[context].length(levelPairSymbol(r, out.level));
  if (flags == 1 || flags == 2)
    out.levelBits = tables.levels[context].length(levelSymbol(r, out.level));
  const unsigned b = valueClassOf(r.deltaB);
  const unsigned c = valueClassOf(r.deltaC);
  out.classBits = tables.classes[context].length(b * tables.valueClasses + c) +
                  tables.residual[CodeTables::residualContext(std::max(b, c), context)].length(
                      valueClassOf(r.residualA));
  out.valueBits = valueBits(r.deltaB) + valueBits(r.deltaC) + valueBits(r.residualA);
  const AttributeBits attributes = attributeBits(r.attributes, tables.attributes, context);
  out.colourBits = attributes.colour;
  out.normalBits = attributes.normal;
}

void traceCut(NodeRecord& out, const SelectivelyRefinedMesh& mesh, NodeIndex node,
              const Place& place) {
  std::vector<HalfEdge> ring;
  mesh.edges().ring(mesh.slot(node), ring);
  std::vector<NodeId> entries;
  const auto nodeAtEnd = [&](uint32_t entry) {
    return mesh.nodeAt(mesh.edges().destination(ring[entry]));
  };
  for (uint32_t i = 0; i < ring.size(); ++i) {
    const NodeIndex at = nodeAtEnd(i);
    entries.push_back(mesh.id(at));
    out.ring.push_back({mesh.id(at), mesh.isVirtual(at)});
  }
  const auto positionOf = [&](uint32_t entry, unsigned depth) -> std::optional<GridPosition> {
    NodeIndex at = nodeAtEnd(entry);
    if (mesh.isVirtual(at)) return std::nullopt;
    for (unsigned steps = entries[entry].depth - depth; steps > 0; --steps) at = mesh.parent(at);
    return mesh.position(at);
  };
  const CodeTables& tables = mesh.base().tables;
  TracingDecoder coder(tables,
                       CutDecoder(tables, place.bytes, place.entry.bitOffset + out.record.cutBegin,
                                  place.entry.bitOffset + out.record.cutEnd),
                       out.decisions);
  const RingCut cut = walkRing(
      std::span<const NodeId>(entries),
      [&](uint32_t gap) { return mesh.keyOf(HalfEdgeMesh::faceOf(ring[gap])); }, positionOf,
      CutFrame(out.position, out.delta, out.normal), coder, RingCut{});
  out.leftEntry = cut.left;
  out.rightEntry = cut.right;
  out.leftFirst = cut.leftFirst;
}

tl::unexpected<Error> noRecord(const Pack& pack, const SelectivelyRefinedMesh& mesh,
                               NodeIndex leaf) {
  const GridPosition grid = mesh.position(leaf);
  const auto world = pack.metadata().quantization.toWorld(grid);
  const auto listed = [](const auto& values) {
    return std::to_string(values[0]) + " " + std::to_string(values[1]) + " " +
           std::to_string(values[2]);
  };
  return fail(ErrorCode::notFound, nodeName(mesh.id(leaf)) +
                                       " is a leaf, a vertex of the finest mesh at grid " +
                                       listed(grid) + ", world " + listed(world) +
                                       ": leaves are not split and have no record");
}

}  // namespace

Result<NodeRecord> nodeRecord(const Pack& pack, const NodeId& id) {
  auto base = decodeBaseMesh(pack.base());
  if (!base) return tl::unexpected(base.error());
  auto index = decodeChunkIndex(pack.chunkIndex());
  if (!index) return tl::unexpected(index.error());
  const size_t roots = base->roots.size();
  if (id.tree >= base->treeCount())
    return fail(ErrorCode::notFound, "there is no tree " + std::to_string(id.tree) +
                                         ": they are 0 to " +
                                         std::to_string(base->treeCount() - 1));
  if (id.tree >= roots)
    return fail(ErrorCode::notFound,
                nodeName(NodeId::root(id.tree)) +
                    " is a virtual vertex, which closes a boundary loop: trees from " +
                    std::to_string(roots) + " on are never split and have no records");
  auto made = SelectivelyRefinedMesh::fromBase(std::move(*base));
  if (!made) return tl::unexpected(made.error());
  SelectivelyRefinedMesh& mesh = *made;
  ChunkRecords records(pack, std::move(*index), mesh.base().tables);

  for (unsigned depth = 0;; ++depth) {
    const NodeIndex node = *mesh.find(id.ancestor(depth));
    if (mesh.isLeaf(node)) {
      if (depth == id.depth) return noRecord(pack, mesh, node);
      return fail(ErrorCode::notFound, "there is no node " + nodeName(id) + ": " +
                                           nodeName(mesh.id(node)) + " above it is a leaf");
    }
    const auto place = records.find(mesh.id(node), mesh.level(node));
    if (!place) return tl::unexpected(place.error());
    const RecordEntry& entry = place->entry;
    NodeRecord out;
    if (depth == id.depth) {
      out.id = id;
      out.level = mesh.level(node);
      out.chunk = place->chunk;
      out.bitOffset = entry.bitOffset;
      out.bitLength = entry.bitLength;
      out.bits = bitsOf(place->bytes, entry.bitOffset, entry.bitOffset + entry.bitLength);
      BitReader in(place->bytes, entry.bitOffset, entry.bitOffset + entry.bitLength);
      out.record = readRecord(in, mesh.base().tables, out.level);
      measureFields(out, mesh.base().tables);
      out.cutRegion = out.bits.substr(out.record.cutBegin);
      out.position = mesh.position(node);
      out.normal = mesh.normal(node);
      out.layout = mesh.attributeLayout();
      if (out.layout.any()) out.attributes = mesh.attributes()[mesh.slot(node)];
    }
    // On the last round this tells whether the record applies, and where t is.
    const SelectivelyRefinedMesh before = depth == id.depth ? mesh : SelectivelyRefinedMesh();
    if (auto done = mesh.split(node, place->bytes, entry.bitOffset, entry.bitLength); !done)
      return tl::unexpected(done.error());
    if (depth < id.depth) continue;
    const NodeIndex right = mesh.leftChild(node) + 1;
    const GridPosition t = mesh.position(right);
    for (size_t i = 0; i < 3; ++i) out.delta[i] = t[i] - out.position[i];
    out.mainAxis = mainAxis(out.normal);
    if (out.layout.any()) out.rightAttributes = mesh.attributes()[mesh.slot(right)];
    traceCut(out, before, node, *place);
    return out;
  }
}

}  // namespace meshfront
