// When a run without a window ends, as written on a command line (`--until`).
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/result.h"

namespace meshfront {

struct StopCondition {
  enum class Kind {
    settled,   // nothing visible is left to split
    complete,  // the full mesh is here
    bytes,     // `amount` octets down, headers included
    records,   // `amount` records applied
    psnr       // the picture is within `decibels` of the reference's
  };
  Kind kind = Kind::settled;
  uint64_t amount = 0;
  double decibels = 0;
};

// settled | complete | 20000 | 20kB | 64KiB | records:5000 | psnr:35. Octets may carry B, kB, MB,
// GB (powers of 1000) or KiB, MiB, GiB (powers of 1024).
[[nodiscard]] Result<StopCondition> parseStopCondition(std::string_view text);

}  // namespace meshfront
