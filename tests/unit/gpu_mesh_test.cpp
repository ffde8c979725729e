// Meshes in GPU buffers, changed bit by bit: the same bytes and the same picture as in one piece.
#include "viewer/gl/gpu_mesh.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "shared/camera/camera_spec.h"
#include "tests/unit/drawing_fixture.h"
#include "tests/unit/generated_shapes.h"

namespace meshfront {
namespace {

using testing::GridShape;
using testing::sphereShape;

// A mesh as it should be, with the updates that lead there.
class ChangingMesh {
 public:
  explicit ChangingMesh(const GridShape& shape) : shape_(shape) {
    std::vector<PackedNormal> normals;
    computeVertexNormals(shape.positions, shape.triangles, normals);
    for (size_t v = 0; v < shape.positions.size(); ++v) {
      DrawnVertex vertex;
      vertex.position = vertex.from = shape.positions[v];
      vertex.normal = normals[v];
      vertex.tree = static_cast<uint32_t>(v / 7);
      vertex.level = static_cast<uint8_t>(v % 32);
      vertex.node = static_cast<uint32_t>(3 * v);
      all_.push_back(vertex);
    }
  }

  // The first `vertices` of the sphere and what triangles they make, with `changes` random ones.
  MeshUpdate grownTo(size_t vertices, size_t changes) {
    MeshUpdate update;
    update.changeCount = ++changeCount_;
    const size_t before = vertices_.size();
    update.vertexSlots = vertices;
    vertices_.resize(vertices);
    std::vector<uint32_t> slots(vertices - before);
    std::iota(slots.begin(), slots.end(), static_cast<uint32_t>(before));
    for (size_t i = 0; i < changes && before > 0; ++i)
      slots.push_back(static_cast<uint32_t>(random_() % before));
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (const uint32_t slot : slots) {
      DrawnVertex vertex = all_[slot];
      vertex.depth = static_cast<uint8_t>(random_());
      vertex.colour = {static_cast<uint8_t>(random_()), 100, 100, 255};
      vertices_[slot] = vertex;
      update.vertices.push_back(vertex);
    }
    update.slots = std::move(slots);
    update.faceSlots = shape_.triangles.size() * vertices / all_.size() + 2;
    update.faceSlots = std::min(update.faceSlots, shape_.triangles.size());
    faces_.resize(update.faceSlots);
    for (uint32_t f = 0; f < update.faceSlots; ++f) {
      Triangle corners = shape_.triangles[f];
      if (*std::max_element(corners.begin(), corners.end()) >= vertices || random_() % 50 == 0)
        corners = {};
      if (corners == faces_[f]) continue;
      faces_[f] = corners;
      update.faces.push_back(f);
      update.corners.push_back(corners);
    }
    return update;
  }
  // All of it in one.
  [[nodiscard]] MeshUpdate whole() const {
    MeshUpdate update;
    update.changeCount = changeCount_;
    update.vertexSlots = vertices_.size();
    update.faceSlots = faces_.size();
    update.slots.resize(vertices_.size());
    std::iota(update.slots.begin(), update.slots.end(), 0U);
    update.vertices = vertices_;
    update.faces.resize(faces_.size());
    std::iota(update.faces.begin(), update.faces.end(), 0U);
    update.corners = faces_;
    return update;
  }
  [[nodiscard]] size_t vertexCount() const { return all_.size(); }
  [[nodiscard]] const Quantization& quantization() const { return shape_.quantization; }

