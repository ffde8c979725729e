// The nodes that a view asks for and that have not been sent, by their order: a queue of buckets.
// What is below a node never ranks before it, so that the best bucket only moves on, and taking and
// adding cost a few instructions whatever is in it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshfront::evaluation {

class CandidateQueue {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] size_t size() const { return size_; }

  // Smaller buckets come first; one that is past counts as the present one.
  void add(uint32_t node, uint32_t bucket) {
    bucket = std::max(bucket, first_);
    if (bucket >= heads_.size()) heads_.resize(bucket + 1, kEnd);
    uint32_t place = free_;
    if (place == kEnd) {
      place = static_cast<uint32_t>(entries_.size());
      entries_.push_back({});
    } else {
      free_ = entries_[place].next;
    }
    entries_[place] = {node, heads_[bucket]};
    heads_[bucket] = place;
    ++size_;
  }
  // Appends up to `most` nodes of the best bucket; at least one unless it is empty.
  void take(size_t most, std::vector<uint32_t>& out) {
    if (size_ == 0) return;
    while (heads_[first_] == kEnd) ++first_;
    uint32_t place = heads_[first_];
    for (size_t i = 0; i < most && place != kEnd; ++i) {
      out.push_back(entries_[place].node);
      const uint32_t next = entries_[place].next;
      entries_[place].next = free_;
      free_ = place;
      place = next;
      --size_;
    }
    heads_[first_] = place;
  }
  // Calls visit(node) for all, and is empty afterwards; keeps its memory.
  template <typename Visit>
  void drain(const Visit& visit) {
    for (uint32_t& head : heads_) {
      for (uint32_t place = head; place != kEnd; place = entries_[place].next)
        visit(entries_[place].node);
      head = kEnd;
    }
    entries_.clear();
    free_ = kEnd;
    first_ = 0;
    size_ = 0;
  }
  // Gives its memory back; empty only.
  void release() { *this = {}; }
  [[nodiscard]] size_t memoryBytes() const {
    return heads_.capacity() * sizeof(uint32_t) + entries_.capacity() * sizeof(Entry);
  }

 private:
  static constexpr uint32_t kEnd = UINT32_MAX;
  struct Entry {
    uint32_t node = 0;
    uint32_t next = kEnd;
  };
  std::vector<uint32_t> heads_;  // by bucket
  std::vector<Entry> entries_;
  uint32_t free_ = kEnd;
  uint32_t first_ = 0;
  size_t size_ = 0;
};

}  // namespace meshfront::evaluation
