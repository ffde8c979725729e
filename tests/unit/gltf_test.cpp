// glTF documents written by hand, and what they must become.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>

#include "encoder/cleaning/close_mesh.h"
#include "shared/mesh_files/available_memory.h"
#include "shared/mesh_files/mesh_files.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

using Positions = std::vector<std::array<double, 3>>;
using Triangles = std::vector<Triangle>;
using Colours = std::vector<Colour>;
using Normals = std::vector<std::array<float, 3>>;
using Sentences = std::vector<std::string>;

// Collects the bytes of one buffer; view() gives the JSON of a bufferView on what was added last.
class BinaryPart {
 public:
  template <typename T>
  BinaryPart& add(std::initializer_list<T> values) {
    start_ = bytes_.size();
    for (const T value : values) {
      bytes_.resize(bytes_.size() + sizeof value);
      std::memcpy(bytes_.data() + bytes_.size() - sizeof value, &value, sizeof value);
    }
    return *this;
  }
  [[nodiscard]] std::string view(const std::string& more = "") const {
    return R"({"buffer":0,"byteOffset":)" + std::to_string(start_) + R"(,"byteLength":)" +
           std::to_string(bytes_.size() - start_) + more + "}";
  }
  [[nodiscard]] const std::string& all() const { return bytes_; }

 private:
  std::string bytes_;
  size_t start_ = 0;
};

void appendWord(std::string& out, size_t word) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i));
}

// A GLB file of a document, which lacks its outer braces and its buffer, and the buffer.
std::string glb(const std::string& members, const std::string& bytes) {
  std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" +
                     std::to_string(bytes.size()) + "}]," + members + "}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string binary = bytes;
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out = "glTF";
  appendWord(out, 2);
  appendWord(out, 12 + 8 + json.size() + 8 + binary.size());
  appendWord(out, json.size());
  out += "JSON" + json;
  appendWord(out, binary.size());
  return out + std::string("BIN\0", 4) + binary;
}

IndexedMesh parsed(const std::string& file) {
  auto mesh = parseMesh(file, MeshFormat::gltf);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? std::move(*mesh) : IndexedMesh();
}
std::string problemOf(const std::string& file) {
  const auto mesh = parseMesh(file, MeshFormat::gltf);
  return mesh ? std::string("none") : mesh.error().message;
}

const Positions kGltfSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
BinaryPart squarePositions() {
  return BinaryPart().add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5F});
}
const std::string kPositions = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})";

// A square of the given primitives; views and accessors behind those of the positions.
std::string squareGlb(
    const BinaryPart& bytes, const std::string& views, const std::string& accessors,
    const std::string& primitives,
    const std::string& scene = R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}])") {
  return glb(R"("bufferViews":[{"buffer":0,"byteLength":48})" + views + R"(],"accessors":[)" +
                 kPositions + accessors + R"(],"meshes":[{"primitives":[)" + primitives + "]}]," +
                 scene,
             bytes.all());
}
std::string indexedSquare(const std::string& scene) {
  BinaryPart bytes = squarePositions();
  bytes.add<uint8_t>({0, 1, 2, 0, 2, 3});
  return squareGlb(bytes, "," + bytes.view(),
                   R"(,{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})",
                   R"({"attributes":{"POSITION":0},"indices":1})", scene);
}

