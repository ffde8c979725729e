// How much memory may still be had without killing anybody.
#pragma once

#include <cstdint>

namespace meshfront {

// Bytes: what the system has left (MemAvailable) and what the control group still allows, the
// smaller. UINT64_MAX if neither is known. Linux; a snapshot.
[[nodiscard]] uint64_t availableMemory();

}  // namespace meshfront
