#include "shared/receiver/locked_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>

namespace meshfront {
namespace {

constexpr mode_t kOwnerOnly = 0600;

std::string causeOf(int error) {
  std::array<char, 128> text{};
  return strerror_r(error, text.data(), text.size());  // GNU's: returns the text
}

Result<void> writeAll(int descriptor, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return fail(ErrorCode::unavailable, causeOf(written < 0 ? errno : ENOSPC));
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return {};
}

}  // namespace

void LockedFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

std::optional<LockedFile> LockedFile::lockOf(int descriptor, Lock lock, Wait wait) {
  LockedFile file(descriptor);
  const int kind = (lock == Lock::shared ? LOCK_SH : LOCK_EX) | (wait == Wait::no ? LOCK_NB : 0);
  int locked = -1;
  do {
    locked = ::flock(descriptor, kind);
  } while (locked != 0 && errno == EINTR);
  if (locked != 0) return std::nullopt;
  return file;
}

std::optional<LockedFile> LockedFile::open(const std::filesystem::path& path, Lock lock,
                                           Wait wait) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return std::nullopt;
  return lockOf(descriptor, lock, wait);
}

Result<LockedFile> LockedFile::make(const std::filesystem::path& path, Lock lock, Wait wait) {
  const int descriptor =
      ::open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly);
  if (descriptor < 0) return fail(ErrorCode::unavailable, path.string() + ": " + causeOf(errno));
  std::optional<LockedFile> file = lockOf(descriptor, lock, wait);
  if (!file) return fail(ErrorCode::overloaded, path.string() + " is locked by another process");
  return std::move(*file);
}

uint64_t LockedFile::size() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 ? static_cast<uint64_t>(status.st_size) : 0;
}

std::vector<uint8_t> LockedFile::read(uint64_t offset, size_t count) const {
  const uint64_t length = size();
  count = static_cast<size_t>(std::min<uint64_t>(count, length - std::min(length, offset)));
  std::vector<uint8_t> bytes(count);
  size_t have = 0;
  while (have < count) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + have, count - have, static_cast<off_t>(offset + have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    have += static_cast<size_t>(got);
  }
  bytes.resize(have);
  return bytes;
}

Result<void> LockedFile::append(std::span<const uint8_t> bytes) {
  return writeAll(descriptor_, bytes);
}

void LockedFile::cut(uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) return;
}

void LockedFile::synchronise() {
  (void)::fdatasync(descriptor_);
}

void LockedFile::touch() {
  (void)::futimens(descriptor_, nullptr);
}

std::optional<std::vector<uint8_t>> readWholeFile(const std::filesystem::path& path,
                                                  uint64_t most) {
  const auto file = LockedFile::open(path, LockedFile::Lock::shared, LockedFile::Wait::yes);
  if (!file || file->size() > most) return std::nullopt;
  return file->read(0, static_cast<size_t>(file->size()));
}

Result<void> replaceFile(const std::filesystem::path& path, std::span<const uint8_t> bytes) {
  const std::filesystem::path temporary = path.parent_path() / (kTemporaryPrefix + chanceName());
  Result<void> done = [&]() -> Result<void> {
    const int descriptor =
        ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
    if (descriptor < 0)
      return fail(ErrorCode::unavailable, temporary.string() + ": " + causeOf(errno));
    Result<void> written = writeAll(descriptor, bytes);
    if (written && ::fsync(descriptor) != 0) written = fail(ErrorCode::unavailable, causeOf(errno));
    if (::close(descriptor) != 0 && written) written = fail(ErrorCode::unavailable, causeOf(errno));
    if (written && ::rename(temporary.c_str(), path.c_str()) != 0)
      written = fail(ErrorCode::unavailable, causeOf(errno));
    return written;
  }();
  if (!done) (void)::unlink(temporary.c_str());
  return done;
}

std::string chanceName() {
  std::random_device random;
  std::array<char, 17> text{};
  (void)std::snprintf(text.data(), text.size(), "%08x%08x", random(), random());
  return text.data();
}

}  // namespace meshfront
