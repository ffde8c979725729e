#include "shared/mesh_files/mesh_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "shared/mesh/weld_positions.h"
#include "tests/data/mesh_shapes.h"

namespace meshfront {
namespace {

using Positions = std::vector<std::array<double, 3>>;
using Triangles = std::vector<Triangle>;

const Positions kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
const Triangles kSquareFan = {{0, 1, 2}, {0, 2, 3}};

void expectMesh(const std::string& file, MeshFormat format, const Positions& positions,
                const Triangles& triangles) {
  const auto mesh = parseMesh(file, format);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions, positions);
  EXPECT_EQ(mesh->triangles, triangles);
}

void expectError(const std::string& file, MeshFormat format, const std::string& message) {
  const auto mesh = parseMesh(file, format);
  ASSERT_FALSE(mesh) << "expected: " << message;
  EXPECT_EQ(mesh.error().message, message);
}

// No prefix of the file may crash; what it gives must be a mesh whose indices are good.
size_t countErrorsOfPrefixes(const std::string& file, MeshFormat format) {
  size_t errors = 0;
  for (size_t length = 0; length < file.size(); ++length) {
    // A copy of its own, so that the address sanitizer sees a read behind its end.
    const std::vector<char> prefix(file.begin(), file.begin() + static_cast<ptrdiff_t>(length));
    const auto mesh = parseMesh({prefix.data(), prefix.size()}, format);
    if (!mesh) {
      ++errors;
      EXPECT_NE(mesh.error().message, "");
      continue;
    }
    for (const Triangle& t : mesh->triangles)
      for (const uint32_t corner : t) EXPECT_LT(corner, mesh->positions.size());
  }
  return errors;
}

template <typename T>
void put(std::string& file, T value, bool bigEndian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (bigEndian) bytes.assign(bytes.rbegin(), bytes.rend());
  file += bytes;
}

// The square with a property of every scalar type, a list in front of the coordinates, an element
// between, and faces with colours.
std::string binaryPly(bool bigEndian, const char* lineEnd = "\n") {
  std::string file;
  for (const char* line :
       {"ply", bigEndian ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0",
        "comment a square", "obj_info nothing", "element vertex 4",
        "property list uchar short tags", "property double z", "property uchar red",
        "property float x", "property int16 y", "element note 2", "property uint a",
        "property list ushort double b", "element face 1",
        "property list int8 uint32 vertex_indices", "property float32 quality", "end_header"}) {
    file += std::string(line) + lineEnd;
  }
  for (size_t i = 0; i < 4; ++i) {
    put(file, static_cast<uint8_t>(i));
    for (size_t tag = 0; tag < i; ++tag) put(file, int16_t{-1}, bigEndian);
    put(file, kSquare[i][2], bigEndian);
    put(file, uint8_t{200});
    put(file, static_cast<float>(kSquare[i][0]), bigEndian);
    put(file, static_cast<int16_t>(kSquare[i][1]), bigEndian);
  }
  for (size_t i = 0; i < 2; ++i) {
    put(file, uint32_t{7}, bigEndian);
    put(file, uint16_t{1}, bigEndian);
    put(file, std::numeric_limits<double>::quiet_NaN(), bigEndian);
  }
  put(file, int8_t{4});
  for (uint32_t i = 0; i < 4; ++i) put(file, i, bigEndian);
  put(file, 0.5F, bigEndian);
  return file;
}

std::string asciiPly(const std::string& vertices, const std::string& faces, size_t vertexCount = 4,
                     size_t faceCount = 1) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertexCount) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(faceCount) + "\nproperty list uchar int vertex_index\nend_header\n" +
         vertices + faces;
}
const std::string kSquareVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 .5\n";

