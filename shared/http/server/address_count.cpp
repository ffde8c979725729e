#include "shared/http/server/address_count.h"

namespace meshfront {

Admission AddressCount::open(const ClientOrigin& origin) {
  const size_t before = open_.fetch_add(1, std::memory_order_relaxed);
  size_t fromAddress = 0;
  {
    const std::scoped_lock lock(mutex_);
    fromAddress = ++byOrigin_[origin];
  }
  if (fromAddress > maxPerAddress_ + refusedAtMost(maxPerAddress_)) return Admission::closedAtOnce;
  if (fromAddress > maxPerAddress_) return Admission::tooManyFromAddress;
  return before >= maxConnections_ ? Admission::tooMany : Admission::granted;
}

void AddressCount::close(const ClientOrigin& origin) {
  {
    const std::scoped_lock lock(mutex_);
    const auto it = byOrigin_.find(origin);
    if (--it->second == 0) byOrigin_.erase(it);
  }
  open_.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace meshfront
