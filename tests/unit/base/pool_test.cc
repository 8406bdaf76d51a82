#include "core/base/pool.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>

#include "core/base/random.h"

namespace surefoot {
namespace {

TEST(Pool, TakesTheLowestFreeSlotAndRefusesWhenFull) {
  Pool<int, 3> pool;
  const PoolHandle a = pool.acquire().value();
  const PoolHandle b = pool.acquire().value();
  const PoolHandle c = pool.acquire().value();
  EXPECT_EQ(a.index, 0u);
  EXPECT_EQ(b.index, 1u);
  EXPECT_EQ(c.index, 2u);
  EXPECT_EQ(pool.acquire().status(), Status::kExhausted);
  EXPECT_EQ(pool.release(b), Status::kOk);
  EXPECT_EQ(pool.acquire().value().index, 1u);
}

TEST(Pool, AStaleHandleFindsNothing) {
  Pool<int, 2> pool;
  EXPECT_EQ(pool.find(PoolHandle{}), nullptr);
  const PoolHandle first = pool.acquire().value();
  *pool.find(first) = 7;
  EXPECT_EQ(pool.release(first), Status::kOk);
  EXPECT_EQ(pool.find(first), nullptr);
  EXPECT_EQ(pool.release(first), Status::kNotFound);
  const PoolHandle second = pool.acquire().value();
  EXPECT_EQ(second.index, first.index);
  EXPECT_EQ(pool.find(first), nullptr);
  EXPECT_EQ(*pool.find(second), 0);
  EXPECT_EQ(pool.find(PoolHandle{2, 1}), nullptr);
}

TEST(Pool, AgreesWithAMapUnderRandomOperations) {
  constexpr std::size_t kCapacity = 130;  // more than two words of the free map
  Pool<std::uint32_t, kCapacity> pool;
  std::map<std::uint32_t, PoolHandle> expected;  // by slot
  Random random(11);
  for (int step = 0; step < 20000; ++step) {
    const bool take = random.below(100) < (step / 2000 % 2 == 0 ? 70u : 30u);
    if (take) {
      const auto result = pool.acquire();
      ASSERT_EQ(result.ok(), expected.size() < kCapacity);
      if (!result.ok()) continue;
      ASSERT_FALSE(expected.contains(result.value().index));
      expected[result.value().index] = result.value();
      *pool.find(result.value()) = result.value().index * 3;
    } else if (!expected.empty()) {
      const auto victim = expected.lower_bound(random.below(kCapacity));
      if (victim == expected.end()) continue;
      ASSERT_EQ(pool.release(victim->second), Status::kOk);
      expected.erase(victim);
    }
    ASSERT_EQ(pool.size(), expected.size());
  }
  for (std::size_t i = 0; i < kCapacity; ++i) {
    const auto it = expected.find(static_cast<std::uint32_t>(i));
    ASSERT_EQ(pool.used(i), it != expected.end());
    if (it == expected.end()) continue;
    EXPECT_EQ(pool.handle(i), it->second);
    EXPECT_EQ(*pool.find(it->second), i * 3);
  }
}

}  // namespace
}  // namespace surefoot
