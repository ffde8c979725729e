// How much memory this program has held.
#pragma once

#include <cstdint>

namespace meshfront {

// The most so far, in bytes; 0 if the kernel does not tell. getrusage() is no help: it counts what
// the program that started this one held.
[[nodiscard]] uint64_t peakMemory();

}  // namespace meshfront
