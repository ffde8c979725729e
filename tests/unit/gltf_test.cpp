// glTF documents written by hand, and what they must become.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>

#include "encoder/cleaning/close_mesh.h"
#include "tests/unit/gltf_document.h"

namespace meshfront {
namespace {

using Positions = std::vector<std::array<double, 3>>;
using Triangles = std::vector<Triangle>;
using Colours = std::vector<Colour>;
using Normals = std::vector<std::array<float, 3>>;
using Sentences = std::vector<std::string>;

TEST(Gltf, ReadsIndicesOfAllTypesAndModes) {
  const Triangles fan = {{0, 1, 2}, {0, 2, 3}};
  GltfBuffer bytes = squarePositions();
  std::string views;
  views += "," + bytes.add<uint8_t>({0, 1, 2, 0, 2, 3}).view();
  views += "," + bytes.add<uint16_t>({0, 1, 2, 3}).view();
  views += "," + bytes.add<uint32_t>({1, 2, 0, 3}).view();
  const std::string accessors =
      R"(,{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})"
      R"(,{"bufferView":2,"componentType":5123,"count":4,"type":"SCALAR"})"
      R"(,{"bufferView":3,"componentType":5125,"count":4,"type":"SCALAR"})";
  const auto read = [&](const std::string& primitive) {
    const auto mesh = parsedGltf(squareGlb(bytes, views, accessors, primitive));
    EXPECT_EQ(mesh.positions, kGltfSquare);
    EXPECT_TRUE(mesh.notCarried.empty());
    return mesh.triangles;
  };
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"indices":1})"), fan);
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"indices":1,"mode":4})"), fan);
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"indices":2,"mode":6})"), fan);
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"mode":6})"), fan);
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"indices":3,"mode":5})"),
            (Triangles{{1, 2, 0}, {0, 2, 3}}));
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0},"mode":5})"), (Triangles{{0, 1, 2}, {2, 1, 3}}));
}

TEST(Gltf, SharesVerticesAmongPrimitives) {
  GltfBuffer bytes = squarePositions();
  std::string views = "," + bytes.add<uint8_t>({0, 1, 2}).view();
  views += "," + bytes.add<uint8_t>({0, 2, 3}).view();
  const auto mesh =
      parsedGltf(squareGlb(bytes, views,
                           R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"})"
                           R"(,{"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"})",
                           R"({"attributes":{"POSITION":0},"indices":1,"material":0},)"
                           R"({"attributes":{"POSITION":0},"indices":2,"material":1})"));
  EXPECT_EQ(mesh.positions, kGltfSquare);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Gltf, ComposesTransformsInDouble) {
  // 500,000 m east in double; a float would lose the 0.25.
  const auto mesh = parsedGltf(
      indexedSquare(R"("nodes":[{"children":[1],"translation":[500000.25,4649776.125,0]},)"
                    R"({"children":[2],"rotation":[0,0,0.7071067811865476,0.7071067811865476]},)"
                    R"({"mesh":0,"scale":[2,3,4]}],"scenes":[{"nodes":[0]}],"scene":0)"));
  ASSERT_EQ(mesh.positions.size(), 4U);
  const Positions expected = {{500000.25, 4649776.125, 0},
                              {500000.25, 4649778.125, 0},
                              {499997.25, 4649778.125, 0},
                              {499997.25, 4649776.125, 2}};
  for (size_t i = 0; i < 4; ++i)
    for (size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(mesh.positions[i][axis], expected[i][axis], 1e-9);
  const auto byMatrix = parsedGltf(indexedSquare(
      R"("nodes":[{"mesh":0,"matrix":[0,2,0,0, -3,0,0,0, 0,0,4,0, 500000.25,4649776.125,0,1]}],)"
      R"("scenes":[{"nodes":[0]}])"));
  EXPECT_EQ(byMatrix.positions, expected);
}

TEST(Gltf, TurnsMirroredTrianglesRound) {
  const auto read = [](const std::string& scale) {
    return parsedGltf(indexedSquare(R"("nodes":[{"mesh":0,"scale":)" + scale +
                                    R"(}],"scenes":[{"nodes":[0]}])"))
        .triangles;
  };
  EXPECT_EQ(read("[1,1,-1]"), (Triangles{{0, 2, 1}, {0, 3, 2}}));
  EXPECT_EQ(read("[-1,1,-1]"), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(read("[-2,-2,-2]"), (Triangles{{0, 2, 1}, {0, 3, 2}}));
}

TEST(Gltf, ShowsTheDefaultSceneOrAll) {
  const std::string nodes =
      R"("nodes":[{"mesh":0},{"mesh":0,"translation":[9,0,0]},{"mesh":0,"translation":[0,9,0]}],)";
  const auto xOfSecond = [&](const std::string& scenes) {
    const auto mesh = parsedGltf(indexedSquare(nodes + scenes));
    return std::pair(mesh.positions.size(), mesh.positions.back());
  };
  using Found = std::pair<size_t, std::array<double, 3>>;
  EXPECT_EQ(xOfSecond(R"("scene":1,"scenes":[{"nodes":[0]},{"nodes":[1]}])"),
            (Found{4, {9, 1, 0.5}}));
  EXPECT_EQ(xOfSecond(R"("scenes":[{"nodes":[0]},{"nodes":[1,0]}])"), (Found{8, {9, 1, 0.5}}));
  EXPECT_EQ(xOfSecond(R"("x":0)"), (Found{12, {0, 10, 0.5}}));  // no scenes: all nodes
  EXPECT_EQ(
      parsedGltf(indexedSquare(nodes + R"("scene":1,"scenes":[{},{"nodes":[1]},{}])")).notCarried,
      (Sentences{"scenes beside the default one: 2"}));
}

TEST(Gltf, BoundsTheTreeOfNodes) {
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}])")),
            "nodes[0]: has two parents or is below itself");
  EXPECT_EQ(problemOfGltf(indexedSquare(
                R"("nodes":[{"children":[1,2]},{"children":[2]},{}],"scenes":[{"nodes":[0]}])")),
            "nodes[2]: has two parents or is below itself");
  EXPECT_EQ(
      problemOfGltf(indexedSquare(R"("nodes":[{"children":[1]},{"children":[0]}])")).substr(0, 4),
      "byte");  // no root: nothing is shown
  std::string chain = R"("nodes":[{"mesh":0})";
  for (int i = 0; i < 20000; ++i) chain += R"(,{"children":[)" + std::to_string(i) + "]}";
  EXPECT_EQ(parsedGltf(indexedSquare(chain + "]")).triangles.size(), 2U);
}

