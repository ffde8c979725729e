#include "tests/bench/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace meshfront {

namespace {

constexpr uint32_t kLeafTriangles = 4;
constexpr unsigned kDeepest = 64;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point along(const Point& from, const Point& direction, double share) {
  return {from[0] + share * direction[0], from[1] + share * direction[1],
          from[2] + share * direction[2]};
}
double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length2(const Point& a) {
  return dot(a, a);
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double segmentDistance2(const Point& p, const Point& a, const Point& b) {
  const Point edge = minus(b, a);
  const double squared = length2(edge);
  const double share = squared > 0 ? std::clamp(dot(minus(p, a), edge) / squared, 0.0, 1.0) : 0;
  return length2(minus(p, along(a, edge, share)));
}

double boxDistance2(const Point& p, const Point& low, const Point& high) {
  double sum = 0;
  for (size_t i = 0; i < 3; ++i) {
    const double outside = std::max({low[i] - p[i], p[i] - high[i], 0.0});
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Point> positions, std::span<const Triangle> triangles)
    : positions_(positions), triangles_(triangles), order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  std::vector<Point> centres(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (const uint32_t v : triangles[t])
      for (size_t i = 0; i < 3; ++i) centres[t][i] += positions[v][i];
  }
  nodes_.reserve(triangles.size());
  build(0, static_cast<uint32_t>(triangles.size()), centres);
}

void TriangleTree::build(uint32_t begin, uint32_t end, std::vector<Point>& centres) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const auto at = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}, begin, end - begin});
  for (uint32_t t = begin; t < end; ++t) {
    for (const uint32_t v : triangles_[order_[t]]) {
      for (size_t i = 0; i < 3; ++i) {
        nodes_[at].low[i] = std::min(nodes_[at].low[i], positions_[v][i]);
        nodes_[at].high[i] = std::max(nodes_[at].high[i], positions_[v][i]);
      }
    }
  }
  if (end - begin <= kLeafTriangles) return;
  const Point size = minus(nodes_[at].high, nodes_[at].low);
  const auto axis = static_cast<size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](uint32_t a, uint32_t b) { return centres[a][axis] < centres[b][axis]; });
  nodes_[at].count = 0;
  build(begin, middle, centres);
  nodes_[at].first = static_cast<uint32_t>(nodes_.size());
  build(middle, end, centres);
}

double TriangleTree::distance2(const Point& point, uint32_t triangle) const {
  const Point& a = positions_[triangles_[triangle][0]];
  const Point& b = positions_[triangles_[triangle][1]];
  const Point& c = positions_[triangles_[triangle][2]];
  const Point normal = cross(minus(b, a), minus(c, a));
  const double squared = length2(normal);
  if (squared > 0 && dot(cross(minus(b, a), minus(point, a)), normal) >= 0 &&
      dot(cross(minus(c, b), minus(point, b)), normal) >= 0 &&
      dot(cross(minus(a, c), minus(point, c)), normal) >= 0) {
    const double height = dot(minus(point, a), normal);
    return height * height / squared;
  }
  return std::min({segmentDistance2(point, a, b), segmentDistance2(point, b, c),
                   segmentDistance2(point, c, a)});
}

double TriangleTree::distance(const Point& point) const {
  struct Visit {
    uint32_t node;
    double distance2;
  };
  std::array<Visit, 2 * kDeepest> stack{};
  size_t waiting = 0;
  double best = std::numeric_limits<double>::infinity();
  stack[waiting++] = {0, 0};
  while (waiting > 0) {
    const Visit visit = stack[--waiting];
    if (visit.distance2 >= best) continue;
    const Node& node = nodes_[visit.node];
    for (uint32_t t = 0; t < node.count; ++t)
      best = std::min(best, distance2(point, order_[node.first + t]));
    if (node.count > 0) continue;
    Visit near = {visit.node + 1, 0};
    Visit far = {node.first, 0};
    for (Visit* child : {&near, &far})
      child->distance2 = boxDistance2(point, nodes_[child->node].low, nodes_[child->node].high);
    if (far.distance2 < near.distance2) std::swap(near, far);
    stack[waiting++] = far;
    stack[waiting++] = near;  // next
  }
  return std::sqrt(best);
}

SurfaceDistance surfaceDistance(std::span<const Point> positions,
                                std::span<const Triangle> triangles, const TriangleTree& to,
                                size_t samples) {
  SurfaceDistance out;
  std::vector<double> areaUpTo;
  areaUpTo.reserve(triangles.size());
  double area = 0;
  for (const Triangle& t : triangles) {
    area += std::sqrt(length2(
        cross(minus(positions[t[1]], positions[t[0]]), minus(positions[t[2]], positions[t[0]]))));
    areaUpTo.push_back(area);
  }
  std::vector<bool> seen(positions.size());
  for (const Triangle& t : triangles) {
    for (const uint32_t v : t) {
      if (!seen[v]) out.maximum = std::max(out.maximum, to.distance(positions[v]));
      seen[v] = true;
    }
  }
  // One point at a random place of each of equal pieces of the area.
  std::mt19937 random(1);
  const auto share = [&] { return random() * 0x1p-32; };
  size_t triangle = 0;
  double sum = 0;
  for (size_t i = 0; i < samples; ++i) {
    const double place = (static_cast<double>(i) + share()) / static_cast<double>(samples) * area;
    while (triangle + 1 < triangles.size() && areaUpTo[triangle] <= place) ++triangle;
    const Triangle& t = triangles[triangle];
    const double root = std::sqrt(share());
    const double second = share();
    Point point{};
    for (size_t k = 0; k < 3; ++k)
      point[k] = (1 - root) * positions[t[0]][k] + root * (1 - second) * positions[t[1]][k] +
                 root * second * positions[t[2]][k];
    const double distance = to.distance(point);
    sum += distance;
    out.maximum = std::max(out.maximum, distance);
  }
  out.mean = samples == 0 ? 0 : sum / static_cast<double>(samples);
  return out;
}

}  // namespace meshfront
