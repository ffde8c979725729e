// Object File Format (Geomview), text and binary: positions, normals (N), colours (C) and polygons.
// In text, what stands on a vertex's line behind its coordinates belongs to it.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <vector>

#include "shared/mesh_files/attribute_mending.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/polygon_triangles.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

// What the keyword says a vertex has behind its coordinates, in this order.
struct OffLayout {
  bool normals = false;
  bool colours = false;
  bool textureCoordinates = false;
  bool binary = false;
};

// [ST][C][N]OFF. 4OFF and nOFF have other dimensions.
std::optional<OffLayout> layoutOf(std::string_view word) {
  OffLayout layout;
  const auto take = [&word](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  layout.textureCoordinates = take("ST");
  layout.colours = take("C");
  layout.normals = take("N");
  if (word != "OFF") return std::nullopt;
  return layout;
}

Result<OffLayout> readKeyword(TextCursor& text) {
  text.skipSpaceAndComments();
  const std::string_view word = text.peekWord();
  if (!word.ends_with("OFF")) return OffLayout{};  // the keyword may be left out
  auto layout = layoutOf(word);
  if (!layout)
    return fail(text.place() +
                ": only OFF with three coordinates is read (OFF, COFF, NOFF, STOFF)");
  text.word();
  text.skipBlanks();
  if (text.peekWord() == "BINARY") {
    layout->binary = true;
    text.skipLine();
  }
  return *layout;
}

constexpr double kNoAlpha = -1;

float floatOf(double channel) {  // large ones are all the same
  return static_cast<float>(std::fmin(std::fmax(channel, -1e9), 1e9));
}

// Takes attributes as they come and gives them to the mesh when all are there.
class OffAttributes {
 public:
  explicit OffAttributes(const OffLayout& layout) : layout_(layout) {}

  void addNormal(const std::array<double, 3>& normal, IndexedMesh& mesh) {
    mesh.normals.push_back(mending_.normal(normal));
  }
  void addColour(const std::array<double, 4>& channels) {
    for (size_t i = 0; i < 3; ++i) scale_.see(channels[i]);
    channels_.push_back(
        {floatOf(channels[0]), floatOf(channels[1]), floatOf(channels[2]), floatOf(channels[3])});
  }
  void addSurplusColumns(uint64_t columns) { surplus_ = std::max(surplus_, columns); }
  void addFaceColour() { ++faceColours_; }

  void giveTo(IndexedMesh& mesh) {
    const double full = scale_.full();
    for (const auto& c : channels_)
      mesh.colours.push_back(mending_.colour({c[0], c[1], c[2], c[3] < 0 ? full : c[3]}, full));
    mending_.report(mesh);
    addNotCarried(mesh.notCarried, "texture coordinates",
                  layout_.textureCoordinates ? mesh.positions.size() : 0);
    addNotCarried(mesh.notCarried, "columns behind a vertex that the keyword does not name",
                  surplus_);
    addNotCarried(mesh.notCarried, "faces with a colour", faceColours_);
  }

 private:
  OffLayout layout_;
  VertexAttributeMending mending_;
  ChannelScale scale_;
  std::vector<std::array<float, 4>> channels_;  // alpha below 0: there is none
  uint64_t surplus_ = 0;
  uint64_t faceColours_ = 0;
};

class TextOffReader {
 public:
  TextOffReader(TextCursor text, const OffLayout& layout)
      : text_(text), layout_(layout), attributes_(layout) {}

  Result<IndexedMesh> read() {
    const auto counts = readCounts();
    if (!counts) return tl::unexpected(counts.error());
    mesh_.positions.resize((*counts)[0]);
    for (auto& position : mesh_.positions) {
      for (double& coordinate : position) {
        text_.skipSpaceAndComments();
        if (!text_.real(coordinate)) return fail(text_.problem());
      }
      if (auto done = readAttributes(); !done) return tl::unexpected(done.error());
      text_.skipLine();
    }
    mesh_.triangles.reserve((*counts)[1]);
    for (uint64_t face = 0; face < (*counts)[1]; ++face)
      if (auto done = readFace(); !done) return tl::unexpected(done.error());
    attributes_.giveTo(mesh_);
    return std::move(mesh_);
  }

 private:
  Result<std::array<uint64_t, 2>> readCounts() {
    std::array<uint64_t, 2> counts{};
    for (uint64_t& count : counts) {
      text_.skipSpaceAndComments();
      const TextCursor before = text_;
      int64_t value = 0;
      if (!text_.integer(value) || value < 0) return fail(before.problem("count"));
      count = static_cast<uint64_t>(value);
    }
    text_.skipLine();  // the number of edges, which nobody needs
    // A vertex takes at least six bytes ("0 0 0\n"), a face two ("0\n"), the last one no line end.
    if (counts[0] > (text_.left() + 1) / 6 || counts[1] > (text_.left() + 1) / 2)
      return fail(text_.place(text_.offset() + text_.left()) +
                  ": the file ends early, it promises " + std::to_string(counts[0]) +
                  " vertices and " + std::to_string(counts[1]) + " faces");
    if (counts[0] > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, text_.place() + ": more than 2^31 - 1 vertices");
    return counts;
  }

  // The rest of a vertex's line.
  Result<void> readAttributes() {
    if (layout_.normals) {
      std::array<double, 3> normal{};
      for (double& component : normal) {
        text_.skipBlanks();
        if (!text_.number(component)) return fail(text_.problem("number of a normal"));
      }
      attributes_.addNormal(normal, mesh_);
    }
    std::array<double, 7> rest{};  // a colour, texture coordinates, and one to see more
    size_t count = 0;
    text_.skipBlanks();
    while (count < rest.size() && text_.number(rest[count])) {
      ++count;
      text_.skipBlanks();
    }
    const size_t texture = layout_.textureCoordinates ? 2 : 0;
    if (layout_.colours) {
      if (count < 3 + texture) return fail(text_.problem("number of a colour"));
      const bool alpha = count >= 4 + texture;
      attributes_.addColour({rest[0], rest[1], rest[2], alpha ? rest[3] : kNoAlpha});
    } else if (count > texture) {
      attributes_.addSurplusColumns(count - texture);
    }
    return {};
  }

  Result<void> readFace() {
    text_.skipSpaceAndComments();
    const TextCursor before = text_;
    int64_t length = 0;
    if (!text_.integer(length) || length < 0) return fail(before.problem("number of corners"));
    corners_.clear();
    for (int64_t i = 0; i < length; ++i) {
      text_.skipSpaceAndComments();
      int64_t index = 0;
      if (!text_.integer(index)) return fail(text_.problem("vertex index"));
      if (index < 0 || index >= static_cast<int64_t>(mesh_.positions.size()))
        return fail(text_.place() + ": " + indexOutOfRange(index, mesh_.positions.size()));
      corners_.push_back(static_cast<uint32_t>(index));
    }
    text_.skipBlanks();
    if (!text_.atLineEnd()) attributes_.addFaceColour();
    text_.skipLine();
    appendFan(corners_, mesh_.triangles);
    return {};
  }

  TextCursor text_;
  OffLayout layout_;
  IndexedMesh mesh_;
  OffAttributes attributes_;
  std::vector<uint32_t> corners_;
};

// Big-endian words of 32 bits: counts of vertices, faces and edges; a vertex's floats; a face's
// number of corners, the corners, the number of its colour's floats, these.
class BinaryOffReader {
 public:
  BinaryOffReader(std::string_view file, size_t offset, const OffLayout& layout)
      : file_(file), at_(offset), layout_(layout), attributes_(layout) {}

  Result<IndexedMesh> read() {
    std::array<uint32_t, 3> counts{};
    for (uint32_t& count : counts)
      if (!word(count)) return endsEarly();
    const uint64_t vertices = counts[0];
    const uint64_t faces = counts[1];
    const uint64_t bytesEach = 4 * (3 + (layout_.normals ? 3 : 0) + (layout_.colours ? 4 : 0) +
                                    (layout_.textureCoordinates ? 2 : 0));
    if (vertices * bytesEach + faces * uint64_t{8} > file_.size() - at_)
      return fail("byte " + std::to_string(file_.size()) + ": the file ends early, it promises " +
                  std::to_string(vertices) + " vertices and " + std::to_string(faces) + " faces");
    if (vertices > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, place() + "more than 2^31 - 1 vertices");
    mesh_.positions.resize(vertices);
    for (auto& position : mesh_.positions)
      if (auto done = readVertex(position); !done) return tl::unexpected(done.error());
    mesh_.triangles.reserve(faces);
    for (uint64_t face = 0; face < faces; ++face)
      if (auto done = readFace(); !done) return tl::unexpected(done.error());
    attributes_.giveTo(mesh_);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::string place() const { return "byte " + std::to_string(at_) + ": "; }
  [[nodiscard]] tl::unexpected<Error> endsEarly() const {
    return fail("byte " + std::to_string(file_.size()) + ": the file ends early");
  }

  bool word(uint32_t& value) {
    if (file_.size() - at_ < 4) return false;
    value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(file_[at_ + i]);
    at_ += 4;
    return true;
  }
  template <size_t N>
  bool reals(std::array<double, N>& values) {
    for (double& value : values) {
      uint32_t bits = 0;
      if (!word(bits)) return false;
      value = std::bit_cast<float>(bits);
    }
    return true;
  }

  Result<void> readVertex(std::array<double, 3>& position) {
    const size_t start = at_;
    if (!reals(position)) return endsEarly();
    for (size_t i = 0; i < 3; ++i)
      if (!std::isfinite(position[i]))
        return fail("byte " + std::to_string(start + 4 * i) + ": a coordinate that is not finite");
    std::array<double, 3> normal{};
    std::array<double, 4> colour{};
    std::array<double, 2> texture{};
    if ((layout_.normals && !reals(normal)) || (layout_.colours && !reals(colour)) ||
        (layout_.textureCoordinates && !reals(texture)))
      return endsEarly();
    if (layout_.normals) attributes_.addNormal(normal, mesh_);
    if (layout_.colours) attributes_.addColour(colour);
    return {};
  }

  Result<void> readFace() {
    uint32_t length = 0;
    if (!word(length)) return endsEarly();
    corners_.clear();
    for (uint32_t i = 0; i < length; ++i) {
      uint32_t index = 0;
      if (!word(index)) return endsEarly();
      if (index >= mesh_.positions.size())
        return fail("byte " + std::to_string(at_ - 4) + ": " +
                    indexOutOfRange(static_cast<int32_t>(index), mesh_.positions.size()));
      corners_.push_back(index);
    }
    uint32_t colourWords = 0;
    if (!word(colourWords)) return endsEarly();
    if (colourWords > (file_.size() - at_) / 4) return endsEarly();
    at_ += size_t{4} * colourWords;
    if (colourWords > 0) attributes_.addFaceColour();
    appendFan(corners_, mesh_.triangles);
    return {};
  }

  std::string_view file_;
  size_t at_;
  OffLayout layout_;
  IndexedMesh mesh_;
  OffAttributes attributes_;
  std::vector<uint32_t> corners_;
};

}  // namespace

Result<IndexedMesh> readOff(std::string_view file) {
  TextCursor text(file);
  const auto layout = readKeyword(text);
  if (!layout) return tl::unexpected(layout.error());
  auto mesh = layout->binary ? BinaryOffReader(file, text.offset(), *layout).read()
                             : TextOffReader(text, *layout).read();
  if (mesh && mesh->triangles.empty())
    return noTriangles(file, counted(mesh->positions.size(), "vertex", "vertices") +
                                 " and no face with three corners");
  return mesh;
}

}  // namespace meshfront