TEST(Gltf, ReadsIndicesOfAllTypesAndModes) {
  const Triangles fan = {{0, 1, 2}, {0, 2, 3}};
  BinaryPart bytes = squarePositions();
  std::string views;
  views += "," + bytes.add<uint8_t>({0, 1, 2, 0, 2, 3}).view();
  views += "," + bytes.add<uint16_t>({0, 1, 2, 3}).view();
  views += "," + bytes.add<uint32_t>({1, 2, 0, 3}).view();
  const std::string accessors =
      R"(,{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})"
      R"(,{"bufferView":2,"componentType":5123,"count":4,"type":"SCALAR"})"
      R"(,{"bufferView":3,"componentType":5125,"count":4,"type":"SCALAR"})";
  const auto read = [&](const std::string& primitive) {
    const auto mesh = parsed(squareGlb(bytes, views, accessors, primitive));
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
  BinaryPart bytes = squarePositions();
  std::string views = "," + bytes.add<uint8_t>({0, 1, 2}).view();
  views += "," + bytes.add<uint8_t>({0, 2, 3}).view();
  const auto mesh =
      parsed(squareGlb(bytes, views,
                       R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"})"
                       R"(,{"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"})",
                       R"({"attributes":{"POSITION":0},"indices":1,"material":0},)"
                       R"({"attributes":{"POSITION":0},"indices":2,"material":1})"));
  EXPECT_EQ(mesh.positions, kGltfSquare);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Gltf, ComposesTransformsInDouble) {
  // 500,000 m east in double; a float would lose the 0.25.
  const auto mesh = parsed(
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
  const auto byMatrix = parsed(indexedSquare(
      R"("nodes":[{"mesh":0,"matrix":[0,2,0,0, -3,0,0,0, 0,0,4,0, 500000.25,4649776.125,0,1]}],)"
      R"("scenes":[{"nodes":[0]}])"));
  EXPECT_EQ(byMatrix.positions, expected);
}

TEST(Gltf, TurnsMirroredTrianglesRound) {
  const auto read = [](const std::string& scale) {
    return parsed(indexedSquare(R"("nodes":[{"mesh":0,"scale":)" + scale +
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
    const auto mesh = parsed(indexedSquare(nodes + scenes));
    return std::pair(mesh.positions.size(), mesh.positions.back());
  };
  using Found = std::pair<size_t, std::array<double, 3>>;
  EXPECT_EQ(xOfSecond(R"("scene":1,"scenes":[{"nodes":[0]},{"nodes":[1]}])"),
            (Found{4, {9, 1, 0.5}}));
  EXPECT_EQ(xOfSecond(R"("scenes":[{"nodes":[0]},{"nodes":[1,0]}])"), (Found{8, {9, 1, 0.5}}));
  EXPECT_EQ(xOfSecond(R"("x":0)"), (Found{12, {0, 10, 0.5}}));  // no scenes: all nodes
  EXPECT_EQ(parsed(indexedSquare(nodes + R"("scene":1,"scenes":[{},{"nodes":[1]},{}])")).notCarried,
            (Sentences{"scenes beside the default one: 2"}));
}

TEST(Gltf, BoundsTheTreeOfNodes) {
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}])")),
            "nodes[0]: has two parents or is below itself");
  EXPECT_EQ(problemOf(indexedSquare(
                R"("nodes":[{"children":[1,2]},{"children":[2]},{}],"scenes":[{"nodes":[0]}])")),
            "nodes[2]: has two parents or is below itself");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[{"children":[1]},{"children":[0]}])")).substr(0, 4),
            "byte");  // no root: nothing is shown
  std::string chain = R"("nodes":[{"mesh":0})";
  for (int i = 0; i < 20000; ++i) chain += R"(,{"children":[)" + std::to_string(i) + "]}";
  EXPECT_EQ(parsed(indexedSquare(chain + "]")).triangles.size(), 2U);
}

