// The catalogue of the proxy: what its upstream offers, as far as it was asked for.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "proxy/cached_store.h"
#include "shared/http/catalogue.h"

namespace meshfront {

class CachedCatalogue final : public Catalogue {
 public:
  // All parts must outlive the catalogue.
  explicit CachedCatalogue(const CachedStore::Parts& parts) : parts_(parts) {}

  [[nodiscard]] Result<Described> list(Waiting waiting) override;
  [[nodiscard]] Result<Described> describe(std::string_view mesh, Waiting waiting) override;
  [[nodiscard]] Result<std::shared_ptr<RecordStore>> open(std::string_view mesh,
                                                          std::string_view revision,
                                                          Waiting waiting) override;
  // Ready while the upstream's catalogue is known, be it an old one.
  [[nodiscard]] bool ready(Waiting waiting) override { return list(waiting).has_value(); }

 private:
  // Decoded bases and tables are outside the byte budget; that many revisions are kept.
  static constexpr size_t kMaxStores = 64;
  struct Opened {
    std::shared_ptr<CachedStore> store;
    uint64_t lastUse = 0;
  };
  [[nodiscard]] std::shared_ptr<CachedStore> known(const std::string& key);
  std::shared_ptr<CachedStore> remember(const std::string& key, std::shared_ptr<CachedStore> store);

  const CachedStore::Parts parts_;
  std::mutex mutex_;
  std::map<std::string, Opened> stores_;  // by "{mesh}/{revision}"
  uint64_t uses_ = 0;
};

}  // namespace meshfront
