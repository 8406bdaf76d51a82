// First in, first out, fixed capacity. Two rules for "full", chosen at the call: push() refuses,
// push_overwrite() drops the oldest item and says so, so that the caller can count it.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/assert.h"
#include "core/base/status.h"

namespace surefoot {

template <class T, std::size_t kCapacity>
class RingBuffer {
  static_assert(kCapacity > 0);

 public:
  static constexpr std::size_t capacity() { return kCapacity; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == kCapacity; }

  // kExhausted: full, nothing changed.
  constexpr Status push(const T& value) {
    if (full()) return Status::kExhausted;
    items_[(first_ + size_) % kCapacity] = value;
    ++size_;
    return Status::kOk;
  }
  // Returns true when the oldest item was dropped to make room.
  constexpr bool push_overwrite(const T& value) {
    const bool dropped = full();
    if (dropped) pop_front();
    items_[(first_ + size_) % kCapacity] = value;
    ++size_;
    return dropped;
  }
  constexpr void pop_front() {
    SUREFOOT_ASSERT(!empty());
    first_ = (first_ + 1) % kCapacity;
    --size_;
  }
  constexpr void clear() { first_ = size_ = 0; }

  // Index 0 is the oldest item.
  constexpr const T& operator[](std::size_t i) const {
    SUREFOOT_ASSERT(i < size_);
    return items_[(first_ + i) % kCapacity];
  }
  constexpr T& operator[](std::size_t i) {
    SUREFOOT_ASSERT(i < size_);
    return items_[(first_ + i) % kCapacity];
  }
  constexpr const T& front() const { return (*this)[0]; }
  constexpr const T& back() const { return (*this)[size_ - 1]; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace surefoot