TEST(Gltf, ReadsColoursOfAllTypes) {
  const auto colours = [](auto values, const std::string& accessor) {
    BinaryPart bytes = squarePositions();
    bytes.add(values);
    return parsed(squareGlb(bytes, "," + bytes.view(), R"(,{"bufferView":1,"count":4,)" + accessor,
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
  BinaryPart bytes = squarePositions();
  bytes.add<float>({0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 7});
  const auto normals = [&](const std::string& node) {
    return parsed(squareGlb(bytes, "," + bytes.view(),
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
  BinaryPart bytes;
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
  EXPECT_EQ(parsed(with("true")).positions,
            (Positions{{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {0, 1, -1}}));
  EXPECT_EQ(parsed(with("false")).positions,
            (Positions{{0, 0, 0}, {32767, 0, 0}, {32767, -32767, 0}, {0, 32767, -32768}}));
}

TEST(Gltf, ReadsSparseAccessors) {
  for (const bool onZeros : {false, true}) {
    BinaryPart bytes = squarePositions();
    std::string views = R"({"buffer":0,"byteLength":48},)" + bytes.add<uint16_t>({1, 3}).view();
    views += "," + bytes.add<float>({5, 6, 7, 8, 9, 10}).view();
    const auto mesh =
        parsed(glb(R"("bufferViews":[)" + views +
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
  BinaryPart bytes = squarePositions();
  const auto mesh = parsed(
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
  BinaryPart bytes;
  std::string views =
      bytes.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}).view();
  views += "," + bytes.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1}).view();
  const auto mesh = parsed(glb(
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

TEST(Gltf, NamesThePlaceOfWhatIsWrong) {
  BinaryPart bytes = squarePositions();
  bytes.add<uint8_t>({0, 1, 4});
  const std::string indices = R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"})";
  const std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
  const auto with = [&](const std::string& accessors, const std::string& prims) {
    return problemOf(squareGlb(bytes, "," + bytes.view(), accessors, prims));
  };
  EXPECT_EQ(with(indices, primitive),
            "meshes[0].primitives[0]: accessors[1]: element 2: vertex index 4 is out of range, "
            "there are 4 vertices");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5121,"count":4,"type":"SCALAR"})", primitive),
            "meshes[0].primitives[0]: accessors[1]: 4 elements, but bufferViews[1] ends early");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5121,"count":9007199254740992,)"
                 R"("type":"SCALAR"})",
                 primitive)
                .substr(0, 20),
            "the scene with all i");
  EXPECT_EQ(with(R"(,{"bufferView":7,"componentType":5121,"count":3,"type":"SCALAR"})", primitive),
            "accessors[1].bufferView: there is no bufferViews[7]");
  EXPECT_EQ(with(R"(,{"componentType":5121,"count":1048577,"type":"SCALAR"})", primitive),
            "meshes[0].primitives[0]: accessors[1]: 1048577 elements without a bufferView, more "
            "than 1048576");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5121,"count":-3,"type":"SCALAR"})", primitive),
            "accessors[1].count: not a whole number");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5124,"count":3,"type":"SCALAR"})", primitive),
            "accessors[1].componentType: unknown");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"VEC5"})", primitive),
            "accessors[1].type: unknown");
  EXPECT_EQ(with(R"(,{"bufferView":1,"componentType":5121,"count":1,"type":"VEC3"})", primitive),
            "meshes[0].primitives[0]: accessors[1]: of a type that indices cannot have");
  EXPECT_EQ(with("", R"({"attributes":{"POSITION":0,"NORMAL":3}})"),
            "meshes[0].primitives[0].attributes: there is no accessors[3]");
  EXPECT_EQ(with(indices, R"({"attributes":{"POSITION":1}})"),
            "meshes[0].primitives[0]: accessors[1]: of a type that POSITION cannot have");
  EXPECT_EQ(with(R"(,{"componentType":5126,"count":3,"type":"VEC3"})",
                 R"({"attributes":{"POSITION":0,"NORMAL":1}})"),
            "meshes[0].primitives[0]: accessors[1]: 3 elements for 4 vertices");
  EXPECT_EQ(with("", R"({"attributes":{"POSITION":0},"mode":7})"),
            "meshes[0].primitives[0].mode: unknown");
  EXPECT_EQ(with("", R"({"mode":4})"), "meshes[0].primitives[0]: lacks attributes");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[{"mesh":0,"scale":[1,2]}])")),
            "nodes[0].scale: not 3 finite numbers");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[{"mesh":0,"translation":[1e308,0,0]},)"
                                    R"({"children":[0],"scale":[1e10,1,1]}])")),
            "meshes[0].primitives[0]: accessors[0]: element 0 is not finite at nodes[0]");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[{"mesh":0,"translation":[1e999,0,0]}])")),
            "byte 20: JSON with a number that is too large");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":[3])")), "nodes[0]: not an object");
  EXPECT_EQ(problemOf(indexedSquare(R"("nodes":{})")), "nodes: not an array");

  EXPECT_EQ(problemOf("{"), "byte 1: broken JSON");
  EXPECT_EQ(problemOf("[]"), "byte 0: not a glTF document");
  EXPECT_EQ(problemOf("{}"), "asset.version: not there; only glTF 2.0 is read");
  EXPECT_EQ(problemOf(R"({"asset":{"version":"1.0"}})"),
            "asset.version: '1.0', but only glTF 2.0 is read");
  EXPECT_EQ(problemOf(std::string(200000, '[')), "byte 64: JSON nested too deeply");
  BinaryPart infinite;
  infinite.add<float>({0, 0, 0, 1, 0, std::numeric_limits<float>::infinity(), 1, 1, 0, 0, 1, 0});
  EXPECT_EQ(problemOf(squareGlb(infinite, "", "", R"({"attributes":{"POSITION":0}})")),
            "meshes[0].primitives[0]: accessors[0]: element 1 is not finite at nodes[0]");
}

