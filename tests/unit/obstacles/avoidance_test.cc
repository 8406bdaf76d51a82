#include "core/obstacles/avoidance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/unit/obstacles/windows.h"

namespace surefoot::obstacles {
namespace {

constexpr Footprint kRobot{0.19, 0.13};

Avoidance make() {
  Avoidance avoidance;
  avoidance.reset(test::config(), kRobot);
  return avoidance;
}

Field at(double x, double y) { return {Vector2(x, y), 0}; }

// The front of a box: a row of fields across the way.
Fields face(double x, double y0, double y1) {
  Fields fields;
  for (double y = y0; y <= y1 + 1e-9; y += 0.08) EXPECT_TRUE(ok(fields.push_back(at(x, y))));
  return fields;
}

Wish ahead(double speed_m_s, double off_path_m = 0) {
  return {Vector2(speed_m_s, 0), Vector2(1, 0), off_path_m};
}

TEST(Avoidance, ThePushIsTheNegativeGradientOfThePotential) {
  const Avoidance avoidance = make();
  Random random(13);
  for (int sample = 0; sample < tests::samples(2000, 50); ++sample) {
    Fields fields;
    for (int i = 0; i < 5; ++i) {
      const double x = random.uniform(-0.8, 0.8);
      const double y = random.uniform(-0.8, 0.8);
      ASSERT_TRUE(ok(fields.push_back(at(x, y))));
    }
    RobotPlace place;
    place.yaw_rad = random.uniform(-3.1, 3.1);
    constexpr double kStep_m = 1e-6;
    Vector2 slope;
    for (int axis = 0; axis < 2; ++axis) {
      RobotPlace low = place;
      RobotPlace high = place;
      low.p_O_m[axis] -= kStep_m;
      high.p_O_m[axis] += kStep_m;
      slope[axis] =
          (avoidance.potential(fields, high) - avoidance.potential(fields, low)) / (2 * kStep_m);
    }
    const Vector2 push = avoidance.push_O_m_s(fields, place);
    ASSERT_NEAR(push[0], -slope[0], 1e-5);
    ASSERT_NEAR(push[1], -slope[1], 1e-5);
  }
}

TEST(Avoidance, FreeSpaceIsMeasuredFromTheCapsule) {
  const Avoidance avoidance = make();
  Fields fields;
  ASSERT_TRUE(ok(fields.push_back(at(0.5, 0))));
  // 2 x 0.04 + 0.13 + 0.02 of room.
  EXPECT_NEAR(avoidance.free_space_m(fields, {}), 0.5 - 0.19 - 0.23, 1e-12);
  EXPECT_NEAR(avoidance.free_space_m(fields, {Vector2(0.5, -0.3), 0.0}), 0.3 - 0.23, 1e-12);
  EXPECT_NEAR(avoidance.free_space_m(fields, {Vector2(0.5, -0.5), 1.5707963267948966}),
              0.5 - 0.19 - 0.23, 1e-9);
  EXPECT_EQ(avoidance.free_space_m(fields, {Vector2(-2, 0), 0.0}), test::config().reach_m);
  EXPECT_EQ(avoidance.potential(fields, {Vector2(-2, 0), 0.0}), 0.0);
}

TEST(Avoidance, WithoutAFieldInReachTheWishIsUntouched) {
  Avoidance avoidance = make();
  Fields fields;
  const Wish wish{Vector2(0.123456789, -0.0987654321), Vector2(1, 0), 0.0};
  EXPECT_EQ(avoidance.velocity_O_m_s(fields, {}, wish), wish.velocity_O_m_s);
  ASSERT_TRUE(ok(fields.push_back(at(1.5, 0))));
  ASSERT_TRUE(ok(fields.push_back(at(-0.9, 0.1))));
  EXPECT_EQ(avoidance.velocity_O_m_s(fields, {}, wish), wish.velocity_O_m_s);
  EXPECT_EQ(avoidance.side(), 0);
}

TEST(Avoidance, PassesOnTheSideOfTheShorterDetourAndKeepsIt) {
  Avoidance avoidance = make();
  const Fields fields = face(0.7, -0.1, 0.3);
  EXPECT_LT(avoidance.velocity_O_m_s(fields, {}, ahead(0.4))[1], 0);
  EXPECT_EQ(avoidance.side(), -1);
  // More of it comes into view on that side: it does not dither.
  EXPECT_LT(avoidance.velocity_O_m_s(face(0.7, -0.5, 0.3), {}, ahead(0.4))[1], 0);
  EXPECT_EQ(avoidance.side(), -1);
  // Past it there is no side any more.
  static_cast<void>(avoidance.velocity_O_m_s(fields, {Vector2(1.2, -0.5), 0.0}, ahead(0.4)));
  EXPECT_EQ(avoidance.side(), 0);
}

TEST(Avoidance, HeadOnItDoesNotStall) {
  Avoidance avoidance = make();
  const Fields fields = face(0.6, -0.16, 0.16);
  const Vector2 v = avoidance.velocity_O_m_s(fields, {}, ahead(0.4));
  EXPECT_GT(std::fabs(v[1]), 0.1);
}

TEST(Avoidance, ApproachesNoFasterThanTheFreeSpaceAllows) {
  Random random(14);
  const ObstacleConfig config = test::config();
  for (int sample = 0; sample < tests::samples(2000, 50); ++sample) {
    Avoidance avoidance = make();
    Fields fields;
    const double x = random.uniform(-0.6, 0.6);
    const double y = random.uniform(-0.6, 0.6);
    ASSERT_TRUE(ok(fields.push_back(at(x, y))));
    const double yaw = random.uniform(-3.1, 3.1);
    const double vx = random.uniform(-1.0, 1.0);
    const double vy = random.uniform(-1.0, 1.0);
    const RobotPlace place{Vector2::Zero(), yaw};
    const double free_m = avoidance.free_space_m(fields, place);
    const Vector2 v = avoidance.velocity_O_m_s(fields, place, {Vector2(vx, vy), Vector2(1, 0), 0});
    if (free_m >= config.reach_m) continue;
    // Speed at which the free space shrinks, by a difference.
    constexpr double kStep_s = 1e-6;
    const RobotPlace next{v * kStep_s, yaw};
    const double rate = (free_m - avoidance.free_space_m(fields, next)) / kStep_s;
    ASSERT_LE(rate, config.approach_gain_1_s * std::max(free_m, 0.0) + 1e-4);
    ASSERT_LE(v.norm(), 0.51);  // the bounds' corner
  }
}

// A body that follows the command with the robot's acceleration, past boxes at random: it touches
// none and gets by. Fields as the pool makes them of the box's outline.
TEST(Avoidance, ABodyWithInertiaGetsPastABoxWithoutTouchingIt) {
  Random random(15);
  for (int sample = 0; sample < tests::samples(300, 10); ++sample) {
    const double y = random.uniform(-0.3, 0.3);
    const double turn = random.uniform(-0.8, 0.8);
    const double half = random.uniform(0.05, 0.2);
    Fields fields;
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    for (int i = 0; i < 400; ++i) {
      const int edge = i / 100;
      const double u = half * (0.02 * (i % 100) - 1.0);
      const double a = edge == 0 ? u : edge == 1 ? half : edge == 2 ? -u : -half;
      const double b = edge == 0 ? -half : edge == 1 ? u : edge == 2 ? half : -u;
      const Vector2 p(1.5 + c * a - s * b, y + s * a + c * b);
      bool near = false;
      for (const Field& f : fields) near = near || (f.centre_O_m - p).norm() < 0.08;
      if (near) continue;
      ASSERT_TRUE(ok(fields.push_back(at(p[0], p[1]))));
    }
    Avoidance avoidance = make();
    Vector2 p = Vector2::Zero();
    Vector2 v = Vector2::Zero();
    for (int tick = 0; tick < 10000 && p[0] < 3.0; ++tick) {
      const double back = std::clamp(-p[1], -0.2, 0.2);
      const Wish wish{Vector2(0.4, back), Vector2(1, 0), p[1]};
      const Vector2 wanted = avoidance.velocity_O_m_s(fields, {p, 0.0}, wish);
      for (int axis = 0; axis < 2; ++axis) {
        v[axis] += std::clamp(wanted[axis] - v[axis], -0.0016, 0.0016);
      }
      p += v * 0.002;
      for (int k = 0; k <= 20; ++k) {
        const double along = kRobot.half_length_m * (0.1 * k - 1.0);
        const Vector2 off(p[0] + along - 1.5, p[1] - y);
        const double du = std::max(std::fabs(c * off[0] + s * off[1]) - half, 0.0);
        const double dv = std::max(std::fabs(c * off[1] - s * off[0]) - half, 0.0);
        ASSERT_GT(std::hypot(du, dv), kRobot.radius_m) << "box at y = " << y << ", turn " << turn;
      }
    }
    EXPECT_GE(p[0], 3.0) << "box at y = " << y << ", turn " << turn;
  }
}

// The stated trap: a pocket deeper than what is in reach at its mouth. It stands, and touches
// nothing; the mission's live lock ends it.
TEST(Avoidance, InAPocketItStandsStillAndTouchesNothing) {
  Avoidance avoidance = make();
  Fields fields = face(1.5, -0.56, 0.56);
  for (int side = -1; side <= 1; side += 2) {
    for (int k = 1; k <= 10; ++k) {
      ASSERT_TRUE(ok(fields.push_back(at(1.5 - 0.09 * k, 0.56 * side))));
    }
  }
  Vector2 p = Vector2::Zero();
  for (int tick = 0; tick < 20000; ++tick) {
    const double back = std::clamp(-p[1], -0.2, 0.2);
    p += 0.002 *
         avoidance.velocity_O_m_s(fields, {p, 0.0}, {Vector2(0.4, back), Vector2(1, 0), p[1]});
    ASSERT_GT(avoidance.free_space_m(fields, {p, 0.0}), -0.02);
  }
  EXPECT_LT(p[0], 1.5);
}

}  // namespace
}  // namespace surefoot::obstacles
