// The memory that the chunk indexes of all packs may take together.
//
// Locking: enforce() takes the budget's lock, then a member's. A member therefore never calls it
// while it holds its own lock.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

namespace meshfront {

class IndexBudget {
 public:
  class Member {
   public:
    Member() = default;
    virtual ~Member() = default;
    Member(const Member&) = delete;
    Member& operator=(const Member&) = delete;
    [[nodiscard]] virtual size_t indexBytes() const = 0;
    // Gives up at least `bytes` if it has them.
    virtual void evictIndex(size_t bytes) = 0;
  };

  explicit IndexBudget(size_t limit) : limit_(limit) {}

  // A member joins and leaves itself; it must have left before it is destroyed.
  void join(Member* member);
  void leave(Member* member);

  // Lets the largest members evict until all fit. Between the growth of a member and this call the
  // limit is exceeded by the index of a chunk for each thread.
  void enforce();
  [[nodiscard]] size_t bytes() const;

 private:
  [[nodiscard]] size_t bytesLocked() const;

  const size_t limit_;
  mutable std::mutex mutex_;
  std::vector<Member*> members_;
};

}  // namespace meshfront
