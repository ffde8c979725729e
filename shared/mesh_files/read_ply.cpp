// PLY (Turk 1994): the elements `vertex`, `face` and `tristrips`; everything else is skipped.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/ply_body.h"
#include "shared/mesh_files/ply_header.h"
#include "shared/mesh_files/polygon_triangles.h"

namespace meshfront {
namespace {

enum class Role { skipped, x, y, z, corners };  // what a property means to us

template <typename Body>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Body body) : header_(header), body_(body) {}

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
    return std::move(mesh_);
  }

 private:
  static std::string headerPlace(const PlyElement& element) {
    return "line " + std::to_string(element.line) + ": ";
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
                  std::to_string(element.count) + " rows of element " + element.name);
    const bool vertices = element.name == "vertex";
    const bool strips = element.name == "tristrips";
    if (vertices) mesh_.positions.resize(element.count);
    if (element.name == "face") mesh_.triangles.reserve(element.count);
    std::array<double, 3> ignored{};
    for (uint64_t row = 0; row < element.count; ++row) {
      auto& position = vertices ? mesh_.positions[row] : ignored;
      for (size_t i = 0; i < roles->size(); ++i) {
        auto done = readProperty(element.properties[i], (*roles)[i], strips, position);
        if (!done) return done;
      }
    }
    return {};
  }

  Result<std::vector<Role>> rolesIn(const PlyElement& element) {
    std::vector<Role> roles;
    const bool corners = element.name == "face" || element.name == "tristrips";
    std::array<int, 5> seen{};
    for (const PlyProperty& property : element.properties) {
      Role role = Role::skipped;
      if (corners && property.countType &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        role = Role::corners;
      else if (element.name == "vertex" && !property.countType && property.name.size() == 1 &&
               property.name[0] >= 'x' && property.name[0] <= 'z')
        role = static_cast<Role>(property.name[0] - 'x' + static_cast<int>(Role::x));
      if (role != Role::skipped && ++seen[static_cast<size_t>(role)] > 1)
        return fail(headerPlace(element) + "element " + element.name + " has two properties " +
                    property.name);
      roles.push_back(role);
    }
    if (corners && seen[static_cast<size_t>(Role::corners)] == 0)
      return fail(headerPlace(element) + "element " + element.name + " has no list vertex_indices");
    if (element.name == "vertex") {
      if (seen[static_cast<size_t>(Role::x)] + seen[static_cast<size_t>(Role::y)] +
              seen[static_cast<size_t>(Role::z)] <
          3)
        return fail(headerPlace(element) + "element vertex lacks one of x, y and z");
      if (element.count > kMaxFileVertices)
        return fail(ErrorCode::tooLarge, headerPlace(element) + "more than 2^31 - 1 vertices");
    }
    return roles;
  }

  Result<void> readProperty(const PlyProperty& property, Role role, bool strips,
                            std::array<double, 3>& position) {
    if (role == Role::corners) return readCorners(property, strips);
    if (role != Role::skipped) {
      const size_t axis = static_cast<size_t>(role) - static_cast<size_t>(Role::x);
      if (!body_.real(property.type, position[axis])) return fail(body_.problem());
      return {};
    }
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

  const PlyHeader& header_;
  Body body_;
  uint64_t vertexCount_ = 0;
  IndexedMesh mesh_;
  std::vector<uint32_t> corners_;
};

}  // namespace

Result<IndexedMesh> readPly(std::string_view file) {
  const auto header = parsePlyHeader(file);
  if (!header) return tl::unexpected(header.error());
  switch (header->encoding) {
    case PlyEncoding::ascii:
      return PlyReader(*header, AsciiPlyBody(file, header->bodyOffset)).read();
    case PlyEncoding::littleEndian:
      return PlyReader(*header, BinaryPlyBody<std::endian::little>(file, header->bodyOffset))
          .read();
    case PlyEncoding::bigEndian:
      return PlyReader(*header, BinaryPlyBody<std::endian::big>(file, header->bodyOffset)).read();
  }
  return fail("line 2: unknown PLY format");
}

}  // namespace meshfront
