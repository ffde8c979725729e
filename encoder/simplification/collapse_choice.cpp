#include "encoder/simplification/collapse_choice.h"

#include <algorithm>

#include "shared/hierarchy/node_id.h"

namespace meshfront {

namespace {

constexpr float kLengthWeight = 1e-7F;
// From here on a ring is not walked where asking for single neighbours will do.
constexpr uint32_t kLongRing = 64;
constexpr float kNever = std::numeric_limits<float>::infinity();

Offset difference(const Offset& a, const Offset& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Offset cross(const Offset& a, const Offset& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
float dot(const Offset& a, const Offset& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

float CollapseChooser::cost(const SimplifyVertex& removed, const SimplifyVertex& kept) const {
  const auto [dx, dy, dz] = difference(kept.position, removed.position);
  const float error = removed.quadric.at(dx, dy, dz);
  const float length2 = std::max(1.0F, dx * dx + dy * dy + dz * dz);
  float result = std::max(0.0F, error) + kLengthWeight * length2 * length2;
  const auto factor = static_cast<float>(1 + std::max(removed.height, kept.height));
  if (balance_ >= 1) result *= factor;
  if (balance_ >= 2) result *= factor;
  return result;
}

uint32_t CollapseChooser::lowerBound(uint32_t removed) {
  const SimplifyVertex& vertex = vertices_[removed];
  float least = kNever;
  const HalfEdge first = mesh_.outgoing(removed);
  HalfEdge h = first;
  do {
    const SimplifyVertex& kept = vertices_[mesh_.target(h)];
    if (kept.state != SimplifyVertex::State::immovable) least = std::min(least, cost(vertex, kept));
    h = mesh_.turned(h);
  } while (h != first);
  return costKey(least);
}

void CollapseChooser::loadRing(uint32_t removed) {
  const SimplifyVertex& vertex = vertices_[removed];
  size_ = 0;
  idBits_ = 0;
  const HalfEdge first = mesh_.outgoing(removed);
  HalfEdge h = first;
  do {
    const uint32_t id = mesh_.target(h);
    ids_[size_] = id;
    halfEdges_[size_] = h;
    at_[size_] = &vertices_[id];
    idBits_ |= uint64_t{1} << (id % 64);
    ++size_;
    h = mesh_.turned(h);
  } while (h != first);
  for (uint32_t i = 0; i < size_; ++i) {
    const bool immovable = at_[i]->state == SimplifyVertex::State::immovable;
    offsets_[i] = difference(at_[i]->position, vertex.position);
    costs_[i] = immovable ? kNever : cost(vertex, *at_[i]);
    counts_.refusedVirtual += static_cast<uint64_t>(immovable);
  }
}

void CollapseChooser::findNormals() {
  for (uint32_t i = 0; i < size_; ++i) {
    const uint32_t next = i + 1 == size_ ? 0 : i + 1;
    const bool real = at_[i]->state != SimplifyVertex::State::immovable &&
                      at_[next]->state != SimplifyVertex::State::immovable;
    normals_[i] = real ? cross(offsets_[i], offsets_[next]) : Offset{};
  }
}

bool CollapseChooser::inRing(uint32_t vertex) const {
  if ((idBits_ >> (vertex % 64) & 1) == 0) return false;
  return std::find(ids_.begin(), ids_.begin() + size_, vertex) != ids_.begin() + size_;
}

bool CollapseChooser::adjacent(uint32_t a, uint32_t b) const {
  if (vertices_[a].valence > vertices_[b].valence) std::swap(a, b);
  const HalfEdge first = mesh_.outgoing(a);
  HalfEdge h = first;
  do {
    if (mesh_.target(h) == b) return true;
    h = mesh_.turned(h);
  } while (h != first);
  return false;
}

// The two ends may share no neighbours but the two opposite corners, and may not be a tetrahedron.
bool CollapseChooser::linkConditionHolds(uint32_t at) const {
  const uint32_t kept = ids_[at];
  const uint32_t valence = vertices_[kept].valence;
  if (size_ == 3 && valence == 3) return false;
  const uint32_t before = ids_[at == 0 ? size_ - 1 : at - 1];
  const uint32_t after = ids_[at + 1 == size_ ? 0 : at + 1];
  if (valence > kLongRing) {
    return std::none_of(ids_.begin(), ids_.begin() + size_, [&](uint32_t v) {
      return v != kept && v != before && v != after && adjacent(v, kept);
    });
  }
  const HalfEdge first = mesh_.outgoing(kept);
  HalfEdge h = first;
  do {
    const uint32_t v = mesh_.target(h);
    if (inRing(v) && v != before && v != after) return false;
    h = mesh_.turned(h);
  } while (h != first);
  return true;
}

bool CollapseChooser::turnsFaceOver(uint32_t at) const {
  const uint32_t before = at == 0 ? size_ - 1 : at - 1;
  for (uint32_t i = 0; i < size_; ++i) {
    if (i == at || i == before) continue;
    const uint32_t next = i + 1 == size_ ? 0 : i + 1;
    // Virtual, or without area: nothing to turn.
    if (!(dot(normals_[i], normals_[i]) > 0)) continue;
    const Offset turned =
        cross(difference(offsets_[i], offsets_[at]), difference(offsets_[next], offsets_[at]));
    if (!(dot(turned, normals_[i]) > 0)) return true;  // by a right angle, or to nothing
  }
  return false;
}

void CollapseChooser::fetch(std::span<const CollapseQueue::Entry> entries) const {
  constexpr int kUsualValence = 7;
  std::array<HalfEdge, kFetchedTogether> at;
  for (size_t i = 0; i < entries.size(); ++i) at[i] = mesh_.outgoing(entries[i].vertex);
  for (int step = 0; step < kUsualValence; ++step) {
    for (size_t i = 0; i < entries.size(); ++i) {
      __builtin_prefetch(&vertices_[mesh_.target(at[i])]);
      at[i] = mesh_.turned(at[i]);
    }
  }
}

CollapseChoice CollapseChooser::choose(uint32_t removed) {
  const SimplifyVertex& vertex = vertices_[removed];
  size_ = 0;
  if (vertex.valence > maxValence_) {
    ++counts_.refusedByValence;
    return CollapseChoice();
  }
  loadRing(removed);
  findNormals();
  CollapseChoice flipping;
  for (;;) {
    const auto least = std::min_element(costs_.begin(), costs_.begin() + size_);
    const auto at = static_cast<uint32_t>(least - costs_.begin());
    if (*least == kNever) return flipping;
    const uint32_t key = costKey(*least);
    *least = kNever;
    if (std::max(vertex.height, at_[at]->height) >= kMaxDepth) {
      ++counts_.refusedByDepth;
    } else if (flipping.halfEdge.is_valid() && turnsFaceOver(at)) {
      ++counts_.postponedFlips;
    } else if (!linkConditionHolds(at)) {
      ++counts_.refusedByLink;
    } else if (!flipping.halfEdge.is_valid() && turnsFaceOver(at)) {
      ++counts_.postponedFlips;
      flipping = {halfEdges_[at], key | kFlipBit};
    } else {
      return {halfEdges_[at], key};
    }
  }
}

}  // namespace meshfront
