#include "core/runtime/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"

namespace surefoot::runtime {
namespace {

TEST(DurationHistogram, EmptyIsZero) {
  const DurationHistogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.quantile(0.5).ns, 0);
}

TEST(DurationHistogram, OneValueIsExact) {
  for (const std::int64_t ns : {0, 1, 31, 32, 33, 1000, 999'999, 123'456'789}) {
    DurationHistogram histogram;
    histogram.add({ns});
    EXPECT_EQ(histogram.quantile(0.0).ns, ns);
    EXPECT_EQ(histogram.quantile(0.5).ns, ns);
    EXPECT_EQ(histogram.quantile(1.0).ns, ns);
    EXPECT_EQ(histogram.maximum().ns, ns);
  }
}

// Against the sorted values: never below the true quantile, at most one bucket (1/31) above.
TEST(DurationHistogram, QuantilesAreWithinOneBucket) {
  Random random(3);
  for (int scale = 4; scale < 35; scale += 3) {
    DurationHistogram histogram;
    std::vector<std::int64_t> values;
    for (int i = 0; i < 2000; ++i) {
      const auto shift = static_cast<unsigned>(scale);
      const auto value = static_cast<std::int64_t>(random.uniform() *
                                                   static_cast<double>(std::uint64_t{1} << shift));
      values.push_back(value);
      histogram.add({value});
    }
    std::sort(values.begin(), values.end());
    for (const double q : {0.01, 0.5, 0.9, 0.99, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(q * 2000.0)));
      const auto exact = static_cast<double>(values[rank - 1]);
      const auto found = static_cast<double>(histogram.quantile(q).ns);
      EXPECT_GE(found, exact) << scale << " " << q;
      EXPECT_LE(found, exact * (1.0 + 1.0 / 31.0) + 1e-9) << scale << " " << q;
    }
  }
}

TEST(DurationHistogram, ExtremesStayInside) {
  DurationHistogram histogram;
  histogram.add({-5});
  histogram.add({INT64_MAX});
  EXPECT_EQ(histogram.count(), 2u);
  EXPECT_EQ(histogram.quantile(0.5).ns, 0);
  EXPECT_EQ(histogram.maximum().ns, INT64_MAX);
}

}  // namespace
}  // namespace surefoot::runtime
