// A fixed number of slots, taken and given back in any order; an item never moves. A handle may
// outlive its item: it carries the slot's generation and finds nothing once the item is gone.
// The free slot with the lowest index is taken first, so that the order of slots depends on the
// order of calls only. Cost: acquire O(capacity / 64), the rest O(1).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/status.h"

namespace surefoot {

struct PoolHandle {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  // 0 is never in use: a default handle finds nothing

  constexpr bool operator==(const PoolHandle&) const = default;
};

template <class T, std::size_t kCapacity>
class Pool {
  static_assert(kCapacity > 0);

 public:
  static constexpr std::size_t capacity() { return kCapacity; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool full() const { return size_ == kCapacity; }

  // The new item is value-initialised. kExhausted: no free slot, nothing changed.
  constexpr Result<PoolHandle> acquire() {
    if (full()) return Status::kExhausted;
    const std::size_t index = lowest_free();
    used_[index / kBits] |= bit(index);
    if (++generations_[index] == 0) generations_[index] = 1;
    items_[index] = T{};
    ++size_;
    return PoolHandle{static_cast<std::uint32_t>(index), generations_[index]};
  }
  // kNotFound: the item is gone already, nothing changed.
  constexpr Status release(PoolHandle handle) {
    if (find(handle) == nullptr) return Status::kNotFound;
    used_[handle.index / kBits] &= ~bit(handle.index);
    --size_;
    return Status::kOk;
  }
  // Null when the item is gone.
  constexpr T* find(PoolHandle handle) { return holds(handle) ? &items_[handle.index] : nullptr; }
  constexpr const T* find(PoolHandle handle) const {
    return holds(handle) ? &items_[handle.index] : nullptr;
  }

  // For walking in index order: slots below capacity(), used or not.
  constexpr bool used(std::size_t index) const {
    SUREFOOT_ASSERT(index < kCapacity);
    return (used_[index / kBits] & bit(index)) != 0;
  }
  constexpr PoolHandle handle(std::size_t index) const {
    SUREFOOT_ASSERT(used(index));
    return {static_cast<std::uint32_t>(index), generations_[index]};
  }

 private:
  static constexpr std::size_t kBits = 64;
  static constexpr std::size_t kWords = (kCapacity + kBits - 1) / kBits;

  static constexpr std::uint64_t bit(std::size_t index) {
    return std::uint64_t{1} << (index % kBits);
  }
  constexpr bool holds(PoolHandle handle) const {
    return handle.index < kCapacity && used(handle.index) &&
           generations_[handle.index] == handle.generation;
  }
  constexpr std::size_t lowest_free() const {
    std::size_t word = 0;
    while (used_[word] == ~std::uint64_t{0}) ++word;  // ends: the caller checked full()
    return word * kBits + static_cast<std::size_t>(std::countr_one(used_[word]));
  }

  std::array<T, kCapacity> items_{};
  std::array<std::uint32_t, kCapacity> generations_{};
  std::array<std::uint64_t, kWords> used_{};
  std::size_t size_ = 0;
};

}  // namespace surefoot
