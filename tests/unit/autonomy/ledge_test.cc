// The edge finder against edges whose place is known exactly.
#include "core/autonomy/ledge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/support/ledge_map.h"
#include "tests/support/samples.h"

namespace surefoot::autonomy {
namespace {

using tests::kCell_m;
using tests::window_of;

// A half plane that rises (or falls) beyond a straight edge: its distance ahead of the origin along
// its normal, and the normal's heading. A cell that the higher side reaches into has its height.
struct Edge {
  double distance_m = 0;
  double yaw_rad = 0;
  double rise_m = 0;
  double gap_m = 0;  // above 0: a ditch of that width and depth -rise_m
};

LedgeQuery query() {
  LedgeQuery q;
  q.from_m = 0.24;
  q.half_width_m = 0.18;
  q.min_rise_m = 0.11;
  q.min_drop_m = 0.10;
  return q;
}

// How far beyond the edge the farthest corner of a cell reaches.
double beyond(const Edge& edge, double x, double y) {
  const double c = std::cos(edge.yaw_rad);
  const double s = std::sin(edge.yaw_rad);
  return c * x + s * y - edge.distance_m + 0.5 * kCell_m * (std::fabs(c) + std::fabs(s));
}
double before(const Edge& edge, double x, double y) {
  const double c = std::cos(edge.yaw_rad);
  const double s = std::sin(edge.yaw_rad);
  return edge.distance_m - (c * x + s * y) + 0.5 * kCell_m * (std::fabs(c) + std::fabs(s));
}

double height(const Edge& edge, double x, double y) {
  if (edge.gap_m <= 0) return beyond(edge, x, y) > 0 ? edge.rise_m : 0.0;
  Edge far = edge;
  far.distance_m += edge.gap_m;
  return before(edge, x, y) > 0 || beyond(far, x, y) > 0 ? 0.0 : edge.rise_m;
}

TEST(Ledge, FindsPlatformsWhereTheyAre) {
  Random random(3);
  double worst_m = 0;
  double sum_m = 0;
  const int draws = tests::samples(2000, 100);
  for (int i = 0; i < draws; ++i) {
    Edge edge;
    edge.distance_m = random.uniform(0.30, 0.62);
    edge.yaw_rad = random.uniform(-0.25, 0.25);
    edge.rise_m = random.uniform(0.125, 0.30);
    Random noise(static_cast<std::uint64_t>(i), 9);
    const auto window = window_of(0.0, 0.0, [&](double x, double y) {
      const double z = height(edge, x, y) + 0.003 * noise.normal();
      return noise.uniform() < 0.02 ? std::nan("") : z;
    });
    const Result<Ledge> found = find_ledge(*window, query());
    ASSERT_TRUE(found.ok()) << i;
    const Ledge& ledge = found.value();
    EXPECT_EQ(ledge.kind, Ledge::Kind::kPlatform);
    EXPECT_NEAR(ledge.yaw_rad, edge.yaw_rad, 0.06) << i;
    EXPECT_NEAR(ledge.rise_m, edge.rise_m, 0.004) << i;
    const double off_m = ledge.distance_m(0.0, 0.0) - edge.distance_m;
    worst_m = std::max(worst_m, std::fabs(off_m));
    sum_m += off_m;
  }
  EXPECT_LT(worst_m, 0.012);
  EXPECT_NEAR(sum_m / draws, 0.0, 0.003);
}

TEST(Ledge, FindsGapsAndTheirWidth) {
  Random random(4);
  for (int i = 0; i < tests::samples(1000, 60); ++i) {
    Edge edge;
    edge.distance_m = random.uniform(0.30, 0.40);
    edge.yaw_rad = random.uniform(-0.15, 0.15);
    edge.rise_m = -random.uniform(0.15, 0.5);
    edge.gap_m = random.uniform(0.08, 0.22);
    Random noise(static_cast<std::uint64_t>(i), 9);
    const auto window = window_of(
        0.0, 0.0, [&](double x, double y) { return height(edge, x, y) + 0.003 * noise.normal(); });
    const Result<Ledge> found = find_ledge(*window, query());
    ASSERT_TRUE(found.ok()) << i;
    EXPECT_EQ(found.value().kind, Ledge::Kind::kGap);
    EXPECT_NEAR(found.value().yaw_rad, edge.yaw_rad, 0.06);
    EXPECT_NEAR(found.value().rise_m, 0.0, 0.004);
    EXPECT_NEAR(found.value().distance_m(0.0, 0.0), edge.distance_m, 0.015);
    EXPECT_NEAR(found.value().gap_m, edge.gap_m, 0.02);
  }
}

TEST(Ledge, TheQuerysPlaceAndHeadingDoNotMatter) {
  Random random(5);
  for (int i = 0; i < tests::samples(300, 20); ++i) {
    Edge edge;
    edge.distance_m = random.uniform(-3.0, 3.0);
    edge.yaw_rad = random.uniform(-3.1, 3.1);
    edge.rise_m = 0.2;
    LedgeQuery q = query();
    const double c = std::cos(edge.yaw_rad);
    const double s = std::sin(edge.yaw_rad);
    const double to_go = random.uniform(0.30, 0.55);
    const double along = random.uniform(-2.0, 2.0);
    q.x_O_m = c * (edge.distance_m - to_go) - s * along;
    q.y_O_m = s * (edge.distance_m - to_go) + c * along;
    q.yaw_rad = edge.yaw_rad + random.uniform(-0.2, 0.2);
    const auto window =
        window_of(q.x_O_m, q.y_O_m, [&](double x, double y) { return height(edge, x, y); });
    const Result<Ledge> found = find_ledge(*window, q);
    ASSERT_TRUE(found.ok()) << i;
    EXPECT_NEAR(found.value().distance_m(q.x_O_m, q.y_O_m), to_go, 0.012) << i;
    EXPECT_NEAR(std::remainder(found.value().yaw_rad - edge.yaw_rad, 2 * M_PI), 0.0, 0.06) << i;
  }
}

TEST(Ledge, SeesNoneWhereThereIsNone) {
  const auto none = [](auto ground) {
    const auto window = window_of(0.0, 0.0, ground);
    return find_ledge(*window, query()).status();
  };
  EXPECT_EQ(none([](double, double) { return 0.0; }), Status::kNotFound);
  EXPECT_EQ(none([](double, double) { return std::nan(""); }), Status::kNotFound);
  EXPECT_EQ(none([](double x, double) { return 0.27 * x; }), Status::kNotFound);  // 15 degrees
  EXPECT_EQ(none([](double x, double) { return -0.27 * x; }), Status::kNotFound);
  EXPECT_EQ(none([](double x, double) { return x > 0.4 ? 0.10 : 0.0; }), Status::kNotFound);
  // Narrower than the robot: an obstacle, not a platform.
  EXPECT_EQ(none([](double x, double y) { return x > 0.4 && std::fabs(y) < 0.1 ? 0.2 : 0.0; }),
            Status::kNotFound);
  // A corner ahead.
  EXPECT_EQ(none([](double x, double y) { return x > 0.4 + std::fabs(y) ? 0.2 : 0.0; }),
            Status::kNotFound);
  EXPECT_EQ(find_ledge(mapping::MapWindow{}, query()).status(), Status::kUnavailable);
}

// The robot stands on something when it first sees the platform.
TEST(Ledge, MeasuresFromTheGroundBeforeTheEdge) {
  const auto window = window_of(0.0, 0.0, [](double x, double) {
    if (x > 0.5) return 0.13;
    return x < 0.3 ? 0.05 : 0.0;
  });
  LedgeQuery q = query();
  q.ground_z_m = 0.05;
  const Result<Ledge> found = find_ledge(*window, q);
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found.value().rise_m, 0.13, 1e-6);
  EXPECT_NEAR(found.value().edge_O_m[2], 0.0, 1e-6);
}

TEST(Landing, MustBeSeenLevelAndFree) {
  LandingArea area;
  area.from_m = 0.04;
  area.length_m = 0.3;
  area.half_width_m = 0.18;
  area.max_error_m = 0.035;
  area.min_known = 0.6;
  const auto free = [&](auto ground) {
    const auto window = window_of(0.0, 0.0, ground);
    const Result<Ledge> found = find_ledge(*window, query());
    return found.ok() && landing_is_free(*window, found.value(), 0.0, area);
  };
  const auto platform = [](double x) { return x > 0.34 ? 0.13 : 0.0; };
  EXPECT_TRUE(free([&](double x, double) { return platform(x); }));
  EXPECT_FALSE(free([&](double x, double y) {
    return std::hypot(x - 0.6, y - 0.15) < 0.03 ? 0.20 : platform(x);
  })) << "a post";
  EXPECT_FALSE(free([&](double x, double y) {
    return std::hypot(x - 0.6, y - 0.15) < 0.03 ? 0.05 : platform(x);
  })) << "a hole";
  EXPECT_FALSE(free([&](double x, double) { return x > 0.5 ? std::nan("") : platform(x); }));
  EXPECT_FALSE(free([&](double x, double) { return x > 0.55 ? 0.0 : platform(x); })) << "short";
}

}  // namespace
}  // namespace surefoot::autonomy