TEST(Gltf, ReadsColoursOfAllTypes) {
  const auto colours = [](auto values, const std::string& accessor) {
    GltfBuffer bytes = squarePositions();
    bytes.add(values);
    return parsedGltf(squareGlb(bytes, "," + bytes.view(),
                                R"(,{"bufferView":1,"count":4,)" + accessor,
                                R"({"attributes":{"POSITION":0,"COLOR_0":1},"mode":6})"))
        .colours;
  };
  EXPECT_EQ(colours(std::initializer_list<float>{0, .5F, 1, 1, 0, 0, 0, 1, 0, .1F, .2F, .3F},
                    R"("componentType":5126,"type":"VEC3"})"),
            (Colours{{0, 128, 255, 255}, {255, 0, 0, 255}, {0, 255, 0, 255}, {26, 51, 77, 255}}));
  EXPECT_EQ(colours(std::initializer_list<uint8_t>{1, 2, 3, 4, 255, 254, 253, 252, 0, 0, 0, 0, 7, 7,
                                                   7, 7},
                    R"("componentType":5121,"normalized":true,"type":"VEC4"})"),
            (Colours{{1, 2, 3, 4}, {255, 254, 253, 252}, {0, 0, 0, 0}, {7, 7, 7, 7}}));
  EXPECT_EQ(colours(std::initializer_list<uint16_t>{257, 514, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                    R"("componentType":5123,"normalized":true,"type":"VEC3"})")[0],
            (Colour{1, 2, 255, 255}));
}

TEST(Gltf, TransformsNormalsByTheInverseTranspose) {
  GltfBuffer bytes = squarePositions();
  bytes.add<float>({0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 7});
  const auto normals = [&](const std::string& node) {
    return parsedGltf(squareGlb(bytes, "," + bytes.view(),
                                R"(,{"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"})",
                                R"({"attributes":{"POSITION":0,"NORMAL":1},"mode":6})",
                                R"("nodes":[{"mesh":0)" + node + R"(}],"scenes":[{"nodes":[0]}])"))
        .normals;
  };
  EXPECT_EQ(normals(""), (Normals{{0, 0, 1}, {1, 1, 0}, {0, 0, 0}, {0, 0, 7}}));
  const auto stretched = normals(R"(,"scale":[1,2,-1e-30])");  // (1, 1, 0) leans towards x
  EXPECT_EQ(stretched[0], (std::array<float, 3>{0, 0, -1}));
  EXPECT_FLOAT_EQ(stretched[1][0], static_cast<float>(2 / std::sqrt(5.0)));
  EXPECT_FLOAT_EQ(stretched[1][1], static_cast<float>(1 / std::sqrt(5.0)));
  EXPECT_EQ(stretched[2], (std::array<float, 3>{0, 0, 0}));
  // Flat in x: what is left of a normal points along x.
  EXPECT_EQ(normals(R"(,"scale":[0,1,1])")[1], (std::array<float, 3>{1, 0, 0}));
}

TEST(Gltf, ReadsStridesOffsetsNormalizedAndQuantizedValues) {
  GltfBuffer bytes;
  bytes.add<int16_t>(
      {99, 99, 0, 0, 0, 77, 32767, 0, 0, 77, 32767, -32767, 0, 77, 0, 32767, -32768, 77});
  const auto with = [&](const char* normalized) {
    return glb(
        R"("extensionsRequired":["KHR_mesh_quantization"],"bufferViews":[)" +
            bytes.view(R"(,"byteStride":8)") +
            R"(],"accessors":[{"bufferView":0,"byteOffset":4,"componentType":5122,"count":4,)"
            R"("type":"VEC3","normalized":)" +
            normalized +
            R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":6}]}])"
            R"(,"nodes":[{"mesh":0}])",
        bytes.all());
  };
  EXPECT_EQ(parsedGltf(with("true")).positions,
            (Positions{{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {0, 1, -1}}));
  EXPECT_EQ(parsedGltf(with("false")).positions,
            (Positions{{0, 0, 0}, {32767, 0, 0}, {32767, -32767, 0}, {0, 32767, -32768}}));
}

TEST(Gltf, ReadsSparseAccessors) {
  for (const bool onZeros : {false, true}) {
    GltfBuffer bytes = squarePositions();
    std::string views = R"({"buffer":0,"byteLength":48},)" + bytes.add<uint16_t>({1, 3}).view();
    views += "," + bytes.add<float>({5, 6, 7, 8, 9, 10}).view();
    const auto mesh =
        parsedGltf(glb(R"("bufferViews":[)" + views +
                           R"(],"accessors":[{"componentType":5126,"count":4,"type":)"
                           R"("VEC3",)" +
                           (onZeros ? "" : R"("bufferView":0,)") +
                           R"("sparse":{"count":2,"indices":{"bufferView":1,"componentType":5123},)"
                           R"("values":{"bufferView":2}}}],"meshes":[{"primitives":[{"attributes":)"
                           R"({"POSITION":0},"mode":5}]}],"nodes":[{"mesh":0}])",
                       bytes.all()));
    EXPECT_EQ(mesh.positions[1], (std::array<double, 3>{5, 6, 7}));
    EXPECT_EQ(mesh.positions[3], (std::array<double, 3>{8, 9, 10}));
    EXPECT_EQ(mesh.positions[2],
              (onZeros ? std::array<double, 3>{} : std::array<double, 3>{1, 1, 0}));
  }
}

TEST(Gltf, SaysWhatItDoesNotCarry) {
  GltfBuffer bytes = squarePositions();
  const auto mesh = parsedGltf(
      squareGlb(bytes, "", R"(,{"componentType":5126,"count":4,"type":"VEC2"})",
                R"({"attributes":{"POSITION":0,"TEXCOORD_0":1,"TANGENT":1,"_\u001b":1},"mode":6,)"
                R"("targets":[{"POSITION":0}],"material":0},)"
                R"({"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":3},)"
                R"({"attributes":{"POSITION":0}})",
                R"("nodes":[{"mesh":0,"skin":0,"translation":[5,5,5]}],"skins":[{"joints":[0]}],)"
                R"("materials":[{},{}],"images":[{"uri":"a.png"}],"animations":[{}])"));
  EXPECT_EQ(mesh.positions, kGltfSquare);  // a node with a skin does not move its mesh
  EXPECT_EQ(mesh.triangles.size(), 3U);
  EXPECT_EQ(
      mesh.notCarried,
      (Sentences{"primitives with texture coordinates: 1", "materials: 2", "textures: 1",
                 "primitives of points: 1", "primitives of lines: 1",
                 "primitives with an incomplete last triangle: 1",
                 "primitives with morph targets: 1", "skins (their meshes stand as stored): 1",
                 "animations: 1", "extra vertex attributes: TANGENT, _?"}));
}

TEST(Gltf, SeamsAreWeldedNotTorn) {
  // Two triangles with a vertex each at both ends of their common edge, of different normals.
  GltfBuffer bytes;
  std::string views =
      bytes.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}).view();
  views += "," + bytes.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1}).view();
  const auto mesh = parsedGltf(glb(
      R"("bufferViews":[)" + views +
          R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3"},)"
          R"({"bufferView":1,"componentType":5126,"count":6,"type":"VEC3"}],"meshes":[{"primitives":)"
          R"([{"attributes":{"POSITION":0,"NORMAL":1}}]}],"nodes":[{"mesh":0,)"
          R"("rotation":[0.1,0.2,0.3,0.9],"translation":[1e6,0,0.1]}])",
      bytes.all()));
  CleaningReport report;
  const auto closed = closeMesh(mesh, report);
  ASSERT_TRUE(closed);
  EXPECT_EQ(report.weldedVertices, 2U);
  EXPECT_EQ(report.weldedDifferently, 1U);
  EXPECT_EQ(report.boundaryLoops, 1U);
}

}  // namespace
}  // namespace meshfront
