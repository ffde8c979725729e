// Ends the program where a reader broke a promise, so that a fuzzer keeps the input.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace meshfront::fuzz {

inline void promise(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

}  // namespace meshfront::fuzz
