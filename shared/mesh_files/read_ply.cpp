// PLY (Turk 1994): the elements `vertex` (positions, colours, normals), `face` and `tristrips`;
// everything else is skipped and named.
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "shared/mesh_files/attribute_mending.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/ply_body.h"
#include "shared/mesh_files/ply_header.h"
#include "shared/mesh_files/polygon_triangles.h"

namespace meshfront {
namespace {

// What a property means to us. The values of a vertex come first; they are kept in a row until the
// vertex is complete.
enum class Role { x, y, z, normalX, normalY, normalZ, red, green, blue, alpha, corners, skipped };
constexpr size_t kRoles = static_cast<size_t>(Role::skipped) + 1;
constexpr size_t kRowLength = static_cast<size_t>(Role::corners);
using Row = std::array<double, kRowLength>;
constexpr size_t at(Role role) {
  return static_cast<size_t>(role);
}

Role roleInVertex(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Role>, 13> kNames = {{
      {"x", Role::x},
      {"y", Role::y},
      {"z", Role::z},
      {"nx", Role::normalX},
      {"ny", Role::normalY},
      {"nz", Role::normalZ},
      {"red", Role::red},
      {"green", Role::green},
      {"blue", Role::blue},
      {"alpha", Role::alpha},
      {"diffuse_red", Role::red},
      {"diffuse_green", Role::green},
      {"diffuse_blue", Role::blue},
  }};
  for (const auto& [spelling, role] : kNames)
    if (spelling == name) return role;
  return Role::skipped;
}

// The value of a full channel: of real numbers 1, of 16 bits 65535, else 255.
double fullChannel(PlyScalar type) {
  switch (type) {
    case PlyScalar::float32:
    case PlyScalar::float64:
      return 1;
    case PlyScalar::uint16:
      return UINT16_MAX;
    default:
      return UINT8_MAX;
  }
}

template <typename Body>
class PlyReader {
 public:
  PlyReader(std::string_view file, const PlyHeader& header)
      : file_(file), header_(header), body_(file, header.bodyOffset) {}

  Result<IndexedMesh> read() {
    const PlyElement* vertices = nullptr;
    for (const PlyElement& element : header_.elements) {
      if (element.name != "vertex") continue;
      if (vertices != nullptr) return fail(headerPlace(element) + "a second element vertex");
      vertices = &element;
    }
    if (vertices == nullptr) return fail("line 1: the PLY header has no element vertex");
    vertexCount_ = vertices->count;
    for (const PlyElement& element : header_.elements)
      if (auto done = readElement(element); !done) return tl::unexpected(done.error());
    if (mesh_.triangles.empty()) return noTriangles(file_, whatThereIs());
    mending_.report(mesh_);
    addNotCarried(mesh_.notCarried, "extra vertex properties", extraVertexProperties_);
    addNotCarried(mesh_.notCarried, "face properties", faceProperties_);
    addNotCarried(mesh_.notCarried, "other elements", otherElements_);
    NameList textures;
    for (const std::string& name : header_.textureFiles) textures.add(name);
    addNotCarried(mesh_.notCarried, "textures", textures);
    return std::move(mesh_);
  }

 private:
  static std::string headerPlace(const PlyElement& element) {
    return "line " + std::to_string(element.line) + ": ";
  }

  [[nodiscard]] std::string whatThereIs() const {
    std::string what = counted(vertexCount_, "vertex", "vertices");
    bool faces = false;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") continue;
      what += ", " + std::to_string(element.count) + " of element " + printableName(element.name);
      faces = faces || element.name == "face" || element.name == "tristrips";
    }
    if (faces) return what + ", none with three corners";
    return what + (header_.elements.size() > 1 ? " and no faces" : "; only points");
  }

