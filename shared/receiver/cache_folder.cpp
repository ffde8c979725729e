#include "shared/receiver/cache_folder.h"

#include <algorithm>
#include <utility>

#include "shared/bits/crc32c.h"
#include "shared/store/entity_tag.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;
using Lock = LockedFile::Lock;
using Wait = LockedFile::Wait;

constexpr const char* kInUse = "in-use";
constexpr uint64_t kMostDocumentBytes = (uint64_t{1} << 30) + 64;
constexpr std::chrono::hours kTemporaryFilesLive{1};
constexpr std::chrono::hours kLongAgo{24 * 365 * 10};

std::string meshFolderName(const MeshUrl& url) {
  const std::string text = url.metadata();
  const std::string tag = documentTag({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  return url.name + "-" + tag.substr(1, tag.size() - 2);  // without the quotes
}

struct Evictable {
  fs::file_time_type usedAt;
  fs::path path;
  bool isFolder = false;
  uint64_t bytes = 0;
};

uint64_t sizeOf(const fs::directory_entry& entry) {
  std::error_code error;
  const uint64_t size = entry.is_regular_file(error) ? entry.file_size(error) : 0;
  return error ? 0 : size;
}

std::vector<fs::directory_entry> entriesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(*it);
  return entries;
}

// A process that ended while it wrote leaves them behind.
void dropOldTemporaries(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : entriesOf(folder)) {
    if (!entry.path().filename().string().starts_with(kTemporaryPrefix)) continue;
    const auto writtenAt = entry.last_write_time(error);
    if (!error && writtenAt + kTemporaryFilesLive < fs::file_time_type::clock::now())
      fs::remove(entry.path(), error);
  }
}

struct Survey {
  uint64_t bytes = 0;
  std::vector<Evictable> revisions;
  std::vector<Evictable> segments;
};

void surveyRevision(const fs::directory_entry& folder, Survey& survey) {
  std::error_code error;
  Evictable revision{{}, folder.path(), true, 0};
  dropOldTemporaries(folder.path());
  for (const auto& entry : entriesOf(folder.path())) {
    const uint64_t size = sizeOf(entry);
    revision.bytes += size;
    const auto writtenAt = entry.last_write_time(error);
    const std::string name = entry.path().filename().string();
    if (name == kInUse && !error) revision.usedAt = writtenAt;
    if (name.starts_with("segment-") && !error)
      survey.segments.push_back({writtenAt, entry.path(), false, size});
  }
  survey.bytes += revision.bytes;
  survey.revisions.push_back(std::move(revision));
}

Survey surveyOf(const fs::path& folder) {
  Survey survey;
  std::error_code error;
  for (const auto& mesh : entriesOf(folder)) {
    survey.bytes += sizeOf(mesh);
    if (!mesh.is_directory(error) || mesh.is_symlink(error)) continue;
    dropOldTemporaries(mesh.path());
    for (const auto& entry : entriesOf(mesh.path())) {
      survey.bytes += sizeOf(entry);
      if (entry.is_directory(error) && !entry.is_symlink(error) &&
          isRevision(entry.path().filename().string()))
        surveyRevision(entry, survey);
    }
  }
  const auto olderFirst = [](const Evictable& a, const Evictable& b) {
    return a.usedAt != b.usedAt ? a.usedAt < b.usedAt : a.path < b.path;
  };
  std::sort(survey.revisions.begin(), survey.revisions.end(), olderFirst);
  std::sort(survey.segments.begin(), survey.segments.end(), olderFirst);
  return survey;
}

// False: somebody uses it. `lockFile` is what users hold a shared lock on.
bool removeUnused(const Evictable& what, const fs::path& lockFile) {
  std::error_code error;
  const auto unused = LockedFile::open(lockFile, Lock::exclusive, Wait::no);
  if (!unused && fs::exists(lockFile, error)) return false;
  if (what.isFolder) {
    fs::remove_all(what.path, error);
  } else {
    fs::remove(what.path, error);
  }
  return !error;
}

}  // namespace

CacheFolder::CacheFolder(fs::path folder, uint64_t budget, const MeshUrl& url)
    : folder_(std::move(folder)), meshFolder_(folder_ / meshFolderName(url)), budget_(budget) {}

Result<LockedFile> CacheFolder::lock() const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return fail(ErrorCode::unavailable, folder_.string() + ": " + error.message());
  return LockedFile::make(folder_ / "lock", Lock::exclusive, Wait::yes);
}

Result<LockedFile> CacheFolder::enter(const std::string& revision) const {
  const Result<LockedFile> alone = lock();
  if (!alone) return tl::unexpected(alone.error());
  std::error_code error;
  fs::create_directories(revisionFolder(revision), error);
  if (error) return fail(ErrorCode::unavailable, meshFolder_.string() + ": " + error.message());
  Result<LockedFile> inUse =
      LockedFile::make(revisionFolder(revision) / kInUse, Lock::shared, Wait::yes);
  if (inUse) inUse->touch();
  return inUse;
}

void CacheFolder::ageOthers(const std::string& revision) const {
  std::error_code error;
  for (const auto& entry : entriesOf(meshFolder_)) {
    if (entry.path().filename() == revision || !entry.is_directory(error)) continue;
    fs::last_write_time(entry.path() / kInUse, fs::file_time_type::clock::now() - kLongAgo, error);
  }
}

bool CacheFolder::makeRoom(uint64_t bytes) const {
  if (bytes > budget_) return false;
  const Result<LockedFile> alone = lock();
  if (!alone) return false;
  Survey survey = surveyOf(folder_);
  uint64_t used = survey.bytes;
  std::vector<fs::path> gone;
  for (const Evictable& revision : survey.revisions) {
    if (used + bytes <= budget_) return true;
    if (!removeUnused(revision, revision.path / kInUse)) continue;
    used -= std::min(used, revision.bytes);
    gone.push_back(revision.path);
  }
  for (const Evictable& segment : survey.segments) {
    if (used + bytes <= budget_) return true;
    if (std::find(gone.begin(), gone.end(), segment.path.parent_path()) != gone.end()) continue;
    if (removeUnused(segment, segment.path)) used -= std::min(used, segment.bytes);
  }
  return used + bytes <= budget_;
}

uint64_t CacheFolder::bytesUsed() const {
  return surveyOf(folder_).bytes;
}

std::optional<std::vector<uint8_t>> CacheFolder::readDocument(const fs::path& path) {
  std::optional<std::vector<uint8_t>> bytes = readWholeFile(path, kMostDocumentBytes);
  if (!bytes || !checkedContent(*bytes, "cache")) return std::nullopt;
  bytes->resize(bytes->size() - kChecksumBytes);
  return bytes;
}

Result<void> CacheFolder::writeDocument(const fs::path& path,
                                        std::span<const uint8_t> content) const {
  std::vector<uint8_t> bytes(content.begin(), content.end());
  appendChecksum(bytes);
  if (!makeRoom(bytes.size()))
    return fail(ErrorCode::tooLarge, "the disk cache is full of what is in use");
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  return replaceFile(path, bytes);
}

}  // namespace meshfront
