#include "service/pack_files.h"

#include <sys/stat.h>

#include <algorithm>

namespace meshfront {
namespace {

int64_t nanoseconds(const timespec& time) {
  return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

Result<std::vector<FoundPack>> findPacks(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<FoundPack> packs;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::filesystem::path& path = it->path();
    if (path.extension() != ".pack" || path.filename().string().front() == '.') continue;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) continue;
    packs.push_back({path,
                     {status.st_dev, status.st_ino, static_cast<uint64_t>(status.st_size),
                      nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)}});
  }
  if (error)
    return fail(ErrorCode::notFound,
                "the folder of packs " + folder.string() + ": " + error.message());
  std::sort(packs.begin(), packs.end(),
            [](const FoundPack& a, const FoundPack& b) { return a.path < b.path; });
  return packs;
}

}  // namespace meshfront