TEST(Gltf, SaysWhyThereIsNoTriangle) {
  const auto reason = [](const std::string& file) {
    const std::string problem = problemOf(file);
    const size_t has = problem.find("it has ");
    return has == std::string::npos ? problem : problem.substr(has + 7);
  };
  const std::string version = R"({"asset":{"version":"2.0"})";
  EXPECT_EQ(reason(version + "}"), "no meshes");
  EXPECT_EQ(reason(version + R"(,"meshes":[{}]})"), "meshes, but no node of the scene shows one");
  EXPECT_EQ(reason(squareGlb(squarePositions(), "", "",
                             R"({"attributes":{"POSITION":0},"mode":0},)"
                             R"({"attributes":{"POSITION":0},"mode":1})")),
            "only points and lines");
}

TEST(Gltf, RefusesCompressedPrimitivesByName) {
  const std::string draco = R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":0}})";
  EXPECT_EQ(problemOf(glb(R"("extensionsRequired":["KHR_materials_unlit",)"
                          R"("KHR_draco_mesh_compression"])",
                          "")),
            "extensionsRequired: the extension KHR_draco_mesh_compression is not read; save the "
            "mesh without it");
  EXPECT_EQ(problemOf(glb(R"("accessors":[{"componentType":5126,"count":4,"type":"VEC3"}],)"
                          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},)" +
                              draco + R"(}]}],"nodes":[{"mesh":0}])",
                          "")),
            "meshes[0].primitives[0]: compressed by the extension KHR_draco_mesh_compression, "
            "which is not read; save the mesh without it");
  // With an uncompressed twin it is read.
  EXPECT_EQ(parsed(squareGlb(squarePositions(), "", "",
                             R"({"attributes":{"POSITION":0},"mode":6,)" + draco + "}"))
                .triangles.size(),
            2U);
  EXPECT_EQ(problemOf(glb(R"("bufferViews":[{"buffer":0,"byteLength":48,"extensions":)"
                          R"({"EXT_meshopt_compression":{}}}],"accessors":[)" +
                              kPositions +
                              R"(],"meshes":[{"primitives":[{"attributes":)"
                              R"({"POSITION":0}}]}],"nodes":[{"mesh":0}])",
                          squarePositions().all())),
            "meshes[0].primitives[0]: bufferViews[0]: compressed by the extension "
            "EXT_meshopt_compression, which is not read; save the mesh without it");
}

TEST(Gltf, RefusesMoreInstancesThanMemory) {
  std::string nodes = R"("nodes":[{"mesh":0})";
  for (int i = 0; i < 1000; ++i) nodes += R"(,{"mesh":0})";
  BinaryPart bytes = squarePositions();
  const auto problem =
      problemOf(squareGlb(bytes, "", R"(,{"componentType":5126,"count":2000000,"type":"VEC3"})",
                          R"({"attributes":{"POSITION":1}})", nodes + "]"));
  if (availableMemory().bytes < 80e9)
    EXPECT_NE(problem.find("memory"), std::string::npos) << problem;
  else
    EXPECT_NE(problem.find("without a bufferView"), std::string::npos) << problem;
  EXPECT_EQ(
      problemOf(squareGlb(bytes, "", R"(,{"componentType":5126,"count":3000000,"type":"VEC3"})",
                          R"({"attributes":{"POSITION":1}})", nodes + "]")),
      "the scene has more than 2^31 - 1 vertices");
}