std::string binaryStl(const std::string& header, const Positions& corners, uint32_t count) {
  std::string file = header;
  file.resize(80, ' ');
  put(file, count);
  for (size_t i = 0; i < corners.size(); ++i) {
    if (i % 3 == 0)
      for (size_t axis = 0; axis < 3; ++axis) put(file, std::numeric_limits<float>::quiet_NaN());
    for (const double coordinate : corners[i]) put(file, static_cast<float>(coordinate));
    if (i % 3 == 2) put(file, uint16_t{1});
  }
  return file;
}
const Positions kSquareCorners = {{0, 0, 0},    {1, 0, 0}, {1, 1, 0},
                                  {-0.0, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};

TEST(Ply, ReadsAscii) {
  expectMesh(asciiPly(kSquareVertices, "4 0 1 2 3\n"), MeshFormat::ply, kSquare, kSquareFan);
  // No line end behind the last number; a plus sign; exponents; whole numbers written as reals.
  expectMesh(asciiPly("+0 -0e7 0.0\n1e0 0 0 1 1 0\n0\n1 5E-1\n", "4.0 0 1.0 2 3"), MeshFormat::ply,
             kSquare, kSquareFan);
}

TEST(Ply, KeepsTheWholePrecisionOfAsciiNumbers) {
  const auto mesh =
      parseMesh(asciiPly("0.1 1e-400 -1.7976931348623157e308\n1 0 0\n0 1 0\n", "3 0 1 2\n", 3),
                MeshFormat::ply);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions[0][0], 0.1);
  EXPECT_EQ(mesh->positions[0][1], 0);
  EXPECT_EQ(mesh->positions[0][2], -std::numeric_limits<double>::max());
}

TEST(Ply, ReadsBinaryOfBothByteOrdersAndAllLineEnds) {
  for (const bool bigEndian : {false, true})
    for (const char* lineEnd : {"\n", "\r\n", "\r"})
      expectMesh(binaryPly(bigEndian, lineEnd), MeshFormat::ply, kSquare, kSquareFan);
}

TEST(Ply, ReadsTriangleStrips) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 2\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0\n";
  const auto mesh = parseMesh(head + "9 0 1 2 3 4 -1 3 5 4\n5 0 1 1 2 3\n", MeshFormat::ply);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const Triangles expected = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {3, 5, 4}, {1, 2, 3}};
  EXPECT_EQ(mesh->triangles, expected);
  expectError(head + "3 0 1 6\n0\n", MeshFormat::ply,
              "line 11: vertex index 6 is out of range, there are 6 vertices");
  expectError(head + "3 0 1 -2\n0\n", MeshFormat::ply,
              "line 11: vertex index -2 is out of range, there are 6 vertices");
}

TEST(Ply, ReadsFacesInFrontOfVerticesAndManyRestarts) {
  std::string file =
      "ply\nformat binary_little_endian 1.0\nelement tristrips 1\n"
      "property list uchar uint vertex_indices\nelement vertex 3\nproperty char x\n"
      "property uchar y\nproperty ushort z\nend_header\n";
  put(file, uint8_t{6});
  for (const uint32_t index : {UINT32_MAX, 0U, 1U, 2U, UINT32_MAX, UINT32_MAX}) put(file, index);
  for (const int8_t x : {-1, 0, 1}) {
    put(file, x);
    put(file, static_cast<uint8_t>(255));
    put(file, uint16_t{65535});
  }
  expectMesh(file, MeshFormat::ply, {{-1, 255, 65535}, {0, 255, 65535}, {1, 255, 65535}},
             {{0, 1, 2}});
}