 private:
  const GridShape& shape_;
  std::vector<DrawnVertex> all_;
  std::vector<DrawnVertex> vertices_;
  std::vector<Triangle> faces_;
  uint64_t changeCount_ = 0;
  std::mt19937 random_{7};
};

std::vector<uint8_t> bufferBytes(GlName buffer, size_t size) {
  std::vector<uint8_t> bytes(size);
  if (size > 0) glGetNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(size), bytes.data());
  return bytes;
}

// Everything that is drawn of a mesh, births apart.
std::vector<std::vector<uint8_t>> gpuContentsOf(const GpuMesh& mesh) {
  return {bufferBytes(mesh.positionBuffer(), mesh.vertexCount() * kPositionBytes),
          bufferBytes(mesh.restBuffer(), mesh.vertexCount() * kRestBytes),
          bufferBytes(mesh.cornerBuffer(), mesh.triangleCount() * sizeof(Triangle))};
}

class GpuMeshUpdates : public GlTest, public ::testing::WithParamInterface<UpdateUpload::Way> {
 protected:
  [[nodiscard]] static GpuMesh meshFor(const ChangingMesh& changing) {
    return GpuMesh(changing.quantization(), true, GetParam());
  }
  // What came bit by bit is what comes in one piece.
  static void expectWhole(const GpuMesh& mesh, const ChangingMesh& changing) {
    GpuMesh fresh = meshFor(changing);
    ASSERT_TRUE(fresh.apply(changing.whole()));
    EXPECT_EQ(gpuContentsOf(mesh), gpuContentsOf(fresh));
    EXPECT_EQ(mesh.changeCount(), fresh.changeCount());
  }
};

INSTANTIATE_TEST_SUITE_P(BothWays, GpuMeshUpdates,
                         ::testing::Values(UpdateUpload::Way::map, UpdateUpload::Way::scatter),
                         [](const auto& info) {
                           return info.param == UpdateUpload::Way::map ? "mapping" : "scattering";
                         });

TEST_P(GpuMeshUpdates, BitByBitIsTheSameAsInOnePiece) {
  const GridShape shape = sphereShape(5, 0.2);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  auto target = RenderTarget::create({300, 200});
  ASSERT_TRUE(target) << target.error().message;
  auto renderer = MeshRenderer::create();
  ASSERT_TRUE(renderer) << renderer.error().message;
  const Bounds bounds{glm::dvec3(-1.2), glm::dvec3(1.2)};
  const Camera camera = placeCamera(CameraSpec{}, bounds, 1.5);
  for (const double share : {0.02, 0.02, 0.1, 0.5, 0.55, 1.0, 1.0}) {
    const auto vertices = static_cast<size_t>(share * static_cast<double>(changing.vertexCount()));
    const Result<bool> applied = mesh.apply(changing.grownTo(vertices, vertices / 10));
    ASSERT_TRUE(applied) << applied.error().message;
    EXPECT_TRUE(*applied);
    GpuMesh fresh = meshFor(changing);
    ASSERT_TRUE(fresh.apply(changing.whole()));
    ASSERT_EQ(mesh.vertexCount(), vertices);
    EXPECT_EQ(gpuContentsOf(mesh), gpuContentsOf(fresh));
    EXPECT_TRUE(std::ranges::equal(mesh.corners(), fresh.corners()));
    EXPECT_EQ(mesh.changeCount(), fresh.changeCount());
    std::array<Picture, 2> pictures;
    std::array<std::vector<uint32_t>, 2> items;
    for (const size_t i : {0U, 1U}) {
      renderer->draw(*target, i == 0 ? mesh : fresh, camera, bounds, {});
      pictures.at(i) = target->readPicture();
      target->readItems(items.at(i));
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_EQ(items[0], items[1]);
  }
  EXPECT_EQ(mesh.vertexAt(77).node, 3U * 77);
  EXPECT_EQ(mesh.vertexAt(77).position, shape.positions[77]);
}

TEST_P(GpuMeshUpdates, ByteCountIsThatOfTheBuffers) {
  const GridShape shape = sphereShape(4);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  EXPECT_EQ(mesh.byteCount(), 0U);
  for (const size_t vertices : {100U, 101U, 300U, 1000U}) {
    ASSERT_TRUE(mesh.apply(changing.grownTo(vertices, 10)));
    size_t bytes = 0;
    for (const GlName buffer :
         {mesh.positionBuffer(), mesh.restBuffer(), mesh.birthBuffer(), mesh.cornerBuffer()}) {
      GLint64 size = 0;
      glGetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &size);
      bytes += static_cast<size_t>(size);
    }
    const size_t needed = 52 * mesh.vertexCount() + 12 * mesh.triangleCount();
    EXPECT_GE(bytes, needed);
    EXPECT_LE(bytes, needed + needed / 4);
    EXPECT_GE(mesh.byteCount(), bytes);  // and what is kept for uploading
  }
}

TEST_P(GpuMeshUpdates, AReservedMeshNeverGrows) {
  const GridShape shape = sphereShape(4);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  ASSERT_TRUE(mesh.reserve(changing.vertexCount(), shape.triangles.size()));
  const GlName before = mesh.positionBuffer();
  ASSERT_TRUE(mesh.apply(changing.grownTo(300, 0)));
  ASSERT_TRUE(mesh.apply(changing.grownTo(changing.vertexCount(), 0)));
  EXPECT_EQ(mesh.positionBuffer(), before);
  expectWhole(mesh, changing);
}

TEST_P(GpuMeshUpdates, SlicesShowTheMeshBeforeUntilAllIsThere) {
  const GridShape shape = sphereShape(5);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  ASSERT_TRUE(mesh.apply(changing.grownTo(500, 0)));
  const auto before = gpuContentsOf(mesh);
  const MeshUpdate update = changing.grownTo(2000, 100);
  constexpr size_t kSlice = 10'000;
  size_t calls = 1;
  Result<bool> changed = mesh.apply(update, 0, kSlice);
  for (; changed && !*changed && calls < 1000; ++calls) {
    EXPECT_TRUE(mesh.isPending());
    EXPECT_EQ(gpuContentsOf(mesh), before);
    EXPECT_EQ(mesh.vertexCount(), 500U);
    changed = mesh.advance(0, kSlice);
  }
  ASSERT_TRUE(changed);
  if (GetParam() == UpdateUpload::Way::scatter) {
    EXPECT_GE(calls, update.byteCount() / kSlice);
    EXPECT_LE(calls, update.byteCount() / kSlice + 2);
  }
  EXPECT_FALSE(mesh.isPending());
  expectWhole(mesh, changing);
}

TEST_P(GpuMeshUpdates, UpdatesQueueUpBehindALargeOne) {
  const GridShape shape = sphereShape(5);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  for (const size_t vertices : {1000U, 1500U, 1500U, 3000U})
    ASSERT_TRUE(mesh.apply(changing.grownTo(vertices, 50), 0, 5'000));
  size_t calls = 0;
  while (mesh.isPending() && calls < 1000) {
    ASSERT_TRUE(mesh.advance(0, 5'000));
    ++calls;
  }
  expectWhole(mesh, changing);
}

TEST_P(GpuMeshUpdates, WhatIsOutOfRangeIsRefusedAndChangesNothing) {
  const GridShape shape = sphereShape(3);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  ASSERT_TRUE(mesh.apply(changing.grownTo(200, 0)));
  const auto before = gpuContentsOf(mesh);
  const MeshUpdate good = changing.grownTo(250, 20);
  ASSERT_GT(good.slots.size(), 20U);
  ASSERT_GT(good.faces.size(), 20U);
  std::vector<MeshUpdate> bad(9, good);
  bad[0].slots.back() = 250;
  bad[1].slots[3] = bad[1].slots[4];
  bad[2].faces.back() = static_cast<uint32_t>(good.faceSlots);
  bad[3].corners[7][1] = 250;
  bad[4].vertices.pop_back();
  bad[5].corners.pop_back();
  bad[6].vertexSlots = 199;
  bad[7].born = {12, 250};
  bad[8].born = {12, 11};
  for (const MeshUpdate& update : bad) {
    const Result<bool> applied = mesh.apply(update);
    ASSERT_FALSE(applied);
    EXPECT_FALSE(applied.error().message.empty());
    EXPECT_FALSE(mesh.isPending());
    EXPECT_EQ(gpuContentsOf(mesh), before);
  }
  EXPECT_TRUE(mesh.apply(good));
}

TEST_P(GpuMeshUpdates, AnEmptyUpdateIsOne) {
  const GridShape shape = sphereShape(2);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  MeshUpdate nothing;
  nothing.changeCount = 4;
  EXPECT_TRUE(mesh.apply(nothing).value());
  EXPECT_EQ(mesh.changeCount(), 4U);
  EXPECT_EQ(mesh.vertexCount(), 0U);
  ASSERT_TRUE(mesh.apply(changing.grownTo(30, 0)));
  nothing.vertexSlots = 40;
  nothing.faceSlots = mesh.triangleCount() + 3;
  nothing.changeCount = 9;
  EXPECT_TRUE(mesh.apply(nothing).value());
  EXPECT_EQ(mesh.vertexCount(), 40U);
  EXPECT_EQ(mesh.vertexAt(39), DrawnVertex{.colour = {}});
}

TEST_P(GpuMeshUpdates, BuffersLargerThanAShaderMaySeeAreWrittenWindowByWindow) {
  constexpr size_t kSlots = 20'000;
  const SlotAccess access = UpdateUpload(GetParam()).access();
  UpdateUpload upload(GetParam(), 16'384);
  SlotBuffer positions(kPositionBytes, 0, access);
  SlotBuffer rest(kRestBytes, 0, access);
  SlotBuffer births(sizeof(float), 0, access);
  SlotBuffer corners(sizeof(Triangle), 0, access);
  for (SlotBuffer* buffer : {&positions, &rest, &births, &corners})
    ASSERT_TRUE(buffer->hold(kSlots));
  MeshUpdate update;
  update.vertexSlots = update.faceSlots = kSlots;
  std::mt19937 random(3);
  std::vector<std::array<uint32_t, 3>> expected(kSlots);
  for (uint32_t slot = 0; slot < kSlots; slot += slot < 9000 ? 1 + random() % 4 : random() % 900) {
    if (!update.slots.empty() && slot == update.slots.back()) ++slot;
    DrawnVertex vertex;
    vertex.position = {static_cast<int32_t>(slot), 5, 6};
    vertex.node = slot;
    update.slots.push_back(slot);
    update.vertices.push_back(vertex);
    update.faces.push_back(slot);
    update.corners.push_back({slot, 5, 6});
    update.born.push_back(slot);
    expected[slot] = {slot, 5, 6};
  }
  ASSERT_TRUE(upload.send(update, SIZE_MAX).value());
  ASSERT_TRUE(upload.commit(update, 2.5F, {positions, rest, births, corners}));
  std::vector<std::array<uint32_t, 3>> held(kSlots);
  for (const SlotBuffer* buffer : {&positions, &corners}) {
    glGetNamedBufferSubData(buffer->name(), 0, kSlots * 12, held.data());
    EXPECT_EQ(held, expected);
  }
  std::vector<std::array<uint32_t, 9>> heldRest(kSlots);
  std::vector<float> heldBirths(kSlots);
  glGetNamedBufferSubData(rest.name(), 0, kSlots * kRestBytes, heldRest.data());
  glGetNamedBufferSubData(births.name(), 0, kSlots * sizeof(float), heldBirths.data());
  for (size_t slot = 0; slot < kSlots; ++slot) {
    EXPECT_EQ(heldRest[slot][8], expected[slot][0]);
    EXPECT_EQ(heldBirths[slot], expected[slot][1] == 0 ? 0 : 2.5F);
  }
}

TEST_P(GpuMeshUpdates, TellsOfTranslucentColoursAndBirths) {
  const GridShape shape = sphereShape(2);
  ChangingMesh changing(shape);
  GpuMesh mesh = meshFor(changing);
  ASSERT_TRUE(mesh.apply(changing.grownTo(30, 0), 5));
  EXPECT_FALSE(mesh.isTranslucent());
  EXPECT_LT(mesh.lastBirth(), 0);
  MeshUpdate update = changing.grownTo(40, 0);
  update.vertices[2].colour[3] = 254;
  update.born = {33, 35};
  ASSERT_TRUE(mesh.apply(update, 6.5));
  EXPECT_TRUE(mesh.isTranslucent());
  EXPECT_EQ(mesh.lastBirth(), 6.5);
  std::vector<float> births(40);
  glGetNamedBufferSubData(mesh.birthBuffer(), 0, 160, births.data());
  for (size_t v = 0; v < births.size(); ++v) {
    if (v == 33 || v == 35) {
      EXPECT_EQ(births[v], 1.5F);  // since the epoch
    } else {
      EXPECT_LT(births[v], -1e9F);
    }
  }
}

}  // namespace
}  // namespace meshfront
