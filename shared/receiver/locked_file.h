// Files of a folder that several processes use at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "shared/result.h"

namespace meshfront {

// An open file, and a lock on it (flock), which ends with it, even if the process is killed. Locks
// of two of these exclude each other within a process, too.
class LockedFile {
 public:
  enum class Lock { shared, exclusive };
  enum class Wait { no, yes };

  LockedFile() = default;
  ~LockedFile() { close(); }
  LockedFile(LockedFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  LockedFile& operator=(LockedFile&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  // Opens for reading; nullopt where there is none or the lock is not to be had.
  [[nodiscard]] static std::optional<LockedFile> open(const std::filesystem::path& path, Lock lock,
                                                      Wait wait);
  // Opens for reading and appending, and makes it if it is not there.
  [[nodiscard]] static Result<LockedFile> make(const std::filesystem::path& path, Lock lock,
                                               Wait wait);

  [[nodiscard]] uint64_t size() const;
  // `count` octets from `offset`, fewer at the end of the file or on an error.
  [[nodiscard]] std::vector<uint8_t> read(uint64_t offset, size_t count) const;
  // All of `bytes` at the end, or an error that names the cause. What was written of it stays.
  [[nodiscard]] Result<void> append(std::span<const uint8_t> bytes);
  void cut(uint64_t size);  // best effort
  void synchronise();       // to the disk, best effort
  void touch();             // modified now, best effort
  [[nodiscard]] bool isOpen() const { return descriptor_ >= 0; }

 private:
  explicit LockedFile(int descriptor) : descriptor_(descriptor) {}
  [[nodiscard]] static std::optional<LockedFile> lockOf(int descriptor, Lock lock, Wait wait);
  void close();
  int descriptor_ = -1;
};

// All of a file, if it is at most `most` octets long.
[[nodiscard]] std::optional<std::vector<uint8_t>> readWholeFile(const std::filesystem::path& path,
                                                                uint64_t most);
// A file of that name has these bytes or what it had before, whenever the machine stops: writes a
// temporary one in the same folder, whose name begins with kTemporaryPrefix, and renames it.
inline constexpr const char* kTemporaryPrefix = ".new-";
[[nodiscard]] Result<void> replaceFile(const std::filesystem::path& path,
                                       std::span<const uint8_t> bytes);
// Sixteen hexadecimal digits by chance, for names that no other process takes.
[[nodiscard]] std::string chanceName();

}  // namespace meshfront