TEST(Ply, NamesTheLineOfWhatIsWrong) {
  const auto ply = MeshFormat::ply;
  expectError("", ply, "line 1: a PLY file starts with the line 'ply'");
  expectError("plyx\n", ply, "line 1: a PLY file starts with the line 'ply'");
  expectError("ply\nformat ascii 1.0\n", ply, "line 3: the file ends within the PLY header");
  expectError("ply\nformat ascii 2.0\n", ply, "line 2: not a PLY format of version 1.0");
  expectError("ply\nend_header\n", ply, "line 2: the header names no format");
  expectError("ply\nproperty int x\n", ply, "line 2: a property before the first element");
  expectError("ply\nelement vertex -1\n", ply, "line 2: the element's count is no count");
  expectError("ply\nelement a 1\nproperty int65 x\n", ply, "line 3: unknown property type");
  expectError("ply\nformat ascii 1.0\nend_header\n", ply,
              "line 1: the PLY header has no element vertex");
  expectError(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\nproperty int y\nproperty int z\n"
      "end_header\n1 2 3\n",
      ply, "line 8: the file ends early, it promises 3 rows of element vertex");
  expectError("ply\nformat ascii 1.0\nelement vertex 99\nend_header\n", ply,
              "line 3: element vertex lacks one of x, y and z");
  expectError("ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 2\nend_header\n", ply,
              "line 4: a second element vertex");
  expectError(asciiPly(kSquareVertices, "3 0 1 4\n"), ply,
              "line 14: vertex index 4 is out of range, there are 4 vertices");
  expectError(asciiPly("0 0 0\n1 nan 0\n1 1 0\n0 1 0\n", "3 0 1 2\n"), ply,
              "line 11: 'nan' is no finite number");
  expectError(asciiPly("0 0 0\n1 0 inf\n1 1 0\n0 1 0\n", "3 0 1 2\n"), ply,
              "line 11: 'inf' is no finite number");
  expectError(asciiPly("0 0 0\n1 0 1e999\n1 1 0\n0 1 0\n", "3 0 1 2\n"), ply,
              "line 11: '1e999' is no finite number");
  expectError(asciiPly(kSquareVertices, "3 0 1 \n"), ply, "line 15: the file ends early");
  expectError(asciiPly(kSquareVertices, "3 0 1.5 2\n"), ply, "line 14: '1.5' is no whole number");
  expectError(asciiPly(kSquareVertices, "-3 0 1 2\n"), ply, "line 14: a list of negative length");
  expectError(
      asciiPly(kSquareVertices, "2 0 1\n"), ply,
      "byte 183: the file ends without a single triangle: it has 4 vertices, 1 of element face, "
      "none with three corners");
}

TEST(Ply, NamesTheByteOfWhatIsWrong) {
  std::string file = binaryPly(false);
  const size_t body = file.find("end_header\n") + 11;
  const double nan = std::numeric_limits<double>::infinity();
  std::memcpy(file.data() + body + 1, &nan, sizeof nan);
  expectError(file, MeshFormat::ply,
              "byte " + std::to_string(body + 1) + ": not a number that can stand here");
  file = binaryPly(false);
  file[file.size() - 8] = 9;  // the last corner
  expectError(file, MeshFormat::ply,
              "byte " + std::to_string(file.size() - 8) +
                  ": vertex index 9 is out of range, there are 4 vertices");
}

TEST(Ply, RefusesCountsBeyondTheFile) {
  for (const char* count : {"5", "4294967296", "18446744073709551615"}) {
    std::string file = binaryPly(false);
    file.replace(file.find("vertex 4") + 7, 1, count);
    EXPECT_FALSE(parseMesh(file, MeshFormat::ply)) << count;
    file = binaryPly(false);
    file.replace(file.find("face 1") + 5, 1, count);
    EXPECT_FALSE(parseMesh(file, MeshFormat::ply)) << count;
    // An element without properties takes no bytes: any number of them ends at once.
    file = binaryPly(false);
    file.insert(file.find("element note"), std::string("element nothing ") + count + "\n");
    expectMesh(file, MeshFormat::ply, kSquare, kSquareFan);
  }
}

TEST(Ply, SurvivesEveryTruncationAndEveryChangedByte) {
  for (const bool bigEndian : {false, true}) {
    const std::string file = binaryPly(bigEndian);
    EXPECT_EQ(countErrorsOfPrefixes(file, MeshFormat::ply), file.size());
    for (size_t i = 0; i < file.size(); ++i) {
      for (const int flip : {1, 0x80, 0xff}) {
        std::string changed = file;
        changed[i] = static_cast<char>(changed[i] ^ flip);
        const auto mesh = parseMesh(changed, MeshFormat::ply);
        if (!mesh) continue;
        for (const Triangle& t : mesh->triangles)
          for (const uint32_t corner : t) EXPECT_LT(corner, mesh->positions.size());
      }
    }
  }
  const std::string ascii = asciiPly(kSquareVertices, "4 0 1 2 3\n");
  EXPECT_EQ(countErrorsOfPrefixes(ascii, MeshFormat::ply), ascii.size() - 1);  // the last line end
}

