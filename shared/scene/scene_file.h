// Several meshes in one world, as a JSON file says it. Untrusted.
//
//   {"meshes": [
//     {"url": "http://museum.example/v1/meshes/igea"},
//     {"url": "http://museum.example/v1/meshes/bunny", "name": "left",
//      "translate": [0.2, 0, 0], "rotate": {"axis": [0, 1, 0], "degrees": 90}, "scale": 2},
//     {"url": "http://lab.example/v1/meshes/canyon",
//      "matrix": [1, 0, 0, 5,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]}]}
//
// A mesh is scaled, then rotated about the origin, then translated, each only where it is said; or
// it gets a matrix, 16 numbers row by row, the last row 0 0 0 1, not singular. The same mesh may
// stand at several places. Members that are not known are errors: a misspelt one would go unseen.
#pragma once

#include <filesystem>
#include <glm/mat4x4.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "shared/receiver/mesh_url.h"
#include "shared/result.h"

namespace meshfront {

struct SceneMesh {
  std::string name;  // to show; by default that of the mesh
  std::string urlText;
  MeshUrl url;
  glm::dmat4 worldFromMesh{1.0};
};

inline constexpr size_t kMaxSceneBytes = 1 << 20;
inline constexpr size_t kMaxSceneMeshes = 256;

// At least one mesh. Errors name the mesh ("meshes[2]") and the member.
[[nodiscard]] Result<std::vector<SceneMesh>> parseScene(std::string_view json);
[[nodiscard]] Result<std::vector<SceneMesh>> readSceneFile(const std::filesystem::path& path);
// One mesh where it lies.
[[nodiscard]] std::vector<SceneMesh> sceneOf(std::string urlText, MeshUrl url);

}  // namespace meshfront
