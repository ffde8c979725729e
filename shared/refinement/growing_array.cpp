#include "shared/refinement/growing_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace meshfront {
namespace {

constexpr size_t kAlignment = 64;
constexpr size_t kLeast = 1024;
// Address space costs nothing; a mapping that outgrows its own is moved, page tables alone.
constexpr size_t kReservedTimes = 16;

size_t roundedUp(size_t bytes, size_t step) {
  return (bytes + step - 1) / step * step;
}

// Address space that starts at a multiple of a large page, so that it can be made of them; null
// where there is none.
void* mapAligned(size_t bytes) {
  const size_t all = bytes + GrowingBytes::kStep;
  void* whole = mmap(nullptr, all, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (whole == MAP_FAILED) return nullptr;
  const auto begin = reinterpret_cast<uintptr_t>(whole);
  const uintptr_t aligned = roundedUp(begin, GrowingBytes::kStep);
  if (aligned > begin) munmap(whole, aligned - begin);
  const uintptr_t end = begin + all;
  if (end > aligned + bytes)
    munmap(reinterpret_cast<void*>(aligned + bytes), end - aligned - bytes);
  madvise(reinterpret_cast<void*>(aligned), bytes, MADV_HUGEPAGE);
  return reinterpret_cast<void*>(aligned);
}

}  // namespace

GrowingBytes::~GrowingBytes() {
  if (mapped_ != 0) {
    munmap(data_, mapped_);
  } else {
    std::free(data_);
  }
}

size_t GrowingBytes::capacityFor(size_t bytes) const {
  if (bytes <= capacity_) return capacity_;
  if (bytes > kMappedFrom) return roundedUp(bytes, kStep);
  size_t capacity = std::max(capacity_, kLeast);
  while (capacity < bytes) capacity *= 2;
  return capacity;
}

void GrowingBytes::grow(size_t bytes) {
  if (bytes <= capacity_) return;
  const size_t capacity = capacityFor(bytes);
  if (capacity <= mapped_) {
    capacity_ = capacity;
    return;
  }
  if (bytes <= kMappedFrom) {
    void* grown = std::aligned_alloc(kAlignment, capacity);
    if (grown == nullptr) throw std::bad_alloc();
    if (capacity_ != 0) std::memcpy(grown, data_, capacity_);
    std::free(data_);
    data_ = grown;
    capacity_ = capacity;
    return;
  }
  size_t mapped = capacity * kReservedTimes;
  void* grown = mapAligned(mapped);
  while (grown == nullptr && mapped > capacity) grown = mapAligned(mapped /= 2);
  if (grown == nullptr) throw std::bad_alloc();
  if (mapped_ != 0) {
    // Over the front of the new one: its pages come along.
    if (mremap(data_, mapped_, mapped_, MREMAP_MAYMOVE | MREMAP_FIXED, grown) == MAP_FAILED) {
      munmap(grown, mapped);
      throw std::bad_alloc();
    }
  } else if (capacity_ != 0) {
    std::memcpy(grown, data_, capacity_);
    std::free(data_);
  }
  data_ = grown;
  mapped_ = mapped;
  capacity_ = capacity;
}

}  // namespace meshfront
