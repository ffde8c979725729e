// The meshes that a record service offers.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

#include "shared/result.h"
#include "shared/store/held_bytes.h"
#include "shared/store/record_store.h"

namespace meshfront {

struct Described {
  HeldBytes json;
  std::optional<std::chrono::seconds> age;  // since it left its origin; nothing at the origin
};

// Thread-safe. Errors and waiting as in RecordStore. Names have passed isMeshName(), revisions
// isRevision(); neither is known to exist.
class Catalogue {
 public:
  Catalogue() = default;
  virtual ~Catalogue() = default;
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  [[nodiscard]] virtual Result<Described> list(Waiting waiting) = 0;
  [[nodiscard]] virtual Result<Described> describe(std::string_view mesh, Waiting waiting) = 0;
  [[nodiscard]] virtual Result<std::shared_ptr<RecordStore>> open(std::string_view mesh,
                                                                  std::string_view revision,
                                                                  Waiting waiting) = 0;
  // Whether requests can be answered now.
  [[nodiscard]] virtual bool ready(Waiting waiting) = 0;
};

}  // namespace meshfront
