// How many more splits the owner's budgets (triangles, memory) allow. The owner sets it anew
// whenever it has counted; every split uses one up.
#pragma once

#include <algorithm>
#include <cstdint>

namespace meshfront {

class SplitAllowance {
 public:
  void set(uint64_t splits) { left_ = splits; }
  void use() {
    if (limited() && left_ > 0) --left_;
  }
  [[nodiscard]] uint64_t left() const { return left_; }
  // Beside so many splits that are already on their way.
  [[nodiscard]] uint64_t leftBeside(uint64_t pending) const {
    return limited() ? left_ - std::min(left_, pending) : left_;
  }
  [[nodiscard]] bool limited() const { return left_ != UINT64_MAX; }

 private:
  uint64_t left_ = UINT64_MAX;
};

}  // namespace meshfront
