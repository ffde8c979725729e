#include "shared/store/memory_budget.h"

#include <algorithm>

namespace meshfront {

void MemoryBudget::join(Member* member) {
  const std::scoped_lock lock(mutex_);
  members_.push_back(member);
}

void MemoryBudget::leave(Member* member) {
  const std::scoped_lock lock(mutex_);
  std::erase(members_, member);
}

size_t MemoryBudget::bytesLocked() const {
  size_t sum = 0;
  for (const Member* member : members_) sum += member->heldBytes();
  return sum;
}

size_t MemoryBudget::bytes() const {
  const std::scoped_lock lock(mutex_);
  return bytesLocked();
}

void MemoryBudget::enforce() {
  const std::scoped_lock lock(mutex_);
  // A little more than needed, so that not every addition has to make room.
  const size_t spare = limit_ / 64;
  const auto smaller = [](const Member* a, const Member* b) {
    return a->heldBytes() < b->heldBytes();
  };
  for (size_t round = 0; round < members_.size(); ++round) {
    const size_t used = bytesLocked();
    if (used <= limit_) return;
    Member& largest = **std::max_element(members_.begin(), members_.end(), smaller);
    const size_t before = largest.heldBytes();
    largest.release(used - limit_ + spare);
    // Others may have added to it meanwhile.
    const size_t after = largest.heldBytes();
    if (after < before) releasedBytes_ += before - after;
  }
}

}  // namespace meshfront
