// Sorts things into one bucket a vertex, in linear time: the base of all matching of faces and
// edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshfront {

class VertexBuckets {
 public:
  // Item i of 0 .. itemCount - 1 goes to bucket vertexOf(i) < vertexCount; order within is kept.
  template <typename VertexOf>
  VertexBuckets(size_t vertexCount, uint32_t itemCount, const VertexOf& vertexOf)
      : starts_(vertexCount + 1), items_(itemCount) {
    for (uint32_t i = 0; i < itemCount; ++i) ++starts_[vertexOf(i)];
    uint32_t sum = 0;
    for (uint32_t& start : starts_) start = sum += start;  // ends; filling turns them into starts
    for (uint32_t i = itemCount; i-- > 0;) items_[--starts_[vertexOf(i)]] = i;
  }

  [[nodiscard]] size_t count() const { return starts_.size() - 1; }
  [[nodiscard]] std::span<const uint32_t> operator[](size_t vertex) const {
    return std::span(items_).subspan(starts_[vertex], starts_[vertex + 1] - starts_[vertex]);
  }

 private:
  std::vector<uint32_t> starts_;
  std::vector<uint32_t> items_;
};

}  // namespace meshfront
