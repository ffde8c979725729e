// The vertices while cleaning: those of the input and copies of them. Only numbers; what a copy
// carries is that of its original.
#pragma once

#include <cstdint>
#include <vector>

namespace meshfront {

class VertexCopies {
 public:
  explicit VertexCopies(size_t originals) : originals_(originals) {}

  [[nodiscard]] size_t count() const { return originals_ + copyOf_.size(); }
  // The number of a new copy of vertex (which may be a copy itself).
  uint32_t copy(uint32_t vertex) {
    copyOf_.push_back(originalOf(vertex));
    return static_cast<uint32_t>(count() - 1);
  }
  [[nodiscard]] uint32_t originalOf(size_t vertex) const {
    return vertex < originals_ ? static_cast<uint32_t>(vertex) : copyOf_[vertex - originals_];
  }

 private:
  size_t originals_;
  std::vector<uint32_t> copyOf_;
};

}  // namespace meshfront
