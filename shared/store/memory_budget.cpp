#include "shared/store/memory_budget.h"

#include <algorithm>

namespace meshfront {
namespace {

constexpr size_t kUnprovenShare = 10;  // of the limit, one in so many

}  // namespace

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
  const auto lessUnproven = [](const Member* a, const Member* b) {
    return a->unprovenBytes() < b->unprovenBytes();
  };
  const auto mostGivingUp = [&]() -> Member& {
    Member& unproven = **std::max_element(members_.begin(), members_.end(), lessUnproven);
    if (unproven.unprovenBytes() > limit_ / kUnprovenShare) return unproven;
    return **std::max_element(members_.begin(), members_.end(), smaller);
  };
  for (size_t round = 0; round < 2 * members_.size(); ++round) {
    const size_t used = bytesLocked();
    if (used <= limit_) return;
    Member& member = mostGivingUp();
    const size_t before = member.heldBytes();
    member.release(used - limit_ + spare);
    // Others may have added to it meanwhile.
    const size_t after = member.heldBytes();
    if (after < before) releasedBytes_ += before - after;
  }
}

}  // namespace meshfront
