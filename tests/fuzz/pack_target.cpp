#include <lmdb.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>

#include "encoder/pack_tool/pack_decoding.h"
#include "shared/store/pack.h"
#include "shared/store/pack_keys.h"
#include "tests/data/temporary_folder.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/promise.h"

namespace meshfront::fuzz {
namespace {

using Entries = std::map<std::string, std::vector<uint8_t>>;

Entries entriesOf(Bytes input) {
  FuzzInput in(input);
  Entries entries;
  while (!in.empty()) {
    const uint8_t which = in.byte();
    const size_t length = in.word();
    const auto content = in.take(length);
    const std::vector<uint8_t> plain(content.begin(), content.end());
    if (which == 0) entries[pack_keys::kMetadata] = plain;
    if (which == 1) entries[pack_keys::kBase] = withChecksum(content);
    if (which == 2) entries[pack_keys::kChunkIndex] = withChecksum(content);
    if (which == 3) entries[pack_keys::kReport] = plain;
    if (which >= 4) entries[pack_keys::chunk(which - 4U)] = withChecksum(content);
  }
  return entries;
}

// LMDB's pages are sound, for packs are trusted as far as that; what they hold is not.
bool writeFile(const std::filesystem::path& path, const Entries& entries) {
  MDB_env* environment = nullptr;
  MDB_txn* transaction = nullptr;
  MDB_dbi database = 0;
  constexpr unsigned kFlags = MDB_NOSUBDIR | MDB_NOLOCK | MDB_NOSYNC;
  bool done = mdb_env_create(&environment) == 0;
  done = done && mdb_env_set_mapsize(environment, size_t{16} << 20) == 0 &&
         mdb_env_open(environment, path.c_str(), kFlags, 0600) == 0 &&
         mdb_txn_begin(environment, nullptr, 0, &transaction) == 0 &&
         mdb_dbi_open(transaction, nullptr, 0, &database) == 0;
  for (auto it = entries.begin(); done && it != entries.end(); ++it) {
    MDB_val key{it->first.size(), const_cast<char*>(it->first.data())};
    MDB_val value{it->second.size(), const_cast<uint8_t*>(it->second.data())};
    done = mdb_put(transaction, database, &key, &value, 0) == 0;
  }
  done = done && mdb_txn_commit(transaction) == 0;
  mdb_env_close(environment);
  return done;
}

}  // namespace

bool readPack(Bytes input) {
  static const TemporaryFolder kFolder;
  const auto path = kFolder / "a.pack";
  std::filesystem::remove(path);
  const Entries entries = entriesOf(input);
  if (entries.empty()) return false;
  promise(writeFile(path, entries), "the fuzzer can write a pack");
  const auto pack = Pack::open(path);
  if (!pack) return false;
  constexpr size_t kBudget = size_t{64} << 10;  // so that some chunks are forgotten again
  PackStore store(*pack, std::make_shared<MemoryBudget>(kBudget));
  const auto level = store.maxLevel();
  const uint32_t chunks = (*pack)->metadata().chunkCount;
  for (uint32_t i = 0; i < std::min(chunks, 300U); ++i)
    static_cast<void>(store.chunk(i, Waiting::allowed));
  promise(!store.chunk(chunks, Waiting::allowed), "there are as many chunks as told");
  if (!level) return false;
  CollectLimits limits;
  limits.maxRecords = 1 << 14;
  Expansion all;
  all.significance = static_cast<uint8_t>(*level);
  for (uint32_t tree = 0; tree < 8; ++tree) {
    const std::array root{NodeId::root(tree)};
    const std::array below{root[0].child(true).child(false)};
    static_cast<void>(store.collect(root, all, limits, Waiting::allowed));
    static_cast<void>(store.collect(below, {}, limits, Waiting::allowed));
  }
  return fullMesh(store).has_value();
}

}  // namespace meshfront::fuzz
