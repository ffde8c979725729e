// A GPU buffer of equal records by slot, which grows without a byte of it being uploaded again.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/result.h"
#include "viewer/gl/gl_object.h"

namespace meshfront {

// What the CPU may do with a buffer; without anything a GPU keeps it in its own memory.
enum class SlotAccess { none, map, upload };

class SlotBuffer {
 public:
  // `bytesPerSlot`: a multiple of 4. `fill`: the word that slots nobody wrote hold.
  SlotBuffer(size_t bytesPerSlot, uint32_t fill, SlotAccess access)
      : bytesPerSlot_(bytesPerSlot), fill_(fill), access_(access) {}

  // Room for this many slots at least; what it holds is copied on the GPU, and its name changes.
  // On an error (no GPU memory) nothing has changed.
  Result<void> hold(size_t slots);

  [[nodiscard]] GlName name() const { return buffer_.name(); }  // 0 before the first hold()
  [[nodiscard]] size_t bytesPerSlot() const { return bytesPerSlot_; }
  [[nodiscard]] size_t byteCount() const { return capacity_ * bytesPerSlot_; }

 private:
  size_t bytesPerSlot_;
  uint32_t fill_;
  SlotAccess access_;
  GlBuffer buffer_;
  size_t capacity_ = 0;  // slots
};

}  // namespace meshfront
