// The memory that answers of the upstream take while they are fetched and put together, of all
// requests together: what the cache holds is counted elsewhere (MemoryBudget). A request that finds
// none left fails with ErrorCode::overloaded - 503 with Retry-After - and gives back what it had,
// so that the others go on; waiting for more while holding some would let all of them wait.
//
// Counted are contents as they come in, the records read from them, and the tables that say what a
// request lacks and where its records are: about 90 octets a record. The default lets one request
// of the largest size (ServerLimits::maxRecords) through, or thousands of usual ones.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>

#include "shared/result.h"

namespace meshfront {

class FetchMemory {
 public:
  explicit FetchMemory(size_t limit) : limit_(limit) {}
  FetchMemory(const FetchMemory&) = delete;
  FetchMemory& operator=(const FetchMemory&) = delete;

  // What one holder takes; given back by its destructor. Movable, not thread-safe; the memory must
  // outlive it. An empty share takes nothing and refuses nothing.
  class Share {
   public:
    Share() = default;
    explicit Share(FetchMemory& memory) : memory_(&memory) {}
    Share(Share&& other) noexcept { *this = std::move(other); }
    Share& operator=(Share&& other) noexcept {
      std::swap(memory_, other.memory_);
      std::swap(granted_, other.granted_);
      std::swap(used_, other.used_);
      return *this;
    }
    // A copy of what is counted is not counted again: its share is empty.
    Share(const Share& /*other*/) {}
    Share& operator=(const Share&) = delete;
    ~Share() {
      if (memory_ != nullptr) memory_->taken_ -= granted_;
    }
    // False where there is not as much left; the share then is as it was.
    [[nodiscard]] bool take(size_t bytes) {
      if (memory_ == nullptr || bytes <= granted_ - used_) {
        used_ += memory_ == nullptr ? 0 : bytes;
        return true;
      }
      const size_t lacking = bytes - (granted_ - used_);
      // By steps, so that most calls touch nothing that is shared.
      for (const size_t wish : {std::max(lacking, kStep), lacking}) {
        if (!memory_->grant(wish)) continue;
        granted_ += wish;
        used_ += bytes;
        return true;
      }
      return false;
    }
    // What take() could give at most just now.
    [[nodiscard]] size_t left() const {
      if (memory_ == nullptr) return SIZE_MAX;
      const size_t taken = memory_->taken_;
      return granted_ - used_ + (taken < memory_->limit_ ? memory_->limit_ - taken : 0);
    }

   private:
    static constexpr size_t kStep = size_t{64} << 10;
    FetchMemory* memory_ = nullptr;
    size_t granted_ = 0;
    size_t used_ = 0;
  };

  [[nodiscard]] Share share() { return Share(*this); }
  [[nodiscard]] size_t bytes() const { return taken_; }
  [[nodiscard]] size_t limit() const { return limit_; }

 private:
  [[nodiscard]] bool grant(size_t bytes) {
    size_t taken = taken_;
    do {
      if (bytes > limit_ - std::min(taken, limit_)) return false;
    } while (!taken_.compare_exchange_weak(taken, taken + bytes));
    return true;
  }
  const size_t limit_;
  std::atomic<size_t> taken_{0};
};

[[nodiscard]] inline tl::unexpected<Error> noFetchMemory() {
  return fail(ErrorCode::overloaded, "too much is being fetched at once; try again later");
}

}  // namespace meshfront
