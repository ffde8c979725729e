#include "shared/mesh_files/gltf_instances.h"

#include <algorithm>
#include <cmath>

#include "shared/mesh_files/vector_length.h"

namespace meshfront {
namespace {

constexpr GltfTransform kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

std::array<double, 3> column(const GltfTransform& t, size_t i) {
  return {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
}

std::array<double, 3> cross(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// First `inner`, then `outer`.
GltfTransform composed(const GltfTransform& outer, const GltfTransform& inner) {
  GltfTransform out{};
  for (size_t c = 0; c < 4; ++c)
    for (size_t r = 0; r < 3; ++r) {
      double sum = c == 3 ? outer[9 + r] : 0;
      for (size_t k = 0; k < 3; ++k) sum += outer[3 * k + r] * inner[3 * c + k];
      out[3 * c + r] = sum;
    }
  return out;
}

std::vector<uint32_t> rootsOf(const GltfModel& model) {
  if (model.scene) return model.scenes[*model.scene];
  std::vector<uint32_t> roots;
  if (!model.scenes.empty()) {
    std::vector<bool> there(model.nodes.size());
    for (const auto& scene : model.scenes)
      for (const uint32_t node : scene) {
        if (!there[node]) roots.push_back(node);
        there[node] = true;
      }
    return roots;
  }
  std::vector<bool> isChild(model.nodes.size());
  for (const GltfNode& node : model.nodes)
    for (const uint32_t child : node.children) isChild[child] = true;
  for (uint32_t node = 0; node < model.nodes.size(); ++node)
    if (!isChild[node]) roots.push_back(node);
  return roots;
}

}  // namespace

Result<std::vector<GltfInstance>> shownMeshes(const GltfModel& model) {
  struct Visit {
    uint32_t node;
    GltfTransform parent;
  };
  std::vector<GltfInstance> instances;
  std::vector<bool> visited(model.nodes.size());  // each once: what follows ends
  std::vector<Visit> stack;
  const auto roots = rootsOf(model);
  for (size_t i = roots.size(); i-- > 0;) stack.push_back({roots[i], kIdentity});
  while (!stack.empty()) {
    const auto [number, parent] = stack.back();
    stack.pop_back();
    if (visited[number])
      return fail("nodes[" + std::to_string(number) + "]: has two parents or is below itself");
    visited[number] = true;
    const GltfNode& node = model.nodes[number];
    const GltfTransform toWorld = composed(parent, node.transform);
    if (node.mesh) instances.push_back({*node.mesh, number, node.hasSkin ? kIdentity : toWorld});
    for (size_t i = node.children.size(); i-- > 0;) stack.push_back({node.children[i], toWorld});
  }
  return instances;
}

std::array<double, 3> transformed(const GltfTransform& t, const std::array<double, 3>& point) {
  std::array<double, 3> out{};
  for (size_t r = 0; r < 3; ++r)
    out[r] = t[r] * point[0] + t[3 + r] * point[1] + t[6 + r] * point[2] + t[9 + r];
  return out;
}

double determinant(const GltfTransform& t) {
  const auto perpendicular = cross(column(t, 1), column(t, 2));
  return t[0] * perpendicular[0] + t[1] * perpendicular[1] + t[2] * perpendicular[2];
}

std::array<double, 3> transformedNormal(const GltfTransform& t,
                                        const std::array<double, 3>& normal) {
  // The inverse transpose times the determinant: the cofactors, which exist for every matrix.
  const std::array<std::array<double, 3>, 3> cofactors = {cross(column(t, 1), column(t, 2)),
                                                          cross(column(t, 2), column(t, 0)),
                                                          cross(column(t, 0), column(t, 1))};
  std::array<double, 3> out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t r = 0; r < 3; ++r) out[r] += cofactors[i][r] * normal[i];
  const double length = lengthOf(out) * (determinant(t) < 0 ? -1 : 1);
  if (length == 0 || !std::isfinite(length)) return {};
  for (double& component : out) component /= length;
  return out;
}

}  // namespace meshfront
