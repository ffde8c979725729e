#include <fcntl.h>
#include <lmdb.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstdlib>
#include <map>
#include <memory>
#include <system_error>

#include "shared/store/pack.h"
#include "shared/store/pack_keys.h"

namespace meshfront {
namespace {

constexpr size_t kRevisionBytes = 16;  // of the digest

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(std::span<const uint8_t> bytes) {  // with its length, so that pieces cannot be shifted
    add(bytes.size());
    EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
  }
  void add(uint64_t value) {
    std::array<uint8_t, 8> bytes{};
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(value >> (8 * i));
    EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
  }
  void add(double value) { add(std::bit_cast<uint64_t>(value)); }
  std::string hex(size_t count) {
    std::array<uint8_t, EVP_MAX_MD_SIZE> digest{};
    EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr);
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (size_t i = 0; i < count; ++i) {
      text.push_back(kDigits[digest[i] >> 4]);
      text.push_back(kDigits[digest[i] & 15]);
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

// Removes the temporary file unless it became the pack.
struct TemporaryFile {
  ~TemporaryFile() {
    if (!path.empty()) ::unlink(path.c_str());
  }
  std::string path;
};

std::span<const uint8_t> asBytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

using Entries = std::map<std::string, std::span<const uint8_t>>;  // sorted as LMDB sorts

tl::unexpected<Error> systemFailure(const char* what, int error) {
  return fail(ErrorCode::unavailable,
              std::string("pack: ") + what + ": " + std::generic_category().message(error));
}

tl::unexpected<Error> interrupted() {
  return fail(ErrorCode::unavailable, "pack: interrupted; nothing was written");
}

Result<void> writeEntries(const std::string& path, const Entries& entries,
                          const std::function<bool()>& cancelled) {
  struct Environment {
    ~Environment() {
      if (handle != nullptr) mdb_env_close(handle);
    }
    MDB_env* handle = nullptr;
  } environment;
  const auto failure = [](int status) {
    return fail(ErrorCode::unavailable,
                std::string("pack: cannot be written: ") + mdb_strerror(status));
  };
  // Address space only. Beside its bytes an entry takes parts of a few pages at most.
  const auto page = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
  size_t mapSize = 1024 * page;
  for (const auto& [key, value] : entries) mapSize += (value.size() / page + 4) * page;

  if (const int status = mdb_env_create(&environment.handle); status != 0) return failure(status);
  if (const int status = mdb_env_set_mapsize(environment.handle, mapSize); status != 0)
    return failure(status);
  if (const int status =
          mdb_env_open(environment.handle, path.c_str(), MDB_NOSUBDIR | MDB_NOLOCK, 0644);
      status != 0)
    return failure(status);
  MDB_txn* transaction = nullptr;
  if (const int status = mdb_txn_begin(environment.handle, nullptr, 0, &transaction); status != 0)
    return failure(status);
  MDB_dbi database = 0;
  int status = mdb_dbi_open(transaction, nullptr, 0, &database);
  for (auto it = entries.begin(); status == 0 && it != entries.end(); ++it) {
    MDB_val key{it->first.size(), const_cast<char*>(it->first.data())};
    MDB_val value{it->second.size(), const_cast<uint8_t*>(it->second.data())};
    status = mdb_put(transaction, database, &key, &value, MDB_APPEND);
    if (status == 0 && cancelled && cancelled()) {
      mdb_txn_abort(transaction);
      return interrupted();
    }
  }
  if (status != 0) {
    mdb_txn_abort(transaction);
    return failure(status);
  }
  if (status = mdb_txn_commit(transaction); status != 0) return failure(status);
  if (status = mdb_env_sync(environment.handle, 1); status != 0) return failure(status);
  return {};
}

Result<void> syncFolder(const std::filesystem::path& folder) {
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return systemFailure("its folder cannot be synced", errno);
  const int status = ::fsync(handle);
  const int error = errno;
  ::close(handle);
  // Some file systems cannot sync folders; then the rename is as durable as it gets.
  if (status != 0 && error != EINVAL) return systemFailure("its folder cannot be synced", error);
  return {};
}

}  // namespace

std::string revisionOf(const PackContent& content) {
  Digest digest;
  const Quantization& grid = content.metadata.quantization;
  digest.add(uint64_t{grid.bits});
  for (const double v : grid.origin) digest.add(v);
  digest.add(grid.step);
  digest.add(content.base);
  digest.add(content.chunkIndex);
  digest.add(uint64_t{content.chunks.size()});
  for (const auto& chunk : content.chunks) digest.add(chunk);
  return digest.hex(kRevisionBytes);
}

Result<MeshMetadata> writePack(const std::filesystem::path& path, PackContent content,
                               const std::function<bool()>& cancelled) {
  MeshMetadata& metadata = content.metadata;
  if (!isMeshName(metadata.name))
    return fail("pack: the mesh's name must be 1 to 64 of A-Z a-z 0-9 . _ -, no dot in front");
  metadata.revision = revisionOf(content);
  metadata.baseBytes = content.base.size();
  metadata.chunkCount = static_cast<uint32_t>(content.chunks.size());
  metadata.chunkBytes = 0;
  for (const auto& chunk : content.chunks) metadata.chunkBytes += chunk.size();

  const std::string json = toJson(metadata);
  Entries entries{{pack_keys::kMetadata, asBytes(json)},
                  {pack_keys::kBase, content.base},
                  {pack_keys::kChunkIndex, content.chunkIndex},
                  {pack_keys::kReport, asBytes(content.reportJson)}};
  for (uint32_t i = 0; i < metadata.chunkCount; ++i)
    entries.emplace(pack_keys::chunk(i), content.chunks[i]);

  const std::filesystem::path folder =
      path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  TemporaryFile temporary;
  std::filesystem::path hidden = folder / ".";
  hidden += path.filename();
  hidden += ".XXXXXX";
  std::string pattern = hidden.string();
  const int handle = ::mkstemp(pattern.data());
  if (handle < 0) return systemFailure("no file can be made in its folder", errno);
  temporary.path = pattern;
  constexpr mode_t kReadableByAll = 0644;
  const int modeStatus = ::fchmod(handle, kReadableByAll);
  ::close(handle);
  if (modeStatus != 0) return systemFailure("its mode cannot be set", errno);

  if (auto written = writeEntries(temporary.path, entries, cancelled); !written)
    return tl::unexpected(written.error());
  if (cancelled && cancelled()) return interrupted();
  if (::rename(temporary.path.c_str(), path.c_str()) != 0)
    return systemFailure("the finished file cannot be moved to its name", errno);
  temporary.path.clear();
  if (auto synced = syncFolder(folder); !synced) return tl::unexpected(synced.error());
  return std::move(metadata);
}

}  // namespace meshfront
