// Counts of pixels on the GPU, by vertex slot of each instance, for showing them as colours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/result.h"
#include "viewer/gl/gl_object.h"
#include "viewer/gl/slot_buffer.h"

namespace meshfront {

class PixelBuffers {
 public:
  // Instead of those before; [instance][vertex slot], as PixelCounter gives them.
  Result<void> set(std::span<const std::vector<uint32_t>> pixels);
  // With room for this many slots, 0 where nothing was counted; 0 if there is no room on the GPU or
  // no such instance.
  [[nodiscard]] GlName buffer(size_t instance, size_t slots);

 private:
  std::vector<SlotBuffer> buffers_;
};

}  // namespace meshfront
