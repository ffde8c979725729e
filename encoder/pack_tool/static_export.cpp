#include "encoder/pack_tool/static_export.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = ".meshfront-export";

tl::unexpected<Error> failure(const fs::path& path, const std::string& what, int error) {
  return fail(ErrorCode::unavailable,
              path.string() + ": " + what + ": " + std::generic_category().message(error));
}

std::span<const uint8_t> asBytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// A folder beside the one to be written, removed unless it took its place.
class NewFolder {
 public:
  static Result<NewFolder> beside(const fs::path& folder) {
    fs::path hidden = folder.parent_path() / ".";
    hidden += folder.filename();
    hidden += ".XXXXXX";
    std::string pattern = hidden.string();
    if (::mkdtemp(pattern.data()) == nullptr)
      return failure(folder, "no folder can be made beside it", errno);
    NewFolder made;
    made.path_ = pattern;
    constexpr mode_t kReadableByAll = 0755;
    if (::chmod(pattern.c_str(), kReadableByAll) != 0)
      return failure(folder, "its mode cannot be set", errno);
    return made;
  }
  ~NewFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  NewFolder(NewFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  NewFolder& operator=(NewFolder&&) = delete;
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  // Everything is on the disk before anything gets its name.
  Result<void> sync() const {
    const int handle = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle < 0) return failure(path_, "cannot be opened", errno);
    const int status = ::syncfs(handle);
    const int error = errno;
    ::close(handle);
    if (status != 0) return failure(path_, "cannot be synced", error);
    return {};
  }
  // Takes the place of `folder`; what is there now is removed.
  Result<void> replace(const fs::path& folder) {
    const char* from = path_.c_str();
    if (::rename(from, folder.c_str()) == 0) {  // there is none, or an empty one
      path_.clear();
      return {};
    }
    // The old one is under the temporary name then, and goes with it.
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) != 0)
      return failure(folder, "the finished folder cannot take its place", errno);
    return {};
  }

 private:
  NewFolder() = default;
  fs::path path_;
};

class FileWriter {
 public:
  FileWriter(fs::path folder, const std::function<bool()>& cancelled)
      : folder_(std::move(folder)), cancelled_(cancelled) {}

  Result<void> write(const fs::path& name, std::span<const uint8_t> content) {
    if (cancelled_ && cancelled_())
      return fail(ErrorCode::unavailable, "export: interrupted; nothing was written");
    const fs::path path = folder_ / name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) return failure(path.parent_path(), "cannot be made", error.value());
    errno = 0;
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(content.data()),
              static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) return failure(path, "cannot be written", errno == 0 ? EIO : errno);
    ++summary_.files;
    summary_.bytes += content.size();
    return {};
  }
  // The content at the URL of a folder.
  Result<void> writeIndex(const fs::path& folder, const char* extension,
                          std::span<const uint8_t> content) {
    auto done = write(folder / "index.html", content);
    return done ? write(folder / (std::string("index.") + extension), content) : done;
  }
  [[nodiscard]] ExportSummary summary() const { return summary_; }

 private:
  fs::path folder_;
  const std::function<bool()>& cancelled_;
  ExportSummary summary_;
};

Result<void> writeResources(FileWriter& out, const Pack& pack) {
  const MeshMetadata& m = pack.metadata();
  const fs::path meshes = "v1/meshes";
  const fs::path mesh = meshes / m.name;
  const fs::path chunks = mesh / m.revision / "chunks";
  const std::string note = "A meshfront export of mesh " + m.name + ", revision " + m.revision +
                           ". Written whole; it is replaced, not changed.\n";
  const std::string catalogue = catalogueJson(std::span(&m, 1));
  const std::string metadata = toJson(m);
  Result<void> done = out.write(kMarker, asBytes(note));
  if (done) done = out.writeIndex(meshes, "json", asBytes(catalogue));
  if (done) done = out.writeIndex(mesh, "json", asBytes(metadata));
  if (done) done = out.write(mesh / m.revision / "base", pack.base());
  if (done) done = out.writeIndex(chunks, "bin", pack.chunkIndex());
  for (uint32_t i = 0; done && i < m.chunkCount; ++i) {
    const auto chunk = pack.chunk(i);
    if (!chunk) return tl::unexpected(chunk.error());
    done = out.write(chunks / std::to_string(i), *chunk);
  }
  return done;
}

// Whether the folder may be written, and where it really is.
Result<fs::path> placeOf(const fs::path& folder, bool force) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(folder, error);
  if (error) return failure(folder, "cannot be looked at", error.value());
  if (!place.has_filename()) place = place.parent_path();
  if (!place.has_relative_path())
    return fail(folder.string() + ": not the root of all folders; name a folder of its own");
  const fs::file_status status = fs::status(place, error);
  if (!fs::exists(status)) return place;
  if (!fs::is_directory(status)) return fail(folder.string() + ": is there and is no folder");
  const bool empty = fs::is_empty(place, error);
  if (error) return failure(folder, "cannot be looked at", error.value());
  if (empty || force || fs::is_regular_file(place / kMarker, error)) return place;
  return fail(folder.string() +
              ": is there, is not empty and is no earlier export; choose another folder, or use "
              "--force to delete what it holds");
}

}  // namespace

Result<ExportSummary> exportStaticFiles(const Pack& pack, const fs::path& folder, bool force,
                                        const std::function<bool()>& cancelled) {
  if (pack.metadata().name == "index.html" || pack.metadata().name == "index.json")
    return fail("a mesh of the name " + pack.metadata().name +
                " would stand where the catalogue does; encode it with another --name");
  const auto place = placeOf(folder, force);
  if (!place) return tl::unexpected(place.error());
  auto fresh = NewFolder::beside(*place);
  if (!fresh) return tl::unexpected(fresh.error());
  FileWriter out(fresh->path(), cancelled);
  if (auto written = writeResources(out, pack); !written) return tl::unexpected(written.error());
  if (auto synced = fresh->sync(); !synced) return tl::unexpected(synced.error());
  if (auto replaced = fresh->replace(*place); !replaced) return tl::unexpected(replaced.error());
  return out.summary();
}

}  // namespace meshfront
