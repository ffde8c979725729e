// Memory that several holders may take together: the indexes of all packs of a service, the records
// and documents of a proxy.
//
// Locking: enforce() takes the budget's lock, then a member's. A member therefore never calls it
// while it holds a lock of its own.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace meshfront {

class MemoryBudget {
 public:
  class Member {
   public:
    Member() = default;
    virtual ~Member() = default;
    Member(const Member&) = delete;
    Member& operator=(const Member&) = delete;
    [[nodiscard]] virtual size_t heldBytes() const = 0;
    // Of these, what nobody has asked for again: such goes first, whoever holds it.
    [[nodiscard]] virtual size_t unprovenBytes() const { return 0; }
    // Gives up about `bytes`, or all it has.
    virtual void release(size_t bytes) = 0;
  };

  explicit MemoryBudget(size_t limit) : limit_(limit) {}

  // A member joins and leaves itself; it must have left before it is destroyed.
  void join(Member* member);
  void leave(Member* member);

  // Lets the members give up memory until all fit: who holds most that is unproven, while that is
  // much, else the largest. Called after growth, so that the limit
  // is exceeded in between by what each thread has just added.
  void enforce();
  [[nodiscard]] size_t bytes() const;
  [[nodiscard]] size_t limit() const { return limit_; }
  // Given up so far because of enforce().
  [[nodiscard]] uint64_t releasedBytes() const { return releasedBytes_.load(); }

 private:
  [[nodiscard]] size_t bytesLocked() const;

  const size_t limit_;
  mutable std::mutex mutex_;
  std::vector<Member*> members_;
  std::atomic<uint64_t> releasedBytes_{0};
};

}  // namespace meshfront
