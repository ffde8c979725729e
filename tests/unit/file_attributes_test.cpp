// Colours, normals, and what readers say they do not carry.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>

#include "shared/mesh_files/mesh_files.h"
#include "tests/data/mesh_shapes.h"
#include "tests/data/temporary_folder.h"

namespace meshfront {
namespace {

using Colours = std::vector<Colour>;
using Normals = std::vector<std::array<float, 3>>;
using Sentences = std::vector<std::string>;

IndexedMesh parsed(const std::string& file, MeshFormat format) {
  auto mesh = parseMesh(file, format);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? std::move(*mesh) : IndexedMesh();
}

std::string asciiPly(const std::string& properties, const std::string& vertices) {
  return "ply\nformat ascii 1.0\n"
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
         properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + "3 0 1 2\n";
}
const std::string kRgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

TEST(PlyAttributes, ReadsColoursOfAllTypes) {
  EXPECT_EQ(
      parsed(asciiPly(kRgb, "0 0 0 1 2 3\n1 0 0 255 0 7\n0 1 0 9 9 9\n"), MeshFormat::ply).colours,
      (Colours{{1, 2, 3, 255}, {255, 0, 7, 255}, {9, 9, 9, 255}}));
  EXPECT_EQ(parsed(asciiPly("property float red\nproperty double green\nproperty ushort blue\n"
                            "property float alpha\n",
                            "0 0 0 0 0.5 65535 1\n1 0 0 1 .1 257 .5\n0 1 0 .2 0 0 0\n"),
                   MeshFormat::ply)
                .colours,
            (Colours{{0, 128, 255, 255}, {255, 26, 1, 128}, {51, 0, 0, 0}}));
  // Each of the 256 values stays what it is.
  for (int value = 0; value < 256; ++value) {
    const std::string v = std::to_string(value);
    const auto mesh =
        parsed(asciiPly(kRgb, "0 0 0 " + v + " 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n"), MeshFormat::ply);
    EXPECT_EQ(mesh.colours.at(0)[0], value);
  }
}

TEST(PlyAttributes, ReadsNormalsAmongOtherProperties) {
  const auto mesh =
      parsed(asciiPly("property double nx\nproperty float confidence\nproperty float ny\n"
                      "property int nz\nproperty list uchar int tags\n",
                      "0 0 0 1 7 2 3 0\n1 0 0 .5 7 0 1 2 4 5\n0 1 0 0 7 0 -1 0\n"),
             MeshFormat::ply);
  EXPECT_EQ(mesh.normals, (Normals{{1, 2, 3}, {0.5, 0, 1}, {0, 0, -1}}));
  EXPECT_TRUE(mesh.colours.empty());
  EXPECT_EQ(mesh.notCarried, (Sentences{"extra vertex properties: confidence, tags"}));
}

TEST(PlyAttributes, PartsOfAColourOrNormalAreExtraProperties) {
  const auto mesh = parsed(asciiPly("property uchar red\nproperty float nx\nproperty uchar alpha\n",
                                    "0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n"),
                           MeshFormat::ply);
  EXPECT_TRUE(mesh.colours.empty());
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(mesh.notCarried, (Sentences{"extra vertex properties: red, nx, alpha"}));
}

TEST(PlyAttributes, MendsOddValuesAndSaysSo) {
  const auto mesh = parsed(
      asciiPly("property float red\nproperty float green\nproperty float blue\nproperty float nx\n"
               "property float ny\nproperty float nz\n",
               "0 0 0 1.00001 -1e-9 1 nan 0 0\n1 0 0 2 -1 nan 0 inf 0\n0 1 0 0 0 0 0 0 1e300\n"),
      MeshFormat::ply);
  EXPECT_EQ(mesh.colours, (Colours{{255, 0, 255, 255}, {255, 0, 0, 255}, {0, 0, 0, 255}}));
  EXPECT_EQ(mesh.normals, (Normals{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(mesh.notCarried, (Sentences{"colours: 1 are out of range and were clamped",
                                        "normals: 3 are not finite"}));
}

TEST(PlyAttributes, ReadsThroughTriangleStripsInBinary) {
  std::string file =
      "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty uchar x\n"
      "property uchar y\nproperty uchar z\nproperty char nx\nproperty char ny\nproperty char nz\n"
      "element tristrips 1\nproperty list uchar char vertex_indices\nend_header\n";
  for (int i = 0; i < 4; ++i)
    file += {char(200 + i), 2, 3, char(100 + i), char(i % 2), char(i / 2), 0, 0, char(-i), 1};
  file += {4, 0, 1, 2, 3};
  const auto mesh = parsed(file, MeshFormat::ply);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.colours,
            (Colours{{200, 2, 3, 100}, {201, 2, 3, 101}, {202, 2, 3, 102}, {203, 2, 3, 103}}));
  EXPECT_EQ(mesh.normals, (Normals{{0, 0, 1}, {0, -1, 1}, {0, -2, 1}, {0, -3, 1}}));
  EXPECT_TRUE(mesh.notCarried.empty());
}

TEST(PlyAttributes, NamesWhatElseThereIsInPrintableCharacters) {
  std::string many;
  for (int i = 0; i < 20; ++i) many += "property float p" + std::to_string(i) + "\n";
  const std::string twenty = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";
  EXPECT_EQ(parsed(asciiPly(many, "0 0 0" + twenty + "1 0 0" + twenty + "0 1 0" + twenty),
                   MeshFormat::ply)
                .notCarried,
            (Sentences{"extra vertex properties: p0, p1, p2, p3, p4, p5, p6, p7, p8, p9, p10, p11 "
                       "and 8 more"}));
  const std::string odd = "property float \xff\x1b[31m\n";
  EXPECT_EQ(parsed("ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement camera 1\n"
                   "property int a\n" +
                       asciiPly(odd, "7\n0 0 0 1\n1 0 0 1\n0 1 0 1\n").substr(21),
                   MeshFormat::ply)
                .notCarried,
            (Sentences{"extra vertex properties: ??[31m", "other elements: camera",
                       "textures: skin.png"}));
}

TEST(ObjAttributes, ReadsColoursBehindCoordinates) {
  EXPECT_EQ(
      parsed("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0 .25\nv 0 1 0 # none\nv 1 1 0 1.0\nf 1 2 3 4\n",
             MeshFormat::obj)
          .colours,
      (Colours{{255, 0, 128, 255}, {0, 255, 0, 64}, {255, 255, 255, 255}, {255, 255, 255, 255}}));
  EXPECT_TRUE(
      parsed("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n", MeshFormat::obj).colours.empty());
}

TEST(ObjAttributes, TellsWholeChannelsFromReal) {
  EXPECT_EQ(
      parsed("v 0 0 0 255 0 7\nv 1 0 0 1 1 1 3\nv 0 1 0 0 0 0\nf 1 2 3\n", MeshFormat::obj).colours,
      (Colours{{255, 0, 7, 255}, {1, 1, 1, 3}, {0, 0, 0, 255}}));
  const auto bright =
      parsed("v 0 0 0 1.5 0 1\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n", MeshFormat::obj);
  EXPECT_EQ(bright.colours, (Colours{{255, 0, 255, 255}, {255, 255, 255, 255}, {0, 0, 0, 255}}));
  EXPECT_EQ(bright.notCarried, (Sentences{"colours: 1 are out of range and were clamped"}));
}

TEST(ObjAttributes, ReadsNormalsThatAllCornersAgreeOn) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n";
  const auto mesh = parsed(vertices +
                               "vn 0 0 1\nvn 1 0 0\nvn 0 0 1.0\nf 1//1 2//1 3//-1\n"
                               "f 1/7/3 3//1 4//2\nvt 0 0\nvt 1 1\n",
                           MeshFormat::obj);
  EXPECT_EQ(mesh.normals, (Normals{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(mesh.notCarried, (Sentences{"texture coordinates: 2"}));

  const auto torn = parsed(vertices +
                               "usemtl a\nusemtl b\nusemtl a\no x\ng y\nl 1 2\np 1\n"
                               "f 1//1 2//1 3//1\nf 1//2 3//2 4//2\nvn 0 0 1\nvn 1 0 0\n",
                           MeshFormat::obj);
  EXPECT_EQ(torn.normals, (Normals{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(torn.positions.size(), 5U);  // not torn
  EXPECT_EQ(torn.notCarried,
            (Sentences{"normals: 2 vertices have different ones at different corners",
                       "materials: 2", "groups and objects: 2", "lines: 1", "points: 1"}));

  const auto none =
      parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 3//2 2//2 1//2\n",
             MeshFormat::obj);
  EXPECT_TRUE(none.normals.empty());
  EXPECT_EQ(none.notCarried,
            (Sentences{"normals: 3 vertices have different ones at different corners"}));
}

TEST(ObjAttributes, NamesTheLineOfABrokenNormal) {
  const auto message = [](const std::string& text) {
    const auto mesh = parseMesh("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + text, MeshFormat::obj);
    return mesh ? std::string() : mesh.error().message;
  };
  EXPECT_EQ(message("f 1//1 2//1 3//1\n"), "line 4: normal index 1 is out of range, there are 0");
  EXPECT_EQ(message("vn 0 0 1\nf 1//1 2//-2 3//1\n"),
            "line 5: normal index -2 is out of range, there are 1 so far");
  EXPECT_EQ(message("f 1//0 2 3\n"), "line 4: normal index 0 is out of range, there are 0 so far");
  EXPECT_EQ(message("f 1//x 2 3\n"), "line 4: broken normal index");
  EXPECT_EQ(message("vn 0 0\nf 1 2 3\n"), "line 4: the line ends where a number belongs");
  EXPECT_EQ(message("f 1/1/ 2/1/ 3/1/\n"), "");
  // An index far ahead makes no memory.
  EXPECT_EQ(message("vn 0 0 1\nf 2147483647//1 2//1 3//1\n"),
            "line 5: vertex index 2147483647 is out of range, there are 3 vertices");
}

TEST(OffAttributes, ReadsColoursOfBothScales) {
  EXPECT_EQ(parsed("COFF\n3 1 0\n0 0 0 1 0 .5 1\n1 0 0 0 0 0 0\n0 1 0 .2 0 0 .5\n3 0 1 2\n",
                   MeshFormat::off)
                .colours,
            (Colours{{255, 0, 128, 255}, {0, 0, 0, 0}, {51, 0, 0, 128}}));
  EXPECT_EQ(
      parsed("COFF\n3 1 0\n0 0 0 255 0 1\n1 0 0 3 4 5\n0 1 0 0 0 0\n3 0 1 2\n", MeshFormat::off)
          .colours,
      (Colours{{255, 0, 1, 255}, {3, 4, 5, 255}, {0, 0, 0, 255}}));
}

TEST(OffAttributes, ReadsNormalsInFrontOfColours) {
  const auto mesh = parsed(
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 8 7 6 0 0\n1 0 0 0 1 0 255 0 0 255 1 0\n"
      "0 1 0 1 0 0 0 0 0 0 0 1 # last\n3 0 1 2 255 0 0\n",
      MeshFormat::off);
  EXPECT_EQ(mesh.normals, (Normals{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
  EXPECT_EQ(mesh.colours, (Colours{{9, 8, 7, 6}, {255, 0, 0, 255}, {0, 0, 0, 0}}));
  EXPECT_EQ(mesh.notCarried, (Sentences{"texture coordinates: 3", "faces with a colour: 1"}));
  EXPECT_EQ(parsed("OFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n", MeshFormat::off)
                .notCarried,
            (Sentences{"columns behind a vertex that the keyword does not name: 3"}));
  const auto lacking = parseMesh("NOFF\n1 0 0\n0 0 0 0 1\n", MeshFormat::off);
  ASSERT_FALSE(lacking);
  EXPECT_EQ(lacking.error().message, "line 3: the line ends where a number of a normal belongs");
}

void putWord(std::string& file, uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(word >> shift);
}
std::string binaryOff(const char* keyword, const std::vector<float>& values, uint32_t vertices,
                      const std::vector<uint32_t>& faces, uint32_t faceCount) {
  std::string file = std::string(keyword) + " BINARY\n";
  for (const uint32_t count : {vertices, faceCount, 0U}) putWord(file, count);
  for (const float value : values) putWord(file, std::bit_cast<uint32_t>(value));
  for (const uint32_t word : faces) putWord(file, word);
  return file;
}

TEST(BinaryOff, ReadsAllItMayHold) {
  const float colour = std::bit_cast<float>(0x3f000000U);  // 0.5, an unused face colour
  const auto mesh =
      parsed(binaryOff("STCNOFF",
                       {0, 0, 0, 0, 0, 1, 1, 0, 0.2F, 1, 5, 5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 5, 5,
                        0, 1, 0, 0, 0, 1, 0, 1, 0,    1, 5, 5, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0, 5, 5},
                       4, {4, 0, 1, 3, 2, 0, 3, 0, 1, 2, 1, std::bit_cast<uint32_t>(colour)}, 2),
             MeshFormat::off);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}, {0, 1, 2}}));
  EXPECT_EQ(mesh.positions[3], (std::array<double, 3>{1, 1, 0}));
  EXPECT_EQ(mesh.normals, Normals(4, {0, 0, 1}));
  EXPECT_EQ(mesh.colours,
            (Colours{{255, 0, 51, 255}, {0, 0, 0, 0}, {0, 255, 0, 255}, {0, 0, 255, 0}}));
  EXPECT_EQ(mesh.notCarried, (Sentences{"texture coordinates: 4", "faces with a colour: 1"}));
}

TEST(BinaryOff, NamesTheByteOfWhatIsWrong) {
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const auto message = [&](const std::string& file) {
    const auto mesh = parseMesh(file, MeshFormat::off);
    return mesh ? std::string() : mesh.error().message;
  };
  const std::string good = binaryOff("OFF", corners, 3, {3, 0, 1, 2, 0}, 1);
  EXPECT_EQ(message(good), "");
  for (size_t length = 0; length < good.size(); ++length) {
    const std::vector<char> prefix(good.begin(), good.begin() + static_cast<ptrdiff_t>(length));
    EXPECT_FALSE(parseMesh({prefix.data(), prefix.size()}, MeshFormat::off)) << length;
  }
  EXPECT_EQ(message(binaryOff("OFF", corners, 3, {3, 0, 1, 3, 0}, 1)),
            "byte 71: vertex index 3 is out of range, there are 3 vertices");
  EXPECT_EQ(message(binaryOff("OFF", corners, UINT32_MAX, {3, 0, 1, 2, 0}, UINT32_MAX)),
            "byte 79: the file ends early, it promises 4294967295 vertices and 4294967295 faces");
  EXPECT_EQ(message(binaryOff("OFF", corners, 3, {UINT32_MAX, 0, 1, 2, 0}, 1)),
            "byte 79: the file ends early");
  auto infinite = corners;
  infinite[4] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(message(binaryOff("OFF", infinite, 3, {3, 0, 1, 2, 0}, 1)),
            "byte 39: a coordinate that is not finite");
  EXPECT_EQ(message(binaryOff("OFF", corners, 3, {}, 0)),
            "byte 59: the file ends without a single triangle: it has 3 vertices and no face with "
            "three corners");
}

TEST(StlAttributes, SaysThatAttributeBytesAreDropped) {
  std::string file(80, ' ');
  const std::array<uint32_t, 1> count = {2};
  file.append(reinterpret_cast<const char*>(count.data()), 4);
  for (const uint16_t attribute : {0, 0x8000}) {
    const std::array<float, 12> facet = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    file.append(reinterpret_cast<const char*>(facet.data()), 48);
    file.append(reinterpret_cast<const char*>(&attribute), 2);
  }
  const auto mesh = parsed(file, MeshFormat::stl);
  EXPECT_TRUE(mesh.normals.empty());  // a facet's is none of a vertex
  EXPECT_EQ(mesh.notCarried, (Sentences{"facets with attribute bytes: 1"}));
}

TEST(WhyNoTriangle, IsSaid) {
  const auto message = [](const std::string& file, MeshFormat format) {
    return parseMesh(file, format).error().message;
  };
  EXPECT_EQ(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\n"
                    "property int z\nelement edge 1\nproperty int a\nend_header\n1 2 3\n0\n",
                    MeshFormat::ply),
            "byte 132: the file ends without a single triangle: it has 1 vertex, 1 of element "
            "edge and no faces");
  EXPECT_EQ(message("v 0 0 0\nv 1 1 1\nl 1 2\np 1\np 2\nsurf x\n", MeshFormat::obj),
            "byte 37: the file ends without a single triangle: it has 2 vertices, 2 points, 1 "
            "line, 1 free-form curve or surface and no face with three corners");
  EXPECT_EQ(message("solid x\nendsolid x\n", MeshFormat::stl),
            "byte 19: the file ends without a single triangle: it has no facets");
}

TEST(WritePly, WritesAttributesThatReadBackExactly) {
  const TemporaryFolder folder;
  const auto path = folder / "a.ply";
  const IndexedMesh mesh = torus(5, 4);
  Colours colours;
  Normals normals;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    colours.push_back({uint8_t(i), uint8_t(2 * i), uint8_t(255 - i), uint8_t(3 * i)});
    normals.push_back({float(i) / 7, 0, -1});
  }
  for (const bool withColours : {false, true}) {
    for (const bool withNormals : {false, true}) {
      PlyVertexAttributes attributes;
      if (withColours) attributes.colours = colours;
      if (withNormals) attributes.normals = normals;
      ASSERT_TRUE(writePly(path, mesh.positions, mesh.triangles, attributes));
      const auto back = readMesh(path).value();
      EXPECT_EQ(back.positions, mesh.positions);
      EXPECT_EQ(back.triangles, mesh.triangles);
      EXPECT_EQ(back.colours, withColours ? colours : Colours());
      EXPECT_EQ(back.normals, withNormals ? normals : Normals());
      EXPECT_TRUE(back.notCarried.empty());
    }
  }
  PlyVertexAttributes tooFew;
  tooFew.colours = std::span(colours).first(3);
  EXPECT_FALSE(writePly(path, mesh.positions, mesh.triangles, tooFew));
}

}  // namespace
}  // namespace meshfront
