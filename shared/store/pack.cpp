// Reading packs. LMDB maps the file; one read transaction, as old as the Pack, keeps every view
// valid. LMDB's own pages are trusted as far as the file has its whole length: contents carry
// checksums and are parsed as untrusted bytes by those who ask for them.
#include "shared/store/pack.h"

#include <lmdb.h>

#include <mutex>
#include <string_view>
#include <system_error>

#include "shared/store/pack_keys.h"

namespace meshfront {

struct Pack::State {
  ~State() {
    if (transaction != nullptr) mdb_txn_abort(transaction);
    if (environment != nullptr) mdb_env_close(environment);
  }
  // A view into the map; empty data pointer where there is no such key.
  [[nodiscard]] Result<std::span<const uint8_t>> get(std::string_view key) {
    MDB_val k{key.size(), const_cast<char*>(key.data())};
    MDB_val value{};
    const std::scoped_lock lock(mutex);  // LMDB allows one thread at a time in a transaction
    const int status = mdb_get(transaction, database, &k, &value);
    if (status == MDB_NOTFOUND)
      return fail(ErrorCode::notFound, "pack: an entry is missing; encode the mesh again");
    if (status != 0) return fail(std::string("pack: unreadable entry: ") + mdb_strerror(status));
    return std::span(static_cast<const uint8_t*>(value.mv_data), value.mv_size);
  }

  MDB_env* environment = nullptr;
  MDB_txn* transaction = nullptr;
  MDB_dbi database = 0;
  std::mutex mutex;
  MeshMetadata metadata;
  std::span<const uint8_t> base;
  std::span<const uint8_t> chunkIndex;
  std::string_view report;
};

namespace {

tl::unexpected<Error> openFailure(int status) {
  return fail(std::string("pack: cannot be opened: ") + mdb_strerror(status));
}

std::string_view asText(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A file cut short would fault in the map when a missing page is touched.
Result<void> checkWholeFile(MDB_env* environment, const std::filesystem::path& path) {
  MDB_envinfo info{};
  MDB_stat stat{};
  mdb_env_info(environment, &info);
  mdb_env_stat(environment, &stat);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::unavailable, "pack: its size cannot be read");
  if (stat.ms_psize == 0 || size / stat.ms_psize <= info.me_last_pgno)
    return fail("pack: the file is cut short; copy or encode it again");
  return {};
}

}  // namespace

Pack::Pack(std::unique_ptr<State> state) : state_(std::move(state)) {}
Pack::~Pack() = default;

Result<std::shared_ptr<const Pack>> Pack::open(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return fail(ErrorCode::notFound, "pack: there is no file " + path.string());
  auto state = std::make_unique<State>();
  if (const int status = mdb_env_create(&state->environment); status != 0)
    return openFailure(status);
  constexpr unsigned kFlags = MDB_NOSUBDIR | MDB_RDONLY | MDB_NOLOCK;
  if (const int status = mdb_env_open(state->environment, path.c_str(), kFlags, 0); status != 0)
    return openFailure(status);
  if (auto whole = checkWholeFile(state->environment, path); !whole)
    return tl::unexpected(whole.error());
  if (const int status =
          mdb_txn_begin(state->environment, nullptr, MDB_RDONLY, &state->transaction);
      status != 0)
    return openFailure(status);
  if (const int status = mdb_dbi_open(state->transaction, nullptr, 0, &state->database);
      status != 0)
    return openFailure(status);

  const auto metadataBytes = state->get(pack_keys::kMetadata);
  if (!metadataBytes) return tl::unexpected(metadataBytes.error());
  auto metadata = metadataFromJson(asText(*metadataBytes));
  if (!metadata) return tl::unexpected(metadata.error());
  state->metadata = std::move(*metadata);
  MDB_stat entries{};
  mdb_stat(state->transaction, state->database, &entries);
  if (state->metadata.chunkCount > entries.ms_entries)
    return fail("pack: fewer chunks than its metadata tells; encode the mesh again");
  const auto base = state->get(pack_keys::kBase);
  if (!base) return tl::unexpected(base.error());
  const auto index = state->get(pack_keys::kChunkIndex);
  if (!index) return tl::unexpected(index.error());
  state->base = *base;
  state->chunkIndex = *index;
  if (const auto report = state->get(pack_keys::kReport)) state->report = asText(*report);
  return std::shared_ptr<const Pack>(new Pack(std::move(state)));
}

const MeshMetadata& Pack::metadata() const {
  return state_->metadata;
}
std::span<const uint8_t> Pack::base() const {
  return state_->base;
}
std::span<const uint8_t> Pack::chunkIndex() const {
  return state_->chunkIndex;
}
std::string_view Pack::reportJson() const {
  return state_->report;
}

Result<std::span<const uint8_t>> Pack::chunk(uint32_t number) const {
  if (number >= state_->metadata.chunkCount)
    return fail(ErrorCode::notFound, "no chunk of that number");
  return state_->get(pack_keys::chunk(number));
}

}  // namespace meshfront
