// An array of plain values that grows for as long as a mesh is refined: like std::vector, but its
// bytes are known exactly, large ones grow in steps of 2 MiB and in place (no copy, no moment in
// which both copies are held), and elements of 64 bytes lie in one cache line.
//
// Up to kMappedFrom bytes it is an ordinary allocation that doubles; from there on a mapping of
// which the kernel gives pages as they are touched, large ones where it has them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

namespace meshfront {

// The storage behind it. Throws std::bad_alloc where there is no memory.
class GrowingBytes {
 public:
  static constexpr size_t kMappedFrom = size_t{1} << 20;
  static constexpr size_t kStep = size_t{2} << 20;

  GrowingBytes() = default;
  GrowingBytes(GrowingBytes&& other) noexcept { swap(other); }
  GrowingBytes& operator=(GrowingBytes&& other) noexcept {
    swap(other);
    return *this;
  }
  GrowingBytes(const GrowingBytes&) = delete;
  GrowingBytes& operator=(const GrowingBytes&) = delete;
  ~GrowingBytes();

  [[nodiscard]] void* data() const { return data_; }  // aligned to 64 bytes
  [[nodiscard]] size_t capacity() const { return capacity_; }
  // The capacity that grow() would lead to.
  [[nodiscard]] size_t capacityFor(size_t bytes) const;
  // Room for that many bytes at least; contents are kept, what is new is arbitrary.
  void grow(size_t bytes);

 private:
  void swap(GrowingBytes& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(mapped_, other.mapped_);
  }

  void* data_ = nullptr;
  size_t capacity_ = 0;
  size_t mapped_ = 0;  // bytes of address space; 0: an ordinary allocation
};

template <typename T>
class GrowingArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  GrowingArray() = default;
  GrowingArray(GrowingArray&& other) noexcept
      : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)) {}
  GrowingArray& operator=(GrowingArray&& other) noexcept {
    bytes_ = std::move(other.bytes_);
    std::swap(size_, other.size_);
    return *this;
  }
  GrowingArray(const GrowingArray& other) { *this = other; }
  GrowingArray& operator=(const GrowingArray& other) {
    if (this == &other) return *this;
    size_ = other.size_;
    if (size_ == 0) return *this;
    bytes_.grow(size_ * sizeof(T));
    std::memcpy(bytes_.data(), other.bytes_.data(), size_ * sizeof(T));
    return *this;
  }
  ~GrowingArray() = default;

  [[nodiscard]] size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] T* data() { return static_cast<T*>(bytes_.data()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(bytes_.data()); }
  [[nodiscard]] T& operator[](size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](size_t i) const { return data()[i]; }
  [[nodiscard]] std::span<const T> span() const { return {data(), size_}; }

  void push_back(const T& value) {
    const T copy = value;  // it may lie in here
    append() = copy;
  }
  // One more, of arbitrary content.
  T& append() {
    if ((size_ + 1) * sizeof(T) > bytes_.capacity()) bytes_.grow((size_ + 1) * sizeof(T));
    return data()[size_++];
  }
  void resize(size_t size, const T& value = T{}) {
    const T copy = value;
    if (size * sizeof(T) > bytes_.capacity()) bytes_.grow(size * sizeof(T));
    if (size > size_) std::fill(data() + size_, data() + size, copy);
    size_ = size;
  }
  // Bytes held, and those that would be held with that many elements.
  [[nodiscard]] size_t memoryBytes() const { return bytes_.capacity(); }
  [[nodiscard]] size_t memoryBytesFor(size_t size) const {
    return bytes_.capacityFor(size * sizeof(T));
  }

 private:
  GrowingBytes bytes_;
  size_t size_ = 0;
};

}  // namespace meshfront
