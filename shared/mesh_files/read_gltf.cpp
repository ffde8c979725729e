// glTF 2.0 (Khronos, ISO/IEC 12113), .gltf and .glb: the triangles of all shown meshes, in world
// coordinates. Vertices stay as the file's accessors have them; seams close when equal positions
// are welded.
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "shared/mesh_files/attribute_mending.h"
#include "shared/mesh_files/available_memory.h"
#include "shared/mesh_files/gltf_buffers.h"
#include "shared/mesh_files/gltf_instances.h"
#include "shared/mesh_files/gltf_model.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/polygon_triangles.h"

namespace meshfront {
namespace {

constexpr uint64_t kTriangles = 4;
constexpr uint64_t kStrip = 5;
constexpr uint64_t kFan = 6;
constexpr uint64_t kVertexBytes = sizeof(std::array<double, 3>) + sizeof(Colour) + 12;

bool hasTriangles(const GltfPrimitive& primitive) {
  return primitive.mode >= kTriangles && primitive.position;
}

// Primitives of a mesh often share their vertices.
using VertexKey = std::array<uint32_t, 3>;
VertexKey vertexKeyOf(const GltfPrimitive& primitive) {
  return {*primitive.position, primitive.normal.value_or(UINT32_MAX),
          primitive.colour.value_or(UINT32_MAX)};
}

double fullChannel(const GltfValues& colours) {
  return colours.type() == GltfComponent::uint8    ? UINT8_MAX
         : colours.type() == GltfComponent::uint16 ? UINT16_MAX
                                                   : 1;
}

class GltfReader {
 public:
  GltfReader(std::string_view file, const GltfModel& model, std::optional<std::string_view> binary,
             std::optional<std::filesystem::path> folder)
      : file_(file), model_(model), buffers_(model, binary, std::move(folder)) {}

  Result<IndexedMesh> read() {
    const auto instances = shownMeshes(model_);
    if (!instances) return tl::unexpected(instances.error());
    std::set<uint32_t> shown;
    for (const GltfInstance& instance : *instances) shown.insert(instance.mesh);
    if (auto fits = checkSize(*instances); !fits) return tl::unexpected(fits.error());
    for (const GltfInstance& instance : *instances)
      if (auto done = append(instance); !done) return tl::unexpected(done.error());
    if (mesh_.triangles.empty()) return noTriangles(file_, whatThereIs(shown));
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.positions.size(), kNoColour);
    if (!mesh_.normals.empty()) mesh_.normals.resize(mesh_.positions.size());
    mending_.report(mesh_);
    sayWhatIsNotCarried(shown);
    return std::move(mesh_);
  }

 private:
  static std::string placeOf(uint32_t mesh, size_t primitive) {
    return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]: ";
  }

  // Instances multiply what a small file holds, so the whole is counted before any of it is made.
  Result<void> checkSize(const std::vector<GltfInstance>& instances) const {
    struct Size {
      double vertices = 0;
      double corners = 0;
    };
    std::vector<std::optional<Size>> sizes(model_.meshes.size());
    Size sum;
    for (const GltfInstance& instance : instances) {
      auto& size = sizes[instance.mesh];
      if (!size) {
        size.emplace();
        std::set<VertexKey> counted;
        for (const GltfPrimitive& primitive : model_.meshes[instance.mesh].primitives) {
          if (!hasTriangles(primitive)) continue;
          const auto vertices = double(model_.accessors[*primitive.position].count);
          if (counted.insert(vertexKeyOf(primitive)).second) size->vertices += vertices;
          const double corners =
              primitive.indices ? double(model_.accessors[*primitive.indices].count) : vertices;
          size->corners += primitive.mode == kTriangles ? corners : 3 * corners;
        }
      }
      sum.vertices += size->vertices;
      sum.corners += size->corners;
    }
    if (sum.vertices > double{kMaxFileVertices})
      return fail(ErrorCode::tooLarge, "the scene has more than 2^31 - 1 vertices");
    const double bytes = sum.vertices * kVertexBytes + sum.corners * sizeof(uint32_t);
    if (bytes > double(availableMemory().bytes))
      return fail(ErrorCode::tooLarge, "the scene with all its instances takes " +
                                           std::to_string(uint64_t(bytes / 1048576)) +
                                           " MiB, more than there is memory");
    return {};
  }

