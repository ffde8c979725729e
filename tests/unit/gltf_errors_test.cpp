// glTF documents with something wrong, and what is said of it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>

#include "shared/mesh_files/available_memory.h"
#include "tests/data/temporary_folder.h"
#include "tests/unit/gltf_document.h"

namespace meshfront {
namespace {

using Positions = std::vector<std::array<double, 3>>;
using Triangles = std::vector<Triangle>;
using Colours = std::vector<Colour>;
using Normals = std::vector<std::array<float, 3>>;
using Sentences = std::vector<std::string>;

TEST(GltfErrors, NamesThePlaceOfWhatIsWrong) {
  GltfBuffer bytes = squarePositions();
  bytes.add<uint8_t>({0, 1, 4});
  const std::string indices = R"(,{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"})";
  const std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
  const auto with = [&](const std::string& accessors, const std::string& prims) {
    return problemOfGltf(squareGlb(bytes, "," + bytes.view(), accessors, prims));
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
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":[{"mesh":0,"scale":[1,2]}])")),
            "nodes[0].scale: not 3 finite numbers");
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":[{"mesh":0,"translation":[1e308,0,0]},)"
                                        R"({"children":[0],"scale":[1e10,1,1]}])")),
            "meshes[0].primitives[0]: accessors[0]: element 0 is not finite at nodes[0]");
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":[{"mesh":0,"translation":[1e999,0,0]}])")),
            "byte 20: JSON with a number that is too large");
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":[3])")), "nodes[0]: not an object");
  EXPECT_EQ(problemOfGltf(indexedSquare(R"("nodes":{})")), "nodes: not an array");

  EXPECT_EQ(problemOfGltf("{"), "byte 1: broken JSON");
  EXPECT_EQ(problemOfGltf("[]"), "byte 0: not a glTF document");
  EXPECT_EQ(problemOfGltf("{}"), "asset.version: not there; only glTF 2.0 is read");
  EXPECT_EQ(problemOfGltf(R"({"asset":{"version":"1.0"}})"),
            "asset.version: '1.0', but only glTF 2.0 is read");
  EXPECT_EQ(problemOfGltf(std::string(200000, '[')), "byte 64: JSON nested too deeply");
  GltfBuffer infinite;
  infinite.add<float>({0, 0, 0, 1, 0, std::numeric_limits<float>::infinity(), 1, 1, 0, 0, 1, 0});
  EXPECT_EQ(problemOfGltf(squareGlb(infinite, "", "", R"({"attributes":{"POSITION":0}})")),
            "meshes[0].primitives[0]: accessors[0]: element 1 is not finite at nodes[0]");
}

TEST(GltfErrors, SaysWhyThereIsNoTriangle) {
  const auto reason = [](const std::string& file) {
    const std::string problem = problemOfGltf(file);
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

TEST(GltfErrors, RefusesCompressedPrimitivesByName) {
  const std::string draco = R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":0}})";
  EXPECT_EQ(problemOfGltf(glb(R"("extensionsRequired":["KHR_materials_unlit",)"
                              R"("KHR_draco_mesh_compression"])",
                              "")),
            "extensionsRequired: the extension KHR_draco_mesh_compression is not read; save the "
            "mesh without it");
  EXPECT_EQ(problemOfGltf(glb(R"("accessors":[{"componentType":5126,"count":4,"type":"VEC3"}],)"
                              R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},)" +
                                  draco + R"(}]}],"nodes":[{"mesh":0}])",
                              "")),
            "meshes[0].primitives[0]: compressed by the extension KHR_draco_mesh_compression, "
            "which is not read; save the mesh without it");
  // With an uncompressed twin it is read.
  EXPECT_EQ(parsedGltf(squareGlb(squarePositions(), "", "",
                                 R"({"attributes":{"POSITION":0},"mode":6,)" + draco + "}"))
                .triangles.size(),
            2U);
  EXPECT_EQ(problemOfGltf(glb(R"("bufferViews":[{"buffer":0,"byteLength":48,"extensions":)"
                              R"({"EXT_meshopt_compression":{}}}],"accessors":[)" +
                                  kPositionAccessor +
                                  R"(],"meshes":[{"primitives":[{"attributes":)"
                                  R"({"POSITION":0}}]}],"nodes":[{"mesh":0}])",
                              squarePositions().all())),
            "meshes[0].primitives[0]: bufferViews[0]: compressed by the extension "
            "EXT_meshopt_compression, which is not read; save the mesh without it");
}

TEST(GltfErrors, RefusesMoreInstancesThanMemory) {
  std::string nodes = R"("nodes":[{"mesh":0})";
  for (int i = 0; i < 1000; ++i) nodes += R"(,{"mesh":0})";
  GltfBuffer bytes = squarePositions();
  const auto problem =
      problemOfGltf(squareGlb(bytes, "", R"(,{"componentType":5126,"count":2000000,"type":"VEC3"})",
                              R"({"attributes":{"POSITION":1}})", nodes + "]"));
  if (availableMemory().bytes < 80e9)
    EXPECT_NE(problem.find("memory"), std::string::npos) << problem;
  else
    EXPECT_NE(problem.find("without a bufferView"), std::string::npos) << problem;
  EXPECT_EQ(
      problemOfGltf(squareGlb(bytes, "", R"(,{"componentType":5126,"count":3000000,"type":"VEC3"})",
                              R"({"attributes":{"POSITION":1}})", nodes + "]")),
      "the scene has more than 2^31 - 1 vertices");
}

TEST(GltfErrors, SurvivesEveryTruncationAndChangedByte) {
  GltfBuffer bytes = squarePositions();
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
  ASSERT_EQ(parsedGltf(good).colours.size(), 4U);
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

TEST(GltfErrors, TakesBuffersFromDataUrisAndFilesBesideOnly) {
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
  const std::string triangle = GltfBuffer().add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}).all();
  const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  for (const char* head : {"data:application/octet-stream;base64,", "data:;base64,"})
    EXPECT_EQ(parsedGltf(document(head + base64)).positions[2], (std::array<double, 3>{0, 1, 0}));
  EXPECT_EQ(problemOfGltf(document("data:;base64,AAAA")),
            "meshes[0].primitives[0]: buffers[0]: ends early, at byte 3 of 36");
  EXPECT_EQ(problemOfGltf(document("data:;base64,A*AA")),
            "meshes[0].primitives[0]: buffers[0]: a data URI that is not base64");
  EXPECT_EQ(
      problemOfGltf(document("a.bin")),
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