  Result<void> readElement(const PlyElement& element) {
    const auto roles = rolesIn(element);
    if (!roles) return tl::unexpected(roles.error());
    if (element.properties.empty()) return {};  // takes no bytes, however many there are
    uint64_t bytesEach = 0;
    for (const auto& property : element.properties)
      bytesEach += byteLength(property.countType.value_or(property.type));
    if (!body_.canHold(element.count, bytesEach, element.properties.size()))
      return fail(body_.place() + ": the file ends early, it promises " +
                  std::to_string(element.count) + " rows of element " +
                  printableName(element.name));
    if (element.name == "vertex") return readVertices(element, *roles);
    const bool strips = element.name == "tristrips";
    if (element.name == "face") mesh_.triangles.reserve(element.count);
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t i = 0; i < roles->size(); ++i) {
        auto done = (*roles)[i] == Role::corners ? readCorners(element.properties[i], strips)
                                                 : skipProperty(element.properties[i]);
        if (!done) return done;
      }
    }
    return {};
  }

  Result<void> readVertices(const PlyElement& element, const std::vector<Role>& roles) {
    const auto has = [&](Role role) {
      return std::find(roles.begin(), roles.end(), role) != roles.end();
    };
    const bool colours = has(Role::red);
    const bool normals = has(Role::normalX);
    mesh_.positions.resize(element.count);
    if (colours) mesh_.colours.resize(element.count);
    if (normals) mesh_.normals.resize(element.count);
    std::array<double, kRoles> channelScale{};  // makes them 0 .. 1
    for (size_t i = 0; i < roles.size(); ++i)
      channelScale[at(roles[i])] = 1 / fullChannel(element.properties[i].type);
    Row row{};
    row[at(Role::alpha)] = 1;
    for (uint64_t vertex = 0; vertex < element.count; ++vertex) {
      for (size_t i = 0; i < roles.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        const Role role = roles[i];
        if (role == Role::skipped) {
          if (auto done = skipProperty(property); !done) return done;
          continue;
        }
        double& value = row[at(role)];
        const bool read =
            role <= Role::z ? body_.real(property.type, value) : body_.number(property.type, value);
        if (!read) return fail(body_.problem());
        if (role >= Role::red) value *= channelScale[at(role)];
      }
      mesh_.positions[vertex] = {row[0], row[1], row[2]};
      if (normals) mesh_.normals[vertex] = mending_.normal({row[3], row[4], row[5]});
      if (colours) mesh_.colours[vertex] = mending_.colour({row[6], row[7], row[8], row[9]}, 1);
    }
    return {};
  }

  Result<std::vector<Role>> rolesIn(const PlyElement& element) {
    std::vector<Role> roles;
    const bool vertices = element.name == "vertex";
    const bool corners = element.name == "face" || element.name == "tristrips";
    std::array<int, kRoles> seen{};
    for (const PlyProperty& property : element.properties) {
      Role role = Role::skipped;
      if (corners && property.countType &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        role = Role::corners;
      else if (vertices && !property.countType)
        role = roleInVertex(property.name);
      if (role != Role::skipped && ++seen[at(role)] > 1)
        return fail(headerPlace(element) + "element " + element.name + " has two properties " +
                    property.name);
      roles.push_back(role);
    }
    if (corners && seen[at(Role::corners)] == 0)
      return fail(headerPlace(element) + "element " + element.name + " has no list vertex_indices");
    if (vertices) {
      if (seen[at(Role::x)] + seen[at(Role::y)] + seen[at(Role::z)] < 3)
        return fail(headerPlace(element) + "element vertex lacks one of x, y and z");
      if (element.count > kMaxFileVertices)
        return fail(ErrorCode::tooLarge, headerPlace(element) + "more than 2^31 - 1 vertices");
      // Parts of a colour or normal are none.
      const bool colours = seen[at(Role::red)] + seen[at(Role::green)] + seen[at(Role::blue)] == 3;
      const bool normals =
          seen[at(Role::normalX)] + seen[at(Role::normalY)] + seen[at(Role::normalZ)] == 3;
      for (Role& role : roles)
        if (role >= Role::red ? !colours : role >= Role::normalX && !normals) role = Role::skipped;
    }
    noteSkipped(element, roles);
    return roles;
  }

  void noteSkipped(const PlyElement& element, const std::vector<Role>& roles) {
    const bool vertices = element.name == "vertex";
    if (!vertices && element.name != "face" && element.name != "tristrips") {
      if (element.count > 0) otherElements_.add(element.name);
      return;
    }
    for (size_t i = 0; i < roles.size(); ++i)
      if (roles[i] == Role::skipped)
        (vertices ? extraVertexProperties_ : faceProperties_).add(element.properties[i].name);
  }

  Result<void> skipProperty(const PlyProperty& property) {
    int64_t length = 1;
    if (property.countType)
      if (auto done = readLength(property, length); !done) return done;
    for (int64_t i = 0; i < length; ++i)
      if (!body_.skip(property.type)) return fail(body_.problem());
    return {};
  }

  Result<void> readLength(const PlyProperty& property, int64_t& length) {
    if (!body_.integer(*property.countType, length)) return fail(body_.problem());
    if (length < 0) return fail(body_.place() + ": a list of negative length");
    if (!body_.canHold(static_cast<uint64_t>(length), byteLength(property.type), 1))
      return fail(body_.place() + ": the file ends early, a list promises " +
                  std::to_string(length) + " items");
    return {};
  }

  Result<void> readCorners(const PlyProperty& property, bool strips) {
    int64_t length = 0;
    if (auto done = readLength(property, length); !done) return done;
    corners_.clear();
    TriangleStrip strip;
    for (int64_t i = 0; i < length; ++i) {
      int64_t index = 0;
      if (!body_.integer(property.type, index)) return fail(body_.problem());
      if (strips && (index == -1 || index == UINT32_MAX)) {  // -1 in an unsigned list
        strip.restart();
        continue;
      }
      if (index < 0 || static_cast<uint64_t>(index) >= vertexCount_)
        return fail(body_.place() + ": " + indexOutOfRange(index, vertexCount_));
      if (strips)
        strip.append(static_cast<uint32_t>(index), mesh_.triangles);
      else
        corners_.push_back(static_cast<uint32_t>(index));
    }
    appendFan(corners_, mesh_.triangles);
    return {};
  }

  std::string_view file_;
  const PlyHeader& header_;
  Body body_;
  uint64_t vertexCount_ = 0;
  IndexedMesh mesh_;
  VertexAttributeMending mending_;
  NameList extraVertexProperties_;
  NameList faceProperties_;
  NameList otherElements_;
  std::vector<uint32_t> corners_;
};

}  // namespace

Result<IndexedMesh> readPly(std::string_view file) {
  const auto header = parsePlyHeader(file);
  if (!header) return tl::unexpected(header.error());
  switch (header->encoding) {
    case PlyEncoding::ascii:
      return PlyReader<AsciiPlyBody>(file, *header).read();
    case PlyEncoding::littleEndian:
      return PlyReader<BinaryPlyBody<std::endian::little>>(file, *header).read();
    case PlyEncoding::bigEndian:
      return PlyReader<BinaryPlyBody<std::endian::big>>(file, *header).read();
  }
  return fail("line 2: unknown PLY format");
}

}  // namespace meshfront
