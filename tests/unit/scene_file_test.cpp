#include "shared/scene/scene_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace meshfront {
namespace {

const std::string kUrl = "\"url\": \"http://localhost:8080/v1/meshes/bunny\"";

std::string sceneErrorOf(const std::string& json) {
  const auto scene = parseScene(json);
  return scene ? "" : scene.error().message;
}
std::string errorOfMeshWith(const std::string& members) {
  return sceneErrorOf("{\"meshes\": [{" + kUrl + ", " + members + "}]}");
}
glm::dvec3 moved(const SceneMesh& mesh, const glm::dvec3& point) {
  return glm::dvec3(mesh.worldFromMesh * glm::dvec4(point, 1));
}

TEST(SceneFile, PlacesMeshes) {
  const auto scene = parseScene("{\"meshes\": [{" + kUrl + "}, {" + kUrl +
                                ", \"name\": \"left\", \"translate\": [10, 20, 30], \"scale\": 2, "
                                "\"rotate\": {\"axis\": [0, 0, 3], \"degrees\": 90}}, {" +
                                kUrl + ", \"matrix\": [1,0,0,5, 0,0,-1,6, 0,1,0,7, 0,0,0,1]}]}");
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->size(), 3U);
  EXPECT_EQ((*scene)[0].name, "bunny");
  EXPECT_EQ((*scene)[0].url.origin, "http://localhost:8080");
  EXPECT_EQ((*scene)[0].worldFromMesh, glm::dmat4(1.0));
  EXPECT_EQ((*scene)[1].name, "left");
  // Scaled to (2, 4, 6), turned to (-4, 2, 6), moved.
  const glm::dvec3 turned = moved((*scene)[1], {1, 2, 3});
  EXPECT_NEAR(turned.x, 6, 1e-12);
  EXPECT_NEAR(turned.y, 22, 1e-12);
  EXPECT_NEAR(turned.z, 36, 1e-12);
  EXPECT_EQ(moved((*scene)[2], {1, 2, 3}), glm::dvec3(6, 3, 9));
}

TEST(SceneFile, NamesWhatIsWrong) {
  EXPECT_NE(sceneErrorOf("{").find("JSON object"), std::string::npos);
  EXPECT_NE(sceneErrorOf("[]").find("JSON object"), std::string::npos);
  EXPECT_NE(sceneErrorOf("{\"meshes\": []}").find("1 to 256"), std::string::npos);
  EXPECT_NE(sceneErrorOf("{\"meshes\": [{\"name\": \"x\"}]}").find("meshes[0]"), std::string::npos);
  EXPECT_NE(sceneErrorOf("{\"meshes\": [{\"url\": \"gopher://x\"}]}").find("meshes[0].url"),
            std::string::npos);
  EXPECT_NE(sceneErrorOf("{\"meshes\": [{" + kUrl + "}], \"up\": 1}").find("'up'"),
            std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"translat\": [1, 2, 3]").find("'translat'"), std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"translate\": [1, 2]").find("3 numbers"), std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"translate\": [1, 2, 1e999]").find("scene"), std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"rotate\": {\"axis\": [0, 0, 0], \"degrees\": 1}").find("0, 0, 0"),
            std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"rotate\": {\"axis\": [0, 0, 1]}").find("degrees"),
            std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"scale\": 0").find("singular"), std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]").find("row"),
            std::string::npos);
  EXPECT_NE(errorOfMeshWith("\"scale\": 1, \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]")
                .find("leave one out"),
            std::string::npos);
}

TEST(SceneFile, StandsWhatIsNoScene) {
  EXPECT_FALSE(parseScene(std::string(100'000, '[')));
  EXPECT_FALSE(parseScene(std::string(kMaxSceneBytes + 1, ' ')));
  std::string many = "{\"meshes\": [";
  for (size_t i = 0; i <= kMaxSceneMeshes; ++i) many += (i == 0 ? "{" : ", {") + kUrl + "}";
  EXPECT_FALSE(parseScene(many + "]}"));
  const std::string good = "{\"meshes\": [{" + kUrl + ", \"scale\": 2}]}";
  for (size_t length = 0; length < good.size(); ++length)
    EXPECT_FALSE(parseScene(good.substr(0, length))) << length;
}

TEST(SceneFile, IsReadFromAFile) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "scene.json";
  std::ofstream(path) << "{\"meshes\": [{" + kUrl + "}]}";
  const auto scene = readSceneFile(path);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->size(), 1U);
  std::filesystem::remove(path);
  const auto gone = readSceneFile(path);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::notFound);
}

}  // namespace
}  // namespace meshfront
