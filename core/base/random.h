// Integer random numbers with the same sequence on every machine (the standard's distributions are
// not specified bit for bit). PCG-XSH-RR 64/32, O'Neill 2014. 16 bytes of state.
// Never draw twice inside one expression: the order of evaluation is the compiler's.
#pragma once

#include <cstdint>

namespace surefoot {

class Random {
 public:
  // Different streams of one seed are independent sequences.
  constexpr explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(0), increment_((stream << 1u) | 1u) {
    next_u32();
    state_ += seed;
    next_u32();
  }

  constexpr std::uint32_t next_u32() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    const auto rotation = static_cast<std::uint32_t>(old >> 59u);
    return (xorshifted >> rotation) | (xorshifted << ((32u - rotation) & 31u));
  }
  // Uniform in [0, bound) by multiply and shift; the bias is below 2^-32 * bound.
  constexpr std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next_u32()) * bound) >> 32u);
  }
  // Uniform in [0, 1), 32 bits of resolution.
  constexpr double uniform() { return static_cast<double>(next_u32()) * 0x1p-32; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Mean 0, variance 1: the sum of twelve uniforms (Irwin-Hall), bounded by +-6. Exact adds only,
  // no libm, and the cut tails are a virtue here: no sample can be absurd.
  constexpr double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
  std::uint64_t increment_;
};

}  // namespace surefoot
