// Against the definition: a dense grid of points, each tested against the edges of the triangles.
#include "core/planning/support_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"

namespace surefoot::planning {
namespace {

Triangle triangle(double ax, double ay, double bx, double by, double cx, double cy) {
  return {{Vector2(ax, ay), Vector2(bx, by), Vector2(cx, cy)}};
}

Vector2 random_point(Random& random, double size) {
  Vector2 point;
  for (int axis = 0; axis < 2; ++axis) point[axis] = random.uniform(-size, size);
  return point;
}

Triangle random_triangle(Random& random) {
  Triangle result;
  for (Vector2& corner : result.corners_O_m) corner = random_point(random, 0.2);
  return result;
}

// Signed distance to the nearest edge by the sines of the angles, positive inside.
double depth_m(const Triangle& t, const Vector2& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto& c = t.corners_O_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2 edge = c[(i + 1) % 3] - c[i];
    const Vector2 to_p = p - c[i];
    const Vector2 to_third = c[(i + 2) % 3] - c[i];
    const double area_p = edge[0] * to_p[1] - edge[1] * to_p[0];
    const double area_third = edge[0] * to_third[1] - edge[1] * to_third[0];
    least = std::min(least, std::copysign(1.0, area_third) * area_p / edge.norm());
  }
  return least;
}

TEST(SupportRegion, NearestPointBeatsEveryPointOfADenseGrid) {
  Random random(5);
  int filled = 0;
  for (int draw = 0; draw < 200; ++draw) {
    std::vector<Triangle> triangles{random_triangle(random)};
    if (draw % 2 == 1) triangles.push_back(random_triangle(random));
    const double margin = random.uniform(0.0, 0.03);
    const Vector2 wanted = random_point(random, 0.4);
    SupportRegion region;
    for (const Triangle& t : triangles) ASSERT_EQ(region.add(t, margin), Status::kOk);
    double best = std::numeric_limits<double>::infinity();
    constexpr int kSide = 161;
    for (int k = 0; k < kSide * kSide; ++k) {
      const int column = k % kSide;
      const int row = k / kSide;
      const Vector2 p(-0.2 + 0.4 * column / (kSide - 1), -0.2 + 0.4 * row / (kSide - 1));
      double depth = std::numeric_limits<double>::infinity();
      for (const Triangle& t : triangles) depth = std::min(depth, depth_m(t, p));
      if (depth >= margin) best = std::min(best, (p - wanted).norm());
    }
    const Result<Vector2> nearest = region.nearest(wanted);
    if (!nearest.ok()) {
      EXPECT_EQ(best, std::numeric_limits<double>::infinity()) << "draw " << draw;
      continue;
    }
    ++filled;
    EXPECT_LE((nearest.value() - wanted).norm(), best + 1e-9) << "draw " << draw;
    for (const Triangle& t : triangles) EXPECT_GE(depth_m(t, nearest.value()), margin - 1e-8);
  }
  EXPECT_GT(filled, 50);
}

TEST(SupportRegion, PointInsideStaysWhereItIs) {
  SupportRegion region;
  ASSERT_EQ(region.add(triangle(0, 0, 1, 0, 0, 1), 0.1), Status::kOk);
  const Vector2 inside(0.25, 0.25);
  ASSERT_TRUE(region.nearest(inside).ok());
  EXPECT_EQ(region.nearest(inside).value(), inside);
}

TEST(SupportRegion, IsTheSameForEitherSenseOfTheCorners) {
  const Vector2 wanted(2.0, -1.0);
  SupportRegion left;
  SupportRegion right;
  ASSERT_EQ(left.add(triangle(0, 0, 1, 0, 0, 1), 0.05), Status::kOk);
  ASSERT_EQ(right.add(triangle(0, 0, 0, 1, 1, 0), 0.05), Status::kOk);
  EXPECT_NEAR((left.nearest(wanted).value() - right.nearest(wanted).value()).norm(), 0.0, 1e-12);
}

TEST(SupportRegion, EmptyFullAndFlatAreTold) {
  SupportRegion region;
  const Triangle small = triangle(0, 0, 1, 0, 0, 1);
  EXPECT_NEAR(small.inradius_m(), 1.0 / (2.0 + std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(region.add(triangle(0, 0, 1, 1, 2, 2), 0.0), Status::kInvalid);
  ASSERT_EQ(region.add(small, 0.0), Status::kOk);
  ASSERT_EQ(region.add(triangle(5, 0, 6, 0, 5, 1), 0.0), Status::kOk);
  EXPECT_EQ(region.nearest(Vector2::Zero()).status(), Status::kNotFound);
  EXPECT_EQ(region.add(small, 0.0), Status::kExhausted);
  SupportRegion drawn_in;
  ASSERT_EQ(drawn_in.add(small, small.inradius_m() * 1.01), Status::kOk);
  EXPECT_EQ(drawn_in.nearest(Vector2::Zero()).status(), Status::kNotFound);
}

// Every edge moves inwards by the margin.
TEST(SupportRegion, ATriangleIsDrawnInAlongItsEdges) {
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const Triangle t = random_triangle(random);
    const double room_m = t.inradius_m();
    if (room_m < 0.005) continue;
    const double margin_m = random.uniform(0.0, 0.9) * room_m;
    const Triangle inner = t.drawn_in(margin_m);
    EXPECT_NEAR(inner.inradius_m(), room_m - margin_m, 1e-9);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2 edge = (t.corners_O_m[(k + 1) % 3] - t.corners_O_m[k]).normalized();
      const Vector2 off = inner.corners_O_m[k] - t.corners_O_m[k];
      EXPECT_NEAR(std::abs(edge[0] * off[1] - edge[1] * off[0]), margin_m, 1e-9);
    }
    EXPECT_NEAR(t.drawn_in(2 * room_m).inradius_m(), 0.05 * room_m, 1e-9);
  }
  const Triangle line = triangle(0, 0, 1, 1, 2, 2);
  EXPECT_EQ(line.drawn_in(0.1).corners_O_m[2], line.corners_O_m[2]);
}

// Against points all over both triangles.
TEST(SupportRegion, DistanceOfTrianglesIsThatOfTheirNearestPoints) {
  constexpr int kParts = 24;
  Random random(12);
  int apart = 0;
  const auto points = [&](const Triangle& t) {
    std::vector<Vector2> result;
    for (int a = 0; a <= kParts; ++a) {
      for (int b = 0; a + b <= kParts; ++b) {
        result.push_back(
            (a * t.corners_O_m[0] + b * t.corners_O_m[1] + (kParts - a - b) * t.corners_O_m[2]) /
            kParts);
      }
    }
    return result;
  };
  for (int i = 0; i < 300; ++i) {
    const Triangle a = random_triangle(random);
    Triangle b = random_triangle(random);
    for (Vector2& corner : b.corners_O_m) corner[0] += 0.2;
    double least_m = 1;
    const std::vector<Vector2> of_b = points(b);
    for (const Vector2& p : points(a)) {
      for (const Vector2& q : of_b) least_m = std::min(least_m, (p - q).norm());
    }
    const double distance = distance_m(a, b);
    EXPECT_EQ(distance, distance_m(b, a));
    EXPECT_LE(distance, least_m + 1e-12);
    EXPECT_GE(distance, least_m - 0.6 / kParts);
    apart += distance > 0 ? 1 : 0;
  }
  EXPECT_GT(apart, 50);
  EXPECT_NEAR(distance_m(triangle(0, 0, 1, 0, 0, 1), triangle(1, 1, 2, 1, 1, 2)), std::sqrt(0.5),
              1e-12);
  EXPECT_NEAR(distance_m(triangle(0, 0, 1, 0, 0, 1), triangle(-1, -2, 3, -2, 0, -1)), 1.0, 1e-12);
}

}  // namespace
}  // namespace surefoot::planning
