#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/base/fixed_vector.h"
#include "core/base/random.h"
#include "core/base/ring_buffer.h"

namespace surefoot {
namespace {

TEST(FixedVector, RefusesWhatDoesNotFitAndStaysAsItWas) {
  FixedVector<int, 3> v;
  EXPECT_TRUE(v.empty());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(v.push_back(i), Status::kOk);
  EXPECT_TRUE(v.full());
  EXPECT_EQ(v.push_back(7), Status::kExhausted);
  EXPECT_EQ(v.resize(4), Status::kExhausted);
  EXPECT_EQ(v.size(), 3u);
  EXPECT_EQ(v.back(), 2);
}

TEST(FixedVector, ResizeClearsWhatItUncovers) {
  FixedVector<int, 4> v;
  ASSERT_EQ(v.resize(4), Status::kOk);
  for (int& item : v) item = 9;
  ASSERT_EQ(v.resize(1), Status::kOk);
  ASSERT_EQ(v.resize(3), Status::kOk);
  EXPECT_EQ(v[0], 9);
  EXPECT_EQ(v[1], 0);
  EXPECT_EQ(v[2], 0);
}

TEST(FixedVector, WorksInConstantExpressions) {
  constexpr int sum = [] {
    FixedVector<int, 5> v;
    for (int i = 1; i <= 5; ++i) {
      if (!ok(v.push_back(i))) return -1;
    }
    int total = 0;
    for (const int item : v) total += item;
    return total;
  }();
  static_assert(sum == 15);
}

TEST(FixedVectorDeathTest, IndexBeyondTheSizeIsAProgrammersError) {
  FixedVector<int, 4> v;
  ASSERT_EQ(v.push_back(1), Status::kOk);
  EXPECT_DEATH(v[1] = 2, "i < size_");
  v.clear();
  EXPECT_DEATH(static_cast<void>(v.back()), "i < size_");
}

TEST(RingBuffer, KeepsOrderWhileTheStartMoves) {
  RingBuffer<int, 3> ring;
  EXPECT_EQ(ring.push(1), Status::kOk);
  EXPECT_EQ(ring.push(2), Status::kOk);
  EXPECT_EQ(ring.push(3), Status::kOk);
  EXPECT_EQ(ring.push(4), Status::kExhausted);
  EXPECT_EQ(ring.back(), 3);
  EXPECT_TRUE(ring.push_overwrite(4));
  EXPECT_EQ(ring.front(), 2);
  EXPECT_EQ(ring.back(), 4);
  ring.pop_front();
  EXPECT_FALSE(ring.push_overwrite(5));
  EXPECT_EQ(ring[0], 3);
  EXPECT_EQ(ring[1], 4);
  EXPECT_EQ(ring[2], 5);
}

TEST(RingBuffer, AgreesWithADequeUnderRandomOperations) {
  RingBuffer<std::uint32_t, 7> ring;
  std::deque<std::uint32_t> expected;
  Random random(5);
  for (int step = 0; step < 20000; ++step) {
    const std::uint32_t value = random.next_u32();
    switch (random.below(3)) {
      case 0: {
        const Status status = ring.push(value);
        ASSERT_EQ(ok(status), expected.size() < 7);
        if (ok(status)) expected.push_back(value);
        break;
      }
      case 1: {
        const bool dropped = ring.push_overwrite(value);
        ASSERT_EQ(dropped, expected.size() == 7);
        if (dropped) expected.pop_front();
        expected.push_back(value);
        break;
      }
      default:
        if (expected.empty()) break;
        ring.pop_front();
        expected.pop_front();
    }
    ASSERT_EQ(ring.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(ring[i], expected[i]);
  }
}

TEST(RingBufferDeathTest, TakingFromAnEmptyOneIsAProgrammersError) {
  RingBuffer<int, 2> ring;
  EXPECT_DEATH(ring.pop_front(), "empty");
  EXPECT_DEATH(static_cast<void>(ring.front()), "i < size_");
}

}  // namespace
}  // namespace surefoot
