// FNV-1a, 64 bits: the hash of every chain and state digest. Fed little-endian, field by field, so
// that padding and byte order never enter. Not cryptographic: it finds differences, not forgers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace surefoot {

class Fnv64 {
 public:
  constexpr explicit Fnv64(std::uint64_t state = kOffset) : state_(state) {}

  constexpr void byte(std::uint8_t value) { state_ = (state_ ^ value) * kPrime; }
  constexpr void bytes(const std::uint8_t* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) byte(data[i]);
  }
  // Little-endian, `size` low bytes of value.
  constexpr void word(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  constexpr std::uint64_t value() const { return state_; }

 private:
  static constexpr std::uint64_t kOffset = 0xcbf29ce484222325ull;
  static constexpr std::uint64_t kPrime = 0x100000001b3ull;
  std::uint64_t state_;
};

}  // namespace surefoot