TEST(Obj, ReadsFacesOfAllForms) {
  const std::string vertices =
      "# a square\r\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1.0\n\tv  1 1 0 0.5 0.5 0.5\nv 0 1 5e-1\r\nvt "
      "0 0\n"
      "vn 0 0 1\no name\ng one two\nusemtl x\ns off\n";
  for (const char* faces :
       {"f 1 2 3 4", "f 1/1 2/1 3/1 4/1\n", "f 1//1 2//1 3//1 4//1 # comment\n",
        "f 1/1/1 2/1/1 3/1/1 4/1/1\r\n", "f -4 -3 -2 -1\n", "f 1 2 \\\n3 \\\r\n 4\n",
        "f 1 2\\\n 3 4\n", "f 1 2 3\ng other\nf 1 3 4\nf 1 2\nl 1 2\np 1\n",
        "f 1 2 3\nf -4 3 -1\n"})
    expectMesh(vertices + faces, MeshFormat::obj, kSquare, kSquareFan);
}

TEST(Obj, CountsNegativeIndicesFromTheFace) {
  expectMesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 .5\nf -4 -2 -1\n", MeshFormat::obj,
             kSquare, kSquareFan);
  // Positive ones may point ahead.
  expectMesh("f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\n", MeshFormat::obj, kSquare,
             kSquareFan);
}

TEST(Obj, NamesTheLineOfWhatIsWrong) {
  const auto obj = MeshFormat::obj;
  const std::string three = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  expectError("v 0 0\n", obj, "line 1: the line ends where a finite number belongs");
  expectError("v 0 0", obj, "line 1: the file ends early");
  expectError("v 0 0 nan\n", obj, "line 1: 'nan' is no finite number");
  expectError(three + "f 1 2 4\nv 1 1\n", obj,
              "line 5: the line ends where a finite number belongs");
  expectError(three + "f 1 2 4\nf 1 2 3\n", obj,
              "line 4: vertex index 4 is out of range, there are 3 vertices");
  expectError(three + "f 1 2 0\n", obj,
              "line 4: vertex index 0 is out of range, there are 3 vertices so far");
  expectError(three + "f -4 2 1\n", obj,
              "line 4: vertex index -4 is out of range, there are 3 vertices so far");
  expectError(three + "f 1 2 99999999999\n", obj,
              "line 4: vertex index 99999999999 is out of range, there are 3 vertices so far");
  expectError(three + "f 1 2 x\n", obj, "line 4: 'x' is no vertex index");
  expectError(three + "f 1 2 3x\n", obj, "line 4: broken vertex index");
  expectError(
      three + "f 1 2\n", obj,
      "byte 30: the file ends without a single triangle: it has 3 vertices and no face with "
      "three corners");
  expectError("", obj,
              "byte 0: the file ends without a single triangle: it has 0 vertices and no face with "
              "three corners");
}

TEST(Stl, ReadsBinaryAndWelds) {
  for (const char* header : {"a square", "solid misleads many readers"})
    expectMesh(binaryStl(header, kSquareCorners, 2), MeshFormat::stl, kSquare, kSquareFan);
}

TEST(Stl, ReadsBinaryWithMoreBehindItsTriangles) {
  for (const char* header : {"a square", "solid misleads many readers"})
    expectMesh(binaryStl(header, kSquareCorners, 2) + "more", MeshFormat::stl, kSquare, kSquareFan);
}

