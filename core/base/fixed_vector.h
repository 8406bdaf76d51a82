// A vector whose capacity is part of its type. Never allocates. Full is a Status that changes
// nothing.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/assert.h"
#include "core/base/status.h"

namespace surefoot {

template <class T, std::size_t kCapacity>
class FixedVector {
 public:
  using value_type = T;

  static constexpr std::size_t capacity() { return kCapacity; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == kCapacity; }

  // kExhausted: the vector is full and unchanged.
  constexpr Status push_back(const T& value) {
    if (full()) return Status::kExhausted;
    items_[size_++] = value;
    return Status::kOk;
  }
  // Keeps the first `size` items; new items, if any, are value-initialised.
  // kExhausted: size is above the capacity, nothing changed.
  constexpr Status resize(std::size_t size) {
    if (size > kCapacity) return Status::kExhausted;
    for (std::size_t i = size_; i < size; ++i) items_[i] = T{};
    size_ = size;
    return Status::kOk;
  }
  constexpr void clear() { size_ = 0; }
  // As `=`, but touches only what is in use.
  constexpr void assign(const FixedVector& from) {
    for (std::size_t i = 0; i < from.size_; ++i) items_[i] = from.items_[i];
    size_ = from.size_;
  }

  constexpr T& operator[](std::size_t i) {
    SUREFOOT_ASSERT(i < size_);
    return items_[i];
  }
  constexpr const T& operator[](std::size_t i) const {
    SUREFOOT_ASSERT(i < size_);
    return items_[i];
  }
  constexpr T& back() { return (*this)[size_ - 1]; }
  constexpr const T& back() const { return (*this)[size_ - 1]; }

  constexpr T* data() { return items_.data(); }
  constexpr const T* data() const { return items_.data(); }
  constexpr T* begin() { return items_.data(); }
  constexpr T* end() { return items_.data() + size_; }
  constexpr const T* begin() const { return items_.data(); }
  constexpr const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t size_ = 0;
};

}  // namespace surefoot
