#include "encoder/simplification/simplify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "encoder/simplification/collapse_choice.h"
#include "encoder/simplification/collapse_queue.h"
#include "encoder/simplification/collapsible_mesh.h"
#include "encoder/simplification/end_state.h"
#include "encoder/simplification/space_filling_order.h"

namespace meshfront {

namespace {

using State = SimplifyVertex::State;
using Vector = std::array<double, 3>;

constexpr uint32_t kFewestVertices = 4;
constexpr size_t kProgressInterval = 16384;
// A boundary edge counts as this many faces as large as the square on it.
constexpr double kBoundaryWeight = 1;

Vector edgeVector(const Offset& from, const Offset& to) {
  return {double{to[0]} - from[0], double{to[1]} - from[1], double{to[2]} - from[2]};
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// Scales to length 1 and returns the length; leaves a zero vector as it is.
double normalize(Vector& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (length > 0) {
    for (double& c : v) c /= length;
  }
  return length;
}

class Simplifier {
 public:
  Simplifier(std::span<const GridPosition> positions, uint32_t virtualCount,
             const SimplifyOptions& options)
      : positions_(positions),
        realCount_(static_cast<uint32_t>(positions.size())),
        vertexCount_(realCount_ + virtualCount),
        inputIndex_(spaceFillingOrder(positions)),
        chooser_(mesh_, vertices_, options, result_.report) {
    const double share = options.baseFraction > 0 ? std::min(options.baseFraction, 1.0) : 0;
    const double wanted = std::ceil(share * realCount_);
    result_.report.wantedVertices = std::max(kFewestVertices, static_cast<uint32_t>(wanted));
  }

  Simplification run(std::span<const Triangle> triangles, size_t realTriangleCount,
                     const SimplifyProgress& progress) {
    {
      std::vector<uint32_t> newIndex(vertexCount_);
      std::iota(newIndex.begin() + realCount_, newIndex.end(), realCount_);
      for (uint32_t v = 0; v < realCount_; ++v) newIndex[inputIndex_[v]] = v;
      if (!mesh_.build(vertexCount_, triangles, newIndex)) {
        result_.report.why = StopReason::notClosed;
        return std::move(result_);
      }
      placeVertices();
      addFaceQuadrics(triangles.first(std::min(realTriangleCount, triangles.size())), newIndex);
    }
    addBoundaryQuadrics();
    fillQueue();
    collapseAll(progress);
    return std::move(result_);
  }

 private:
  // After the mesh is built, whose scratch memory is the other large part.
  void placeVertices() {
    vertices_.resize(vertexCount_);
    for (uint32_t v = 0; v < realCount_; ++v) {
      for (size_t i = 0; i < 3; ++i) {
        vertices_[v].position[i] = static_cast<float>(positions_[inputIndex_[v]][i]);
      }
    }
    for (uint32_t v = realCount_; v < vertexCount_; ++v) vertices_[v].state = State::immovable;
  }

  void addFaceQuadrics(std::span<const Triangle> triangles, std::span<const uint32_t> newIndex) {
    for (const Triangle& input : triangles) {
      const Triangle t = {newIndex[input[0]], newIndex[input[1]], newIndex[input[2]]};
      const Offset& origin = vertices_[t[0]].position;
      Vector normal = cross(edgeVector(origin, vertices_[t[1]].position),
                            edgeVector(origin, vertices_[t[2]].position));
      const double area = normalize(normal) / 2;
      if (!(area > 0)) continue;
      for (const uint32_t v : t) vertices_[v].quadric.addPlane(normal, area);
    }
  }

  // Planes through the boundary edges, perpendicular to their faces, keep the outlines.
  void addBoundaryQuadrics() {
    for (uint32_t v = realCount_; v < vertices_.size(); ++v) {
      const HalfEdge first = mesh_.outgoing(v);
      if (!first.is_valid()) continue;
      HalfEdge h = first;
      do {
        const HalfEdge next = mesh_.turned(h);
        addBoundaryEdge(mesh_.target(h), mesh_.target(next), mesh_.across(h));
        h = next;
      } while (h != first);
    }
  }
  void addBoundaryEdge(uint32_t a, uint32_t b, uint32_t inside) {
    const Vector edge = edgeVector(vertices_[a].position, vertices_[b].position);
    Vector plane =
        cross(edge, cross(edge, edgeVector(vertices_[a].position, vertices_[inside].position)));
    if (!(normalize(plane) > 0)) return;
    const double weight =
        kBoundaryWeight * (edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]);
    vertices_[a].quadric.addPlane(plane, weight);
    vertices_[b].quadric.addPlane(plane, weight);
  }

  void fillQueue() {
    queue_.reserve(vertices_.size());
    for (uint32_t v = 0; v < vertices_.size(); ++v) {
      const HalfEdge first = mesh_.outgoing(v);
      if (!first.is_valid()) {
        vertices_[v].state = State::immovable;
        continue;
      }
      HalfEdge h = first;
      do {
        ++vertices_[v].valence;
        h = mesh_.turned(h);
      } while (h != first);
      if (vertices_[v].state == State::immovable) continue;
      vertices_[v].key = chooser_.lowerBound(v);
      queue_.append({vertices_[v].key, v});
    }
    queue_.order();
  }

  void collapseAll(const SimplifyProgress& progress) {
    SimplifyReport& report = result_.report;
    const size_t planned =
        realCount_ > report.wantedVertices ? realCount_ - report.wantedVertices : 0;
    result_.collapses.reserve(planned);
    std::array<CollapseQueue::Entry, kFetchedTogether> batch{};
    while (result_.collapses.size() < planned && !queue_.empty()) {
      size_t size = 0;
      while (size < batch.size() && !queue_.empty()) {
        const CollapseQueue::Entry entry = queue_.top();
        queue_.pop();
        if (isCurrent(entry)) batch[size++] = entry;
      }
      chooser_.fetch({batch.data(), size});
      for (size_t i = 0; i < size && result_.collapses.size() < planned; ++i) {
        if (!isCurrent(batch[i])) continue;
        const uint32_t nextKey = i + 1 < size ? batch[i + 1].key : batch[i].key;
        if (!collapseOrPutBack(batch[i], nextKey)) continue;
        if (progress && result_.collapses.size() % kProgressInterval == 0) {
          progress(result_.collapses.size(), planned);
        }
      }
    }
    report.why =
        result_.collapses.size() < planned ? StopReason::noValidCollapse : StopReason::reachedBase;
    report.baseVertices = realCount_ - static_cast<uint32_t>(result_.collapses.size());
    if (report.why == StopReason::noValidCollapse) {
      report.endState = sweepEndState(mesh_, vertices_, realCount_, chooser_.maxValence());
    }
  }

  // False for an entry that a smaller one has replaced, or whose vertex has gone.
  [[nodiscard]] bool isCurrent(const CollapseQueue::Entry& entry) const {
    const SimplifyVertex& vertex = vertices_[entry.vertex];
    return vertex.state == State::waiting && vertex.key == entry.key;
  }

  // Collapses the vertex unless it has become dearer than both its entry and the next one.
  bool collapseOrPutBack(const CollapseQueue::Entry& entry, uint32_t nextKey) {
    SimplifyVertex& vertex = vertices_[entry.vertex];
    const CollapseChoice choice = chooser_.choose(entry.vertex);
    if (!choice.halfEdge.is_valid()) {
      vertex.state = State::parked;
      return false;
    }
    if (choice.key > std::max(entry.key, nextKey)) {
      vertex.key = choice.key;
      queue_.push({choice.key, entry.vertex});
      return false;
    }
    collapse(entry.vertex, choice);
    return true;
  }

  void collapse(uint32_t from, const CollapseChoice& choice) {
    const uint32_t to = mesh_.target(choice.halfEdge);
    SimplifyVertex& removed = vertices_[from];
    SimplifyVertex& kept = vertices_[to];
    kept.quadric.addMoved(removed.quadric, kept.position[0] - removed.position[0],
                          kept.position[1] - removed.position[1],
                          kept.position[2] - removed.position[2]);
    kept.height = static_cast<uint8_t>(1 + std::max(kept.height, removed.height));
    kept.valence += removed.valence - 4;
    mesh_.forOppositeCorners(choice.halfEdge, [&](uint32_t v) { --vertices_[v].valence; });
    removed.state = State::removed;
    mesh_.collapse(choice.halfEdge);
    result_.collapses.push_back({inputIndex_[to], inputIndex_[from]});

    SimplifyReport& report = result_.report;
    report.maxHeight = std::max(report.maxHeight, unsigned{kept.height});
    report.acceptedFlips += static_cast<uint64_t>((choice.key & kFlipBit) != 0);
    for (const uint32_t v : chooser_.ring()) reconsider(v, kept);
  }

  // Only these got a new direction to go, onto `kept`; all others can but have become dearer, which
  // is found out when they come up.
  void reconsider(uint32_t v, const SimplifyVertex& kept) {
    SimplifyVertex& vertex = vertices_[v];
    if (vertex.state == State::immovable || vertex.valence > chooser_.maxValence()) return;
    uint32_t key = 0;
    if (vertex.state == State::parked || (vertex.key & kFlipBit) != 0) {
      key = chooser_.lowerBound(v);
    } else if (&vertex != &kept) {
      key = costKey(chooser_.cost(vertex, kept));
    } else {
      return;
    }
    if (vertex.state == State::waiting && key >= vertex.key) return;
    vertex.state = State::waiting;
    vertex.key = key;
    queue_.push({key, v});
  }

  std::span<const GridPosition> positions_;
  uint32_t realCount_;
  uint32_t vertexCount_;
  std::vector<uint32_t> inputIndex_;  // of the real vertices, which are renumbered
  std::vector<SimplifyVertex> vertices_;
  CollapsibleMesh mesh_;
  Simplification result_;
  CollapseChooser chooser_;
  CollapseQueue queue_;
};

}  // namespace

Simplification simplify(std::span<const GridPosition> positions, uint32_t virtualCount,
                        std::span<const Triangle> triangles, size_t realTriangleCount,
                        const SimplifyOptions& options, const SimplifyProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  Simplification result =
      Simplifier(positions, virtualCount, options).run(triangles, realTriangleCount, progress);
  result.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace meshfront