TEST(Stl, ReadsAsciiAndWelds) {
  const std::string file =
      "solid a name of words\n"
      " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n"
      "  endloop\n endfacet\n"
      " facet normal nan nan nan\n  outer loop\n   vertex -0.0 0 0\n   vertex 1e0 1 0\n"
      "   vertex 0 1 .5\n  endloop\n endfacet\nendsolid a name\n";
  expectMesh(file, MeshFormat::stl, kSquare, kSquareFan);
  // Every prefix that cuts into the keyword endsolid or earlier.
  EXPECT_GE(countErrorsOfPrefixes(file, MeshFormat::stl), file.size() - 8);
}

TEST(Stl, SurvivesEveryTruncation) {
  for (const char* header : {"a square", "solid"}) {
    const std::string file = binaryStl(header, kSquareCorners, 2);
    EXPECT_EQ(countErrorsOfPrefixes(file, MeshFormat::stl), file.size());
  }
}

TEST(Stl, NamesThePlaceOfWhatIsWrong) {
  const auto stl = MeshFormat::stl;
  expectError(binaryStl("", kSquareCorners, UINT32_MAX), stl,
              "byte 184: the file ends early, it promises 4294967295 triangles");
  expectError(binaryStl("", {}, 0), stl,
              "byte 84: the file ends without a single triangle: it has no facets");
  auto corners = kSquareCorners;
  corners[4][1] = std::numeric_limits<double>::infinity();
  expectError(binaryStl("", corners, 2), stl, "byte 162: a coordinate that is not finite");
  expectError("short", stl, "byte 5: the file ends within the STL header");
  expectError("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", stl,
              "line 6: a facet with fewer than three vertices");
  expectError("solid\nvertex 0 0 x\n", stl, "line 2: 'x' is no finite number");
  expectError("solid\nfacet\n", stl, "line 3: the file ends early");
}

TEST(Off, ReadsAllKeywordsColumnsAndComments) {
  const std::string vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 .5\n";
  const std::string rest = "4 2 0\n" + vertices + "3 0 1 2\n3 0 2 3\n";
  for (const char* keyword : {"OFF\n", "# hello\n\nOFF # there\n", "OFF ", ""})
    expectMesh(keyword + rest, MeshFormat::off, kSquare, kSquareFan);
  expectMesh("OFF 4 1\n# vertices\n" + vertices + "# a face\n4 0 1 2 3 # red\n", MeshFormat::off,
             kSquare, kSquareFan);
  expectMesh(
      "COFF\n4 1 4\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n\n1 1 0 255 0 0 255\n0 1 .5 1 0 0 1\n"
      "4 0 1 2 3 0.5 0.5 0.5\n",
      MeshFormat::off, kSquare, kSquareFan);
  expectMesh(
      "STCNOFF\n4 2 4\n0 0 0 0 0 1 9 9 9 9 0 0\n1 0 0 0 0 1 9 9 9 9 0 0\n1 1 0 0 0 1 9 9 9 9 0 0\n"
      "0 1 .5 0 0 1 9 9 9 9 0 0\n3 0 1 2 7\n3 0 2 3",
      MeshFormat::off, kSquare, kSquareFan);
}

TEST(Off, NamesTheLineOfWhatIsWrong) {
  const auto off = MeshFormat::off;
  expectError("4OFF\n", off,
              "line 1: only OFF with three coordinates is read (OFF, COFF, NOFF, STOFF)");
  expectError("OFF BINARY\n", off, "byte 11: the file ends early");
  expectError("OFF\n3 -1 0\n", off, "line 2: '-1' is no count");
  expectError("OFF\n3 1 0\n0 0 0\n1 0 0\n", off,
              "line 5: the file ends early, it promises 3 vertices and 1 faces");
  expectError("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", off,
              "line 6: vertex index 3 is out of range, there are 3 vertices");
  expectError("OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", off,
              "line 4: 'inf' is no finite number");
  expectError(
      "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", off,
      "byte 28: the file ends without a single triangle: it has 3 vertices and no face with "
      "three corners");
  expectError("OFF\n9000000000000000000 1 0\n0 0 0\n", off,
              "line 4: the file ends early, it promises 9000000000000000000 vertices and 1 faces");
  countErrorsOfPrefixes("COFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n", off);
}

class MeshFilesOnDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("mesh-files-test-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path put(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

TEST_F(MeshFilesOnDisk, ChoosesTheFormatByExtensionThenContent) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1 2 3 4\n";
  const std::string off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 .5\n4 0 1 2 3\n";
  const std::string stl = binaryStl("solid", kSquareCorners, 2);
  const std::string ply = binaryPly(true);
  for (const auto& [name, content] :
       std::vector<std::pair<std::string, std::string>>{{"a.obj", obj},
                                                        {"a.OFF", off},
                                                        {"a.Stl", stl},
                                                        {"a.ply", ply},
                                                        {"obj", "# x\n" + obj},
                                                        {"off.txt", off},
                                                        {"stl", stl},
                                                        {"ply.mesh", ply}}) {
    const auto mesh = readMesh(put(name, content));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->positions, kSquare) << name;
    EXPECT_EQ(mesh->triangles, kSquareFan) << name;
  }
}

TEST_F(MeshFilesOnDisk, NamesTheFileInErrors) {
  const auto missing = readMesh(folder_ / "none.ply");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::notFound);
  EXPECT_NE(missing.error().message.find("none.ply: cannot open"), std::string::npos);
  EXPECT_EQ(readMesh(folder_).error().code, ErrorCode::unavailable);
  const auto path = put("bad.obj", "v 1 2 x\n");
  EXPECT_EQ(readMesh(path).error().message, path.string() + ": line 1: 'x' is no finite number");
  const auto unknown = put("a.txt", "hello");
  EXPECT_EQ(readMesh(unknown).error().message,
            unknown.string() +
                ": byte 0: not a mesh file; PLY, OBJ, STL, OFF and glTF are "
                "read (extension or content)");
}

TEST_F(MeshFilesOnDisk, WritesPlyThatReadsBackExactly) {
  const IndexedMesh mesh = torus(9, 5);
  const auto path = folder_ / "torus.ply";
  ASSERT_TRUE(writePly(path, mesh.positions, mesh.triangles));
  const auto back = readMesh(path);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->positions, mesh.positions);
  EXPECT_EQ(back->triangles, mesh.triangles);
  ASSERT_TRUE(writePly(path, kSquare, kSquareFan));  // over the old one
  EXPECT_EQ(readMesh(path)->positions, kSquare);
  // Nothing else is left behind.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(MeshFilesOnDisk, WritesTheseBytes) {
  const auto path = folder_ / "one.ply";
  ASSERT_TRUE(writePly(path, Positions{{1, 0, -2}}, Triangles{{0, 0, 0}}));
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  using namespace std::string_literals;
  EXPECT_EQ(bytes,
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\n"
            "property double y\nproperty double z\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n"
            "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xc0"
            "\3\0\0\0\0\0\0\0\0\0\0\0\0"s);
}

TEST_F(MeshFilesOnDisk, WritesNothingWhenItFails) {
  EXPECT_FALSE(writePly(folder_ / "a.ply", kSquare, Triangles{{0, 1, 4}}));
  const auto result = writePly(folder_ / "none" / "a.ply", kSquare, kSquareFan);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::notFound);
  std::filesystem::create_directory(folder_ / "taken.ply");
  EXPECT_FALSE(writePly(folder_ / "taken.ply", kSquare, kSquareFan));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST(WeldPositions, KeepsTheOrderOfFirstOccurrence) {
  const Positions positions = {{3, 0, 0}, {1, 0, 0}, {3, 0, -0.0}, {1, 0, 1e-300}, {1, 0, 0}};
  const auto welded = weldPositions(positions);
  EXPECT_EQ(welded.positions, (Positions{{3, 0, 0}, {1, 0, 0}, {1, 0, 1e-300}}));
  EXPECT_EQ(welded.indexOf, (std::vector<uint32_t>{0, 1, 0, 2, 1}));
  EXPECT_TRUE(weldPositions({}).indexOf.empty());
}

}  // namespace
}  // namespace meshfront
