#include "shared/scene/scene_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>

namespace meshfront {
namespace {

using nlohmann::json;

constexpr double kSmallestVolume = 1e-30;  // of a unit cube that a matrix has moved

tl::unexpected<Error> wrong(const std::string& where, const std::string& problem) {
  return fail("the scene's " + where + " " + problem);
}

Result<void> onlyKnown(const json& object, const std::string& where,
                       std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string_view name : known)
      list += (list.empty() ? "" : ", ") + std::string(name);
    return wrong(where, "has a member '" + key + "'; known are " + list);
  }
  return {};
}

Result<void> readNumbers(const json& value, const std::string& where, std::span<double> out) {
  const std::string expected = "must be " + std::to_string(out.size()) + " numbers";
  if (!value.is_array() || value.size() != out.size()) return wrong(where, expected);
  for (size_t i = 0; i < out.size(); ++i) {
    if (!value[i].is_number()) return wrong(where, expected);
    out[i] = value[i].get<double>();
    if (!std::isfinite(out[i])) return wrong(where, expected);
  }
  return {};
}

Result<glm::dmat4> readMatrix(const json& value, const std::string& where) {
  std::array<double, 16> rows{};
  if (auto read = readNumbers(value, where, rows); !read) return tl::unexpected(read.error());
  if (rows[12] != 0 || rows[13] != 0 || rows[14] != 0 || rows[15] != 1)
    return wrong(where, "must end with the row 0, 0, 0, 1");
  glm::dmat4 matrix;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      matrix[column][row] = rows[static_cast<size_t>(4 * row + column)];
  return matrix;
}

Result<glm::dmat4> readRotation(const json& value, const std::string& where) {
  if (!value.is_object()) return wrong(where, "must be an object with axis and degrees");
  if (auto known = onlyKnown(value, where, {"axis", "degrees"}); !known)
    return tl::unexpected(known.error());
  if (!value.contains("axis") || !value.contains("degrees") || !value["degrees"].is_number())
    return wrong(where, "must have an axis of 3 numbers and degrees");
  std::array<double, 3> axis{};
  if (auto read = readNumbers(value["axis"], where + ".axis", axis); !read)
    return tl::unexpected(read.error());
  const glm::dvec3 direction(axis[0], axis[1], axis[2]);
  const double length = glm::length(direction);
  const auto degrees = value["degrees"].get<double>();
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(degrees))
    return wrong(where, "must have an axis that is not 0, 0, 0");
  return glm::rotate(glm::dmat4(1.0), glm::radians(degrees), direction / length);
}

Result<glm::dmat4> readPlace(const json& mesh, const std::string& where) {
  glm::dmat4 place(1.0);
  if (mesh.contains("matrix")) {
    if (mesh.contains("translate") || mesh.contains("rotate") || mesh.contains("scale"))
      return wrong(where, "has a matrix and also translate, rotate or scale: leave one out");
    auto matrix = readMatrix(mesh["matrix"], where + ".matrix");
    if (!matrix) return matrix;
    place = *matrix;
  }
  if (mesh.contains("translate")) {
    std::array<double, 3> by{};
    if (auto read = readNumbers(mesh["translate"], where + ".translate", by); !read)
      return tl::unexpected(read.error());
    place = glm::translate(place, {by[0], by[1], by[2]});
  }
  if (mesh.contains("rotate")) {
    auto rotation = readRotation(mesh["rotate"], where + ".rotate");
    if (!rotation) return rotation;
    place = place * *rotation;
  }
  if (mesh.contains("scale")) {
    if (!mesh["scale"].is_number() || !std::isfinite(mesh["scale"].get<double>()))
      return wrong(where + ".scale", "must be a number");
    place = glm::scale(place, glm::dvec3(mesh["scale"].get<double>()));
  }
  const double volume = std::abs(glm::determinant(glm::dmat3(place)));
  if (!(volume > kSmallestVolume) || !std::isfinite(volume))
    return wrong(where, "is moved to a plane, a line or a point: its scale or matrix is singular");
  return place;
}

Result<SceneMesh> readMesh(const json& mesh, const std::string& where) {
  if (!mesh.is_object() || !mesh.contains("url") || !mesh["url"].is_string())
    return wrong(where, "must be an object with a url, such as http://HOST/v1/meshes/NAME");
  if (auto known =
          onlyKnown(mesh, where, {"url", "name", "translate", "rotate", "scale", "matrix"});
      !known)
    return tl::unexpected(known.error());
  SceneMesh out;
  out.urlText = mesh["url"].get<std::string>();
  auto url = parseMeshUrl(out.urlText);
  if (!url) return wrong(where + ".url", "is wrong: " + url.error().message);
  out.url = std::move(*url);
  out.name = out.url.name;
  if (mesh.contains("name")) {
    if (!mesh["name"].is_string()) return wrong(where + ".name", "must be a text");
    out.name = mesh["name"].get<std::string>();
  }
  const auto place = readPlace(mesh, where);
  if (!place) return tl::unexpected(place.error());
  out.worldFromMesh = *place;
  return out;
}

}  // namespace

Result<std::vector<SceneMesh>> parseScene(std::string_view text) {
  if (text.size() > kMaxSceneBytes)
    return fail(ErrorCode::tooLarge, "a scene file has at most 1 MiB");
  // A limit on the depth: the parser itself would follow brackets for as long as there are any.
  constexpr int kMaxNesting = 8;
  bool tooDeep = false;
  const json scene = json::parse(
      text,
      [&tooDeep](int depth, json::parse_event_t, json&) {
        tooDeep = tooDeep || depth > kMaxNesting;
        return !tooDeep;
      },
      false);
  if (tooDeep) return fail("the scene is nested more deeply than a scene can be");
  if (!scene.is_object() || !scene.contains("meshes") || !scene["meshes"].is_array())
    return fail("a scene is a JSON object with an array 'meshes'");
  if (auto known = onlyKnown(scene, "file", {"meshes"}); !known)
    return tl::unexpected(known.error());
  const json& meshes = scene["meshes"];
  if (meshes.empty() || meshes.size() > kMaxSceneMeshes)
    return fail("a scene has 1 to " + std::to_string(kMaxSceneMeshes) + " meshes, this one " +
                std::to_string(meshes.size()));
  std::vector<SceneMesh> out;
  for (size_t i = 0; i < meshes.size(); ++i) {
    auto mesh = readMesh(meshes[i], "meshes[" + std::to_string(i) + "]");
    if (!mesh) return tl::unexpected(mesh.error());
    out.push_back(std::move(*mesh));
  }
  return out;
}

Result<std::vector<SceneMesh>> readSceneFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(ErrorCode::notFound, "the scene " + path.string() + " cannot be opened");
  std::string text(kMaxSceneBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(file.gcount()));
  if (file.bad()) return fail(ErrorCode::unavailable, path.string() + " cannot be read");
  auto scene = parseScene(text);
  if (!scene) return fail(scene.error().code, path.string() + ": " + scene.error().message);
  return scene;
}

std::vector<SceneMesh> sceneOf(std::string urlText, MeshUrl url) {
  SceneMesh mesh;
  mesh.name = url.name;
  mesh.urlText = std::move(urlText);
  mesh.url = std::move(url);
  return {std::move(mesh)};
}

}  // namespace meshfront
