// How much memory this program has held.
#pragma once

#include <cstdint>

namespace meshfront {

// The most since forgetPeakMemory(), in bytes; 0 if the kernel does not tell. getrusage() is no
// help: it counts what the program that started this one held.
[[nodiscard]] uint64_t peakMemory();
// From here on the peak is counted anew, from what is held now. Where the kernel refuses (proc(5),
// clear_refs) the peak stays that of the whole run.
void forgetPeakMemory();

}  // namespace meshfront
