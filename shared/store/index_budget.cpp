#include "shared/store/index_budget.h"

#include <algorithm>

namespace meshfront {

void IndexBudget::join(Member* member) {
  const std::scoped_lock lock(mutex_);
  members_.push_back(member);
}

void IndexBudget::leave(Member* member) {
  const std::scoped_lock lock(mutex_);
  std::erase(members_, member);
}

size_t IndexBudget::bytesLocked() const {
  size_t sum = 0;
  for (const Member* member : members_) sum += member->indexBytes();
  return sum;
}

size_t IndexBudget::bytes() const {
  const std::scoped_lock lock(mutex_);
  return bytesLocked();
}

void IndexBudget::enforce() {
  const std::scoped_lock lock(mutex_);
  const auto smaller = [](const Member* a, const Member* b) {
    return a->indexBytes() < b->indexBytes();
  };
  for (size_t round = 0; round < members_.size(); ++round) {
    const size_t used = bytesLocked();
    if (used <= limit_) return;
    (*std::max_element(members_.begin(), members_.end(), smaller))->evictIndex(used - limit_);
  }
}

}  // namespace meshfront
