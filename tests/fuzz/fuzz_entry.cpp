// The program around one target; the build names the target.
#include "tests/fuzz/fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  meshfront::fuzz::MESHFRONT_FUZZ_FUNCTION({data, size});
  return 0;
}
