// The order of collapses: a 4-ary heap of (key, vertex), smallest first, equal keys by vertex. Keys
// are lower bounds; who pops one checks it and puts the vertex back if its cost has risen.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshfront {

class CollapseQueue {
 public:
  struct Entry {
    uint32_t key;
    uint32_t vertex;
  };

  void reserve(size_t entries) { heap_.reserve(entries); }
  // Adds without ordering; call order() before anything else.
  void append(Entry entry) { heap_.push_back(packed(entry)); }
  void order() {
    for (size_t i = heap_.size() / kArity + 1; i-- > 0;) {
      if (i < heap_.size()) siftDown(i, heap_[i]);
    }
  }
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  // Only if not empty.
  [[nodiscard]] Entry top() const {
    return {static_cast<uint32_t>(heap_[0] >> 32), static_cast<uint32_t>(heap_[0])};
  }
  // Only if not empty.
  void pop() {
    const uint64_t last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) siftDown(0, last);
  }
  void push(Entry entry) {
    const uint64_t value = packed(entry);
    size_t at = heap_.size();
    heap_.push_back(value);
    while (at > 0) {
      const size_t parent = (at - 1) / kArity;
      if (heap_[parent] <= value) break;
      heap_[at] = heap_[parent];
      at = parent;
    }
    heap_[at] = value;
  }

 private:
  static constexpr size_t kArity = 4;
  static uint64_t packed(Entry entry) { return uint64_t{entry.key} << 32 | entry.vertex; }
  // Puts `value` into the hole at `at` or below it.
  void siftDown(size_t at, uint64_t value) {
    const size_t size = heap_.size();
    for (;;) {
      const size_t first = at * kArity + 1;
      if (first >= size) break;
      const size_t end = std::min(first + kArity, size);
      size_t smallest = first;
      for (size_t child = first + 1; child < end; ++child) {
        if (heap_[child] < heap_[smallest]) smallest = child;
      }
      if (heap_[smallest] >= value) break;
      heap_[at] = heap_[smallest];
      at = smallest;
    }
    heap_[at] = value;
  }

  std::vector<uint64_t> heap_;
};

}  // namespace meshfront
