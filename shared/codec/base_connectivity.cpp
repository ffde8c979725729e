#include "shared/codec/base_connectivity.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "shared/bits/integer_codes.h"

namespace meshfront {
namespace {

constexpr unsigned kComponentOrder = 1;
constexpr uint32_t kAbsent = UINT32_MAX;

struct Edge {
  uint32_t from, to;
};

uint64_t keyOf(uint32_t from, uint32_t to) {
  return uint64_t{from} << 32 | to;
}

// The part of the mesh known so far; the same on both ends.
class GrowingMesh {
 public:
  explicit GrowingMesh(uint32_t vertexCount)
      : seen_(vertexCount), starting_(vertexCount), ending_(vertexCount) {}

  // False if the triangle repeats a corner or a directed edge.
  bool add(const Triangle& t) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return false;
    for (size_t i = 0; i < 3; ++i)
      if (used_.count(keyOf(t[i], t[(i + 1) % 3])) != 0) return false;
    triangles_.push_back(t);
    for (size_t i = 0; i < 3; ++i) {
      const Edge edge{t[i], t[(i + 1) % 3]};
      used_.insert(keyOf(edge.from, edge.to));
      seen_[edge.from] = true;
      if (open_.erase(keyOf(edge.to, edge.from)) == 0) {
        open_.insert(keyOf(edge.from, edge.to));
        starting_[edge.from].push_back(edge.to);
        ending_[edge.to].push_back(edge.from);
        gates_.push_back(edge);
      }
    }
    return true;
  }

  // The next edge that lacks its neighbour.
  bool nextGate(Edge& gate) {
    while (nextGate_ < gates_.size()) {
      gate = gates_[nextGate_++];
      if (isOpen(gate)) return true;
    }
    return false;
  }
  // The smallest vertex not seen.
  bool nextSeed(uint32_t& seed) {
    while (nextSeed_ < seen_.size() && seen_[nextSeed_]) ++nextSeed_;
    seed = nextSeed_;
    return nextSeed_ < seen_.size();
  }
  // Closed edges leave the lists when they are met: no vertex's degree makes this slow.
  uint32_t afterEnd(Edge gate) {
    auto& ends = starting_[gate.to];
    while (!ends.empty() && !isOpen({gate.to, ends.back()})) ends.pop_back();
    return ends.empty() ? kAbsent : ends.back();
  }
  uint32_t beforeStart(Edge gate) {
    auto& starts = ending_[gate.from];
    while (!starts.empty() && !isOpen({starts.back(), gate.from})) starts.pop_back();
    return starts.empty() ? kAbsent : starts.back();
  }
  [[nodiscard]] bool seen(uint32_t vertex) const { return seen_[vertex]; }
  [[nodiscard]] bool closed() const { return open_.empty(); }
  [[nodiscard]] std::vector<Triangle> take() { return std::move(triangles_); }

 private:
  [[nodiscard]] bool isOpen(Edge edge) const { return open_.count(keyOf(edge.from, edge.to)) != 0; }

  std::vector<Triangle> triangles_;
  std::vector<bool> seen_;
  std::vector<std::vector<uint32_t>> starting_;  // ends of edges from a vertex, newest last
  std::vector<std::vector<uint32_t>> ending_;    // starts of edges to a vertex, likewise
  std::unordered_set<uint64_t> open_;            // edges that lack their neighbour
  std::unordered_set<uint64_t> used_;            // directed edges
  std::vector<Edge> gates_;
  size_t nextGate_ = 0;
  uint32_t nextSeed_ = 0;
};

}  // namespace

void writeBaseConnectivity(BitWriter& out, std::span<const Triangle> triangles,
                           uint32_t vertexCount) {
  std::unordered_map<uint64_t, uint32_t> opposite;  // directed edge -> third corner
  std::vector<Edge> firstEdge(vertexCount, {kAbsent, kAbsent});
  for (const Triangle& t : triangles)
    for (size_t i = 0; i < 3; ++i) {
      opposite[keyOf(t[i], t[(i + 1) % 3])] = t[(i + 2) % 3];
      if (firstEdge[t[i]].from == kAbsent) firstEdge[t[i]] = {t[i], t[(i + 1) % 3]};
    }
  GrowingMesh mesh(vertexCount);
  BitWriter body;
  uint64_t components = 0;
  uint32_t seed = 0;
  while (mesh.nextSeed(seed)) {
    ++components;
    const Edge first = firstEdge[seed];
    const uint32_t third = opposite[keyOf(first.from, first.to)];
    writeTruncated(body, first.to, vertexCount);
    writeTruncated(body, third, vertexCount);
    mesh.add({first.from, first.to, third});
    Edge gate{};
    while (mesh.nextGate(gate)) {
      const uint32_t corner = opposite[keyOf(gate.to, gate.from)];
      if (!mesh.seen(corner)) {
        body.write(0, 1);
        writeTruncated(body, corner, vertexCount);
      } else if (corner == mesh.afterEnd(gate)) {
        body.write(2, 2);
      } else if (corner == mesh.beforeStart(gate)) {
        body.write(6, 3);
      } else {
        body.write(7, 3);
        writeTruncated(body, corner, vertexCount);
      }
      mesh.add({gate.to, gate.from, corner});
    }
  }
  writeExpGolomb(out, components, kComponentOrder);
  const uint64_t bits = body.bitCount();
  out.append(body.take(), 0, bits);
}

Result<std::vector<Triangle>> readBaseConnectivity(BitReader& in, uint32_t vertexCount) {
  const auto damaged = [] { return fail("base mesh: damaged triangles"); };
  const uint64_t components = readExpGolomb(in, kComponentOrder);
  GrowingMesh mesh(vertexCount);
  for (uint64_t c = 0; c < components; ++c) {
    uint32_t seed = 0;
    if (in.overrun() || !mesh.nextSeed(seed)) return damaged();
    const uint32_t second = readTruncated(in, vertexCount);
    const uint32_t third = readTruncated(in, vertexCount);
    if (!mesh.add({seed, second, third})) return damaged();
    Edge gate{};
    while (mesh.nextGate(gate)) {
      unsigned rule = 0;
      while (rule < 3 && in.readBit()) ++rule;
      const uint32_t corner = rule == 1   ? mesh.afterEnd(gate)
                              : rule == 2 ? mesh.beforeStart(gate)
                                          : readTruncated(in, vertexCount);
      if (in.overrun() || corner >= vertexCount || !mesh.add({gate.to, gate.from, corner}))
        return damaged();
    }
  }
  uint32_t unseen = 0;
  if (!mesh.closed() || mesh.nextSeed(unseen)) return damaged();
  return mesh.take();
}

}  // namespace meshfront