  Result<void> append(const GltfInstance& instance) {
    std::map<VertexKey, uint32_t> firstVertices;
    const auto& primitives = model_.meshes[instance.mesh].primitives;
    for (size_t i = 0; i < primitives.size(); ++i) {
      if (!hasTriangles(primitives[i])) continue;
      const std::string place = placeOf(instance.mesh, i);
      if (!primitives[i].compressedBy.empty() &&
          !model_.accessors[*primitives[i].position].bufferView)
        return fail(place + "compressed by the extension " + primitives[i].compressedBy +
                    ", which is not read; save the mesh without it");
      const auto [first, isNew] = firstVertices.try_emplace(
          vertexKeyOf(primitives[i]), static_cast<uint32_t>(mesh_.positions.size()));
      Result<void> done;
      if (isNew) done = appendVertices(primitives[i], instance);
      if (done) done = appendTriangles(primitives[i], first->second, instance);
      if (!done) return fail(done.error().code, place + done.error().message);
    }
    return {};
  }

  Result<GltfValues> attribute(uint32_t accessor, const char* name, uint64_t count, unsigned fewest,
                               unsigned most) {
    auto values = buffers_.open(accessor);
    if (!values) return values;
    if (values->components() < fewest || values->components() > most)
      return fail("accessors[" + std::to_string(accessor) + "]: of a type that " + name +
                  " cannot have");
    if (values->count() != count)
      return fail("accessors[" + std::to_string(accessor) +
                  "]: " + std::to_string(values->count()) + " elements for " +
                  std::to_string(count) + " vertices");
    return values;
  }

  Result<void> appendVertices(const GltfPrimitive& primitive, const GltfInstance& instance) {
    const uint64_t count = model_.accessors[*primitive.position].count;
    const auto positions = attribute(*primitive.position, "POSITION", count, 3, 3);
    if (!positions) return tl::unexpected(positions.error());
    const size_t before = mesh_.positions.size();
    for (uint64_t i = 0; i < count; ++i) {
      const std::array<double, 3> stored = {positions->at(i, 0), positions->at(i, 1),
                                            positions->at(i, 2)};
      const auto p = transformed(instance.toWorld, stored);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        return fail("accessors[" + std::to_string(*primitive.position) + "]: element " +
                    std::to_string(i) + " is not finite at nodes[" + std::to_string(instance.node) +
                    "]");
      mesh_.positions.push_back(p);
    }
    if (primitive.normal) {
      const auto normals = attribute(*primitive.normal, "NORMAL", count, 3, 3);
      if (!normals) return tl::unexpected(normals.error());
      mesh_.normals.resize(before);
      const bool turned = !std::equal(instance.toWorld.begin(), instance.toWorld.begin() + 9,
                                      GltfNode().transform.begin());
      for (uint64_t i = 0; i < count; ++i) {
        std::array<double, 3> n = {normals->at(i, 0), normals->at(i, 1), normals->at(i, 2)};
        if (turned) n = transformedNormal(instance.toWorld, n);
        mesh_.normals.push_back(mending_.normal(n));
      }
    }
    if (primitive.colour) {
      const auto colours = attribute(*primitive.colour, "COLOR_0", count, 3, 4);
      if (!colours) return tl::unexpected(colours.error());
      mesh_.colours.resize(before, kNoColour);
      // Normalized values have become 0 .. 1 already.
      const double full =
          model_.accessors[*primitive.colour].normalized ? 1 : fullChannel(*colours);
      for (uint64_t i = 0; i < count; ++i) {
        std::array<double, 4> channels = {0, 0, 0, full};
        for (unsigned c = 0; c < colours->components(); ++c) channels[c] = colours->at(i, c);
        mesh_.colours.push_back(mending_.colour(channels, full));
      }
    }
    return {};
  }

