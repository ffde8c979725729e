// Wavefront OBJ: vertices, their colours and normals, and faces. What else there is gets counted.
#include <set>
#include <vector>

#include "shared/mesh_files/attribute_mending.h"
#include "shared/mesh_files/corner_normals.h"
#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/not_carried.h"
#include "shared/mesh_files/polygon_triangles.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view file) : file_(file), text_(file) {}

  Result<IndexedMesh> read() {
    while (!text_.atEnd()) {
      text_.skipBlanks();
      const std::string_view keyword = text_.word();
      Result<void> done;
      if (keyword == "v")
        done = readVertex();
      else if (keyword == "f")
        done = readFace();
      else if (keyword == "vn")
        done = readNormal();
      else
        countSkipped(keyword);
      if (!done) return tl::unexpected(done.error());
      text_.skipLine();
    }
    // A face may name what comes later in the file, so these are known only now.
    if (largestVertex_.index >= static_cast<int64_t>(mesh_.positions.size()))
      return fail(text_.place(largestVertex_.at) + ": " +
                  indexOutOfRange(largestVertex_.index + 1, mesh_.positions.size()));
    if (largestNormal_.index >= static_cast<int64_t>(normals_.normalCount()))
      return fail(text_.place(largestNormal_.at) + ": normal index " +
                  std::to_string(largestNormal_.index + 1) + " is out of range, there are " +
                  std::to_string(normals_.normalCount()));
    if (mesh_.triangles.empty()) return noTriangles(file_, whatThereIs());
    const bool of255 = colourScale_.full() == 255;
    mesh_.colours = std::move(of255 ? coloursOf255_ : coloursOf1_);
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.positions.size(), kNoColour);
    normals_.giveTo(mesh_);
    normalMending_.report(mesh_);
    (of255 ? mendingOf255_ : mendingOf1_).report(mesh_);
    addNotCarried(mesh_.notCarried, "texture coordinates", textureCoordinates_);
    addNotCarried(mesh_.notCarried, "materials", materials_.size());
    addNotCarried(mesh_.notCarried, "groups and objects", groups_);
    addNotCarried(mesh_.notCarried, "lines", lines_);
    addNotCarried(mesh_.notCarried, "points", points_);
    addNotCarried(mesh_.notCarried, "free-form curves and surfaces", freeForms_);
    return std::move(mesh_);
  }

 private:
  struct LargestIndex {
    int64_t index = -1;  // from 0
    size_t at = 0;       // where in the file
    void see(int64_t other, size_t otherAt) {
      if (other <= index) return;
      index = other;
      at = otherAt;
    }
  };

  Result<void> readVertex() {
    auto& position = mesh_.positions.emplace_back();
    for (double& coordinate : position) {
      text_.skipBlanks();
      if (!text_.real(coordinate)) return fail(text_.problem());
    }
    if (mesh_.positions.size() > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, text_.place() + ": more than 2^31 - 1 vertices");
    // One more column is a weight, three or four are a colour.
    std::array<double, 4> columns{};
    size_t count = 0;
    text_.skipBlanks();
    while (count < columns.size() && text_.number(columns[count])) {
      ++count;
      text_.skipBlanks();
    }
    if (count < 3) return {};
    // Which of the two scales it is, only the whole file tells.
    for (size_t i = 0; i < 3; ++i) colourScale_.see(columns[i]);
    const auto add = [&](std::vector<Colour>& colours, VertexAttributeMending& mending,
                         double full) {
      if (count == 3) columns[3] = full;
      colours.resize(mesh_.positions.size(), kNoColour);
      colours.back() = mending.colour(columns, full);
    };
    add(coloursOf1_, mendingOf1_, 1);
    add(coloursOf255_, mendingOf255_, 255);
    return {};
  }

  Result<void> readNormal() {
    std::array<double, 3> normal{};
    for (double& component : normal) {
      text_.skipBlanks();
      if (!text_.number(component)) return fail(text_.problem("number"));
    }
    normals_.addNormal(normalMending_.normal(normal));
    if (normals_.normalCount() > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, text_.place() + ": more than 2^31 - 1 normals");
    return {};
  }

  // An index as written (from 1, or negative from the last one so far) to one from 0.
  static bool resolve(int64_t& index, size_t countSoFar) {
    const auto count = static_cast<int64_t>(countSoFar);
    if (index == 0 || index < -count || index > static_cast<int64_t>(kMaxFileVertices))
      return false;
    index = index < 0 ? count + index : index - 1;
    return true;
  }

  Result<void> readFace() {
    corners_.clear();
    for (text_.skipBlanks(); !text_.atLineEnd(); text_.skipBlanks()) {
      const size_t at = text_.offset();
      int64_t index = 0;
      if (!text_.integerPrefix(index)) return fail(text_.problem("vertex index"));
      // What follows is texture coordinate and normal: /vt, //vn or /vt/vn.
      const std::string_view rest = text_.word();
      if (!rest.empty() && rest[0] != '/') return fail(text_.place(at) + ": broken vertex index");
      if (!resolve(index, mesh_.positions.size()))
        return fail(text_.place(at) + ": " + indexOutOfRange(index, mesh_.positions.size()) +
                    " so far");
      largestVertex_.see(index, at);
      corners_.push_back(static_cast<uint32_t>(index));
      if (const size_t slash = rest.find('/', 1); slash != rest.npos)
        if (auto done = readCornerNormal(rest.substr(slash + 1), at); !done) return done;
    }
    appendFan(corners_, mesh_.triangles);
    return {};
  }

  Result<void> readCornerNormal(std::string_view spelling, size_t at) {
    if (spelling.empty()) return {};  // "1/2/", which some programs write
    TextCursor text(spelling);
    int64_t index = 0;
    if (!text.integerPrefix(index) || !text.atEnd())
      return fail(text_.place(at) + ": broken normal index");
    const int64_t written = index;
    if (!resolve(index, normals_.normalCount()))
      return fail(text_.place(at) + ": normal index " + std::to_string(written) +
                  " is out of range, there are " + std::to_string(normals_.normalCount()) +
                  " so far");
    largestNormal_.see(index, at);
    normals_.addCorner(corners_.back(), static_cast<uint32_t>(index), mesh_.positions.size());
    return {};
  }

  void countSkipped(std::string_view keyword) {
    if (keyword == "vt") {
      ++textureCoordinates_;
    } else if (keyword == "usemtl") {
      text_.skipBlanks();
      materials_.insert(text_.word());
    } else if (keyword == "g" || keyword == "o") {
      ++groups_;
    } else if (keyword == "l") {
      ++lines_;
    } else if (keyword == "p") {
      ++points_;
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      ++freeForms_;
    }
  }

  [[nodiscard]] std::string whatThereIs() const {
    std::string what = counted(mesh_.positions.size(), "vertex", "vertices");
    const auto add = [&](uint64_t count, const char* one, const char* many) {
      if (count > 0) what += ", " + counted(count, one, many);
    };
    add(points_, "point", "points");
    add(lines_, "line", "lines");
    add(freeForms_, "free-form curve or surface", "free-form curves and surfaces");
    return what + " and no face with three corners";
  }

  std::string_view file_;
  TextCursor text_;
  IndexedMesh mesh_;
  CornerNormals normals_;
  VertexAttributeMending normalMending_;
  ChannelScale colourScale_;
  VertexAttributeMending mendingOf1_;
  VertexAttributeMending mendingOf255_;
  std::vector<Colour> coloursOf1_;
  std::vector<Colour> coloursOf255_;
  std::vector<uint32_t> corners_;
  LargestIndex largestVertex_;
  LargestIndex largestNormal_;
  uint64_t textureCoordinates_ = 0;
  std::set<std::string_view> materials_;
  uint64_t groups_ = 0;
  uint64_t lines_ = 0;
  uint64_t points_ = 0;
  uint64_t freeForms_ = 0;
};

}  // namespace

Result<IndexedMesh> readObj(std::string_view file) {
  return ObjReader(file).read();
}

}  // namespace meshfront