TEST(Gltf, SurvivesEveryTruncationAndChangedByte) {
  BinaryPart bytes = squarePositions();
  std::string views = "," + bytes.add<uint16_t>({0, 1, 2, 0, 2, 3}).view();
  views += "," + bytes.add<uint8_t>({1, 2}).view();
  const std::string good = squareGlb(
      bytes, views,
      R"(,{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},)"
      R"({"bufferView":0,"byteOffset":12,"componentType":5121,"normalized":true,"count":4,"type":)"
      R"("VEC4","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},)"
      R"("values":{"bufferView":0}}})",
      R"({"attributes":{"POSITION":0,"COLOR_0":2},"indices":1})",
      R"("nodes":[{"mesh":0,"scale":[1,2,3]},{"children":[0]}],"scenes":[{"nodes":[1]}],"scene":0)");
  ASSERT_EQ(parsed(good).colours.size(), 4U);
  for (size_t length = 0; length < good.size(); ++length) {
    const std::vector<char> prefix(good.begin(), good.begin() + static_cast<ptrdiff_t>(length));
    EXPECT_FALSE(parseMesh({prefix.data(), prefix.size()}, MeshFormat::gltf)) << length;
  }
  for (size_t i = 0; i < good.size(); ++i) {
    for (const int flip : {1, 2, 8, 0x80}) {
      std::string changed = good;
      changed[i] = static_cast<char>(changed[i] ^ flip);
      const auto mesh = parseMesh(changed, MeshFormat::gltf);
      if (!mesh) continue;
      for (const Triangle& t : mesh->triangles)
        for (const uint32_t corner : t) EXPECT_LT(corner, mesh->positions.size());
    }
  }
}

TEST(Gltf, TakesBuffersFromDataUrisAndFilesBesideOnly) {
  const TemporaryFolder folder;
  const auto put = [&](const std::string& name, const std::string& content) {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << content;
    return folder / name;
  };
  const auto document = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
           R"("componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[)"
           R"({"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})";
  };
  const std::string triangle = BinaryPart().add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}).all();
  const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  for (const char* head : {"data:application/octet-stream;base64,", "data:;base64,"})
    EXPECT_EQ(parsed(document(head + base64)).positions[2], (std::array<double, 3>{0, 1, 0}));
  EXPECT_EQ(problemOf(document("data:;base64,AAAA")),
            "meshes[0].primitives[0]: buffers[0]: ends early, at byte 3 of 36");
  EXPECT_EQ(problemOf(document("data:;base64,A*AA")),
            "meshes[0].primitives[0]: buffers[0]: a data URI that is not base64");
  EXPECT_EQ(
      problemOf(document("a.bin")),
      "meshes[0].primitives[0]: buffers[0]: 'a.bin' is another file, and only one is at hand");

  put("in/a b.bin", triangle);
  put("in/below/c.bin", triangle);
  const auto outside = put("outside.bin", triangle);
  std::filesystem::create_symlink(outside, folder / "in" / "link.bin");
  const auto problem = [&](const std::string& uri) {
    const auto mesh = readMesh(put("in/a.gltf", document(uri)));
    if (mesh) return std::string("none");
    const std::string& message = mesh.error().message;
    return message.substr(message.find("buffers[0]: ") + 12);
  };
  EXPECT_EQ(problem("a%20b.bin"), "none");
  EXPECT_EQ(problem("./below/../a b.bin"), "none");
  EXPECT_EQ(problem("below/c.bin"), "none");
  EXPECT_EQ(problem("none.bin"), "'none.bin' is not in the mesh's folder");
  EXPECT_EQ(problem("../outside.bin"), "'../outside.bin' lies outside the mesh's folder");
  EXPECT_EQ(problem("%2e%2e/outside.bin"), "'%2e%2e/outside.bin' lies outside the mesh's folder");
  EXPECT_EQ(problem(outside.string()).substr(0, 2), "'/");
  EXPECT_EQ(problem("link.bin"), "'link.bin' lies outside the mesh's folder");
  EXPECT_EQ(problem("below"), "'below' is no file");
  EXPECT_EQ(problem("file:///etc/passwd"),
            "'file:///etc/passwd' is not the name of a file in the mesh's folder");
  EXPECT_NE(readMesh(folder / "in" / "a.gltf").error().message.find("a.gltf: meshes[0]"),
            std::string::npos);
  // By content too.
  EXPECT_TRUE(readMesh(put("in/noname", document("a%20b.bin"))));
  EXPECT_TRUE(readMesh(put("in/glb", indexedSquare(R"("nodes":[{"mesh":0}])"))));
}

}  // namespace
}  // namespace meshfront