  Result<void> appendTriangles(const GltfPrimitive& primitive, uint32_t firstVertex,
                               const GltfInstance& instance) {
    const uint64_t vertices = model_.accessors[*primitive.position].count;
    std::optional<GltfValues> indices;
    if (primitive.indices) {
      auto values = buffers_.open(*primitive.indices);
      if (!values) return tl::unexpected(values.error());
      if (values->components() != 1 || values->type() == GltfComponent::float32)
        return fail("accessors[" + std::to_string(*primitive.indices) +
                    "]: of a type that indices cannot have");
      indices = std::move(*values);
    }
    const size_t before = mesh_.triangles.size();
    const uint64_t count = indices ? indices->count() : vertices;
    TriangleStrip strip;
    Triangle corners{};
    for (uint64_t i = 0; i < count; ++i) {
      const double index = indices ? indices->at(i, 0) : static_cast<double>(i);
      if (!(index >= 0 && index < static_cast<double>(vertices)))
        return fail("accessors[" + std::to_string(*primitive.indices) + "]: element " +
                    std::to_string(i) + ": " +
                    indexOutOfRange(static_cast<long long>(index), vertices));
      const uint32_t corner = firstVertex + static_cast<uint32_t>(index);
      if (primitive.mode == kStrip) {
        strip.append(corner, mesh_.triangles);
      } else if (primitive.mode == kFan) {
        if (i >= 2) mesh_.triangles.push_back({corners[0], corners[1], corner});
        corners[i == 0 ? 0 : 1] = corner;
      } else {
        corners[i % 3] = corner;
        if (i % 3 == 2) mesh_.triangles.push_back(corners);
      }
    }
    if (primitive.mode == kTriangles && count % 3 != 0) ++incomplete_;
    if (determinant(instance.toWorld) < 0)
      for (size_t i = before; i < mesh_.triangles.size(); ++i)
        std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
    return {};
  }

  [[nodiscard]] std::string whatThereIs(const std::set<uint32_t>& shown) const {
    if (model_.meshes.empty()) return "no meshes";
    if (shown.empty()) return "meshes, but no node of the scene shows one";
    for (const uint32_t mesh : shown)
      for (const GltfPrimitive& primitive : model_.meshes[mesh].primitives)
        if (hasTriangles(primitive)) return "primitives of triangles, all of them empty";
    return "only points and lines";
  }

  void sayWhatIsNotCarried(const std::set<uint32_t>& shown) {
    uint64_t points = 0;
    uint64_t lines = 0;
    uint64_t textured = 0;
    uint64_t morphed = 0;
    uint64_t withoutPositions = 0;
    std::set<std::string> attributes;
    for (const uint32_t mesh : shown) {
      for (const GltfPrimitive& primitive : model_.meshes[mesh].primitives) {
        if (primitive.mode == 0) ++points;
        if (primitive.mode >= 1 && primitive.mode <= 3) ++lines;
        if (primitive.hasTextureCoordinates) ++textured;
        if (primitive.morphTargets > 0) ++morphed;
        if (!primitive.position) ++withoutPositions;
        attributes.insert(primitive.otherAttributes.begin(), primitive.otherAttributes.end());
      }
    }
    NameList names;
    for (const std::string& name : attributes) names.add(name);
    uint64_t instanced = 0;
    for (const GltfNode& node : model_.nodes)
      if (node.hasInstances) ++instanced;
    auto& out = mesh_.notCarried;
    addNotCarried(out, "primitives with texture coordinates", textured);
    addNotCarried(out, "materials", model_.materials);
    addNotCarried(out, "textures", model_.images);
    addNotCarried(out, "primitives of points", points);
    addNotCarried(out, "primitives of lines", lines);
    addNotCarried(out, "primitives without positions", withoutPositions);
    addNotCarried(out, "primitives with an incomplete last triangle", incomplete_);
    addNotCarried(out, "primitives with morph targets", morphed);
    addNotCarried(out, "skins (their meshes stand as stored)", model_.skins);
    addNotCarried(out, "animations", model_.animations);
    addNotCarried(out, "nodes with EXT_mesh_gpu_instancing (shown once)", instanced);
    addNotCarried(out, "extra vertex attributes", names);
    if (model_.scene && model_.scenes.size() > 1)
      addNotCarried(out, "scenes beside the default one", model_.scenes.size() - 1);
    if (shown.size() < model_.meshes.size())
      addNotCarried(out, "meshes that the scene does not show",
                    model_.meshes.size() - shown.size());
  }

  std::string_view file_;
  const GltfModel& model_;
  GltfBuffers buffers_;
  IndexedMesh mesh_;
  VertexAttributeMending mending_;
  uint64_t incomplete_ = 0;
};

}  // namespace

Result<IndexedMesh> readGltf(std::string_view file,
                             const std::optional<std::filesystem::path>& folder) {
  const auto chunks = splitGltf(file);
  if (!chunks) return tl::unexpected(chunks.error());
  const auto model = parseGltfModel(*chunks);
  if (!model) return tl::unexpected(model.error());
  return GltfReader(file, *model, chunks->binary, folder).read();
}

}  // namespace meshfront
