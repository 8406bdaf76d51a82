#include "core/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/hash.h"

namespace surefoot {
namespace {

// The first outputs of the reference program of PCG (pcg32-demo, seed 42, stream 54).
TEST(Random, MatchesThePublishedSequence) {
  constexpr std::array<std::uint32_t, 6> kExpected = {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u,
                                                      0x83d2f293u, 0xbfa4784bu, 0xcbed606eu};
  Random random(42, 54);
  for (const std::uint32_t expected : kExpected) EXPECT_EQ(random.next_u32(), expected);
}

TEST(Random, StreamsAndSeedsDiffer) {
  Random a(1, 0);
  Random b(1, 1);
  Random c(2, 0);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t x = a.next_u32();
    const std::uint32_t y = b.next_u32();
    const std::uint32_t z = c.next_u32();
    equal += (x == y) + (x == z);
  }
  EXPECT_LE(equal, 1);
}

// Chi-squared over 64 cells: 63 degrees of freedom, standard deviation sqrt(126) = 11.2. Limits at
// four of them on both sides: too even is as wrong as too uneven.
void expect_even(const std::array<int, 64>& counts, int draws) {
  const double expected = draws / 64.0;
  double chi_squared = 0;
  for (const int count : counts) chi_squared += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_squared, 63 + 4 * 11.2);
  EXPECT_GT(chi_squared, 63 - 4 * 11.2);
}

TEST(Random, BelowIsEvenAndWithinBounds) {
  constexpr int kDraws = 640000;
  Random random(3);
  std::array<int, 64> counts{};
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t cell = random.below(64);
    ASSERT_LT(cell, 64u);
    ++counts[cell];
  }
  expect_even(counts, kDraws);
  EXPECT_EQ(random.below(1), 0u);
}

TEST(Random, UniformIsEvenAndWithinBounds) {
  constexpr int kDraws = 640000;
  Random random(4);
  std::array<int, 64> counts{};
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-2.0, 6.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 6.0);
    ++counts[static_cast<std::size_t>((value + 2.0) * 8.0)];
  }
  expect_even(counts, kDraws);
}

TEST(Random, NormalHasTheStatedMoments) {
  constexpr int kDraws = 400000;
  Random random(5);
  double sum = 0;
  double squares = 0;
  double fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    ASSERT_LE(value * value, 36.0);
    sum += value;
    squares += value * value;
    fourth += value * value * value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 4 / 632.0);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.01);
  EXPECT_NEAR(fourth / kDraws, 2.9, 0.06);  // twelve uniforms: 3 - 6 / (5 * 12)
}

TEST(Random, RepeatsInConstantExpressions) {
  constexpr std::uint32_t at_compile_time = [] {
    Random random(9, 2);
    random.next_u32();
    return random.next_u32();
  }();
  Random random(9, 2);
  random.next_u32();
  EXPECT_EQ(random.next_u32(), at_compile_time);
}

// Published FNV-1a test vectors (Fowler, Noll, Vo).
TEST(Fnv64, MatchesThePublishedVectors) {
  const auto hash = [](const char* text, std::size_t size) {
    Fnv64 fnv;
    for (std::size_t i = 0; i < size; ++i) fnv.byte(static_cast<std::uint8_t>(text[i]));
    return fnv.value();
  };
  EXPECT_EQ(hash("", 0), 0xcbf29ce484222325ull);
  EXPECT_EQ(hash("a", 1), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hash("foobar", 6), 0x85944171f73967e8ull);
}

TEST(Fnv64, WordsAreLittleEndianAndChainsContinue) {
  Fnv64 words;
  words.word(0x0403020100ull, 5);
  Fnv64 bytes;
  constexpr std::array<std::uint8_t, 5> kBytes = {0, 1, 2, 3, 4};
  bytes.bytes(kBytes.data(), kBytes.size());
  EXPECT_EQ(words.value(), bytes.value());
  Fnv64 resumed(words.value());
  resumed.byte(9);
  words.byte(9);
  EXPECT_EQ(resumed.value(), words.value());
}

}  // namespace
}  // namespace surefoot
