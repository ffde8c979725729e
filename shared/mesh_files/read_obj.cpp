// Wavefront OBJ: only vertices and faces matter here.
#include <vector>

#include "shared/mesh_files/mesh_readers.h"
#include "shared/mesh_files/polygon_triangles.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {
namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view file) : text_(file) {}

  Result<IndexedMesh> read() {
    while (!text_.atEnd()) {
      text_.skipBlanks();
      const std::string_view keyword = text_.word();
      Result<void> done;
      if (keyword == "v")
        done = readVertex();
      else if (keyword == "f")
        done = readFace();
      if (!done) return tl::unexpected(done.error());
      text_.skipLine();
    }
    // A face may name vertices that come later in the file, so this is known only now.
    if (largestIndex_ >= static_cast<int64_t>(mesh_.positions.size()))
      return fail(text_.place(largestAt_) + ": " +
                  indexOutOfRange(largestIndex_ + 1, mesh_.positions.size()));
    return std::move(mesh_);
  }

 private:
  Result<void> readVertex() {
    auto& position = mesh_.positions.emplace_back();
    for (double& coordinate : position) {
      text_.skipBlanks();
      if (!text_.real(coordinate)) return fail(text_.problem());
    }
    if (mesh_.positions.size() > kMaxFileVertices)
      return fail(ErrorCode::tooLarge, text_.place() + ": more than 2^31 - 1 vertices");
    return {};
  }

  Result<void> readFace() {
    corners_.clear();
    const auto count = static_cast<int64_t>(mesh_.positions.size());
    for (text_.skipBlanks(); !text_.atLineEnd(); text_.skipBlanks()) {
      const size_t at = text_.offset();
      int64_t index = 0;
      if (!text_.integerPrefix(index)) return fail(text_.problem("vertex index"));
      // What follows is texture coordinate and normal: /vt, //vn or /vt/vn.
      const std::string_view rest = text_.word();
      if (!rest.empty() && rest[0] != '/') return fail(text_.place(at) + ": broken vertex index");
      if (index == 0 || index < -count || index > static_cast<int64_t>(kMaxFileVertices))
        return fail(text_.place(at) + ": " + indexOutOfRange(index, mesh_.positions.size()) +
                    " so far");
      index = index < 0 ? count + index : index - 1;
      if (index > largestIndex_) {
        largestIndex_ = index;
        largestAt_ = at;
      }
      corners_.push_back(static_cast<uint32_t>(index));
    }
    appendFan(corners_, mesh_.triangles);
    return {};
  }

  TextCursor text_;
  IndexedMesh mesh_;
  std::vector<uint32_t> corners_;
  int64_t largestIndex_ = -1;
  size_t largestAt_ = 0;
};

}  // namespace

Result<IndexedMesh> readObj(std::string_view file) {
  return ObjReader(file).read();
}

}  // namespace meshfront
