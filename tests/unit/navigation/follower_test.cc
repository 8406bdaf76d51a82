#include "core/navigation/path_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/base/random.h"
#include "core/navigation/navigator.h"
#include "tests/support/samples.h"
#include "tests/unit/navigation/parts.h"
#include "tests/unit/navigation/world.h"

namespace surefoot::navigation {
namespace {

constexpr double kTick_s = 0.005;

// A winding path along x: smooth curves of `wave_m` length and `swing_m` to either side.
Path winding(double length_m, double wave_m, double swing_m) {
  Path path;
  double along = 0;
  for (double x = 0; x < length_m; x += 0.1) {
    const double k = 2 * M_PI / wave_m;
    PathPoint point;
    point.p_O_m = Vector2(x, swing_m * std::sin(k * x));
    const double slope = swing_m * k * std::cos(k * x);
    point.tangent_O = Vector2(1, slope).normalized();
    point.curvature_1_m = -swing_m * k * k * std::sin(k * x) / std::pow(1 + slope * slope, 1.5);
    if (!path.empty()) along += (point.p_O_m - path.back().p_O_m).norm();
    point.along_m = along;
    EXPECT_TRUE(ok(path.push_back(point)));
  }
  return path;
}

struct Body {
  RobotPose pose;
  VelocityCommand real;

  void move(const VelocityCommand& command, Random& random, double noise) {
    const double share = kTick_s / 0.15;
    real.forward_m_s += share * (command.forward_m_s - real.forward_m_s);
    real.left_m_s += share * (command.left_m_s - real.left_m_s);
    real.yaw_rate_rad_s += share * (command.yaw_rate_rad_s - real.yaw_rate_rad_s);
    const double c = std::cos(pose.yaw_rad);
    const double s = std::sin(pose.yaw_rad);
    const double left = real.left_m_s + noise * random.normal();
    pose.p_O_m +=
        Vector2(c * real.forward_m_s - s * left, s * real.forward_m_s + c * left) * kTick_s;
    pose.yaw_rad += (real.yaw_rate_rad_s + noise * random.normal()) * kTick_s;
  }
};

double tracking_rms_m(const NavigationConfig& config, const Path& path) {
  const auto follower = std::make_unique<PathFollower>();
  const auto objects = std::make_unique<objects::Objects>();
  follower->reset(config);
  follower->set_path(&path);
  Random random(3);
  Body body;
  double sum2 = 0;
  int count = 0;
  for (int tick = 0; tick < 40000; ++tick) {
    const TimeNs stamp = milliseconds(5) * tick;
    const VelocityCommand command = follower->follow(body.pose, *objects, stamp);
    body.move(command, random, 0.2);
    if (follower->to_end_m() < 0.3) break;
    if (tick < 400) continue;
    sum2 += follower->off_path_m() * follower->off_path_m();
    ++count;
  }
  EXPECT_LT(follower->to_end_m(), 0.3);
  return std::sqrt(sum2 / count);
}

TEST(PathFollower, KeepsToWindingPathsWithinFiveCentimetres) {
  EXPECT_LT(tracking_rms_m(test::small_robot(), winding(20, 6, 0.8)), 0.05);
  EXPECT_LT(tracking_rms_m(test::large_robot(), winding(40, 16, 2.0)), 0.05);
}

TEST(PathFollower, ComesBackFromFarAndFromFacingAway) {
  const auto follower = std::make_unique<PathFollower>();
  const auto objects = std::make_unique<objects::Objects>();
  const Path path = winding(15, 1000, 0);
  for (const double y : {-2.0, -0.6, 0.6, 2.0}) {
    for (const double yaw : {0.0, 3.0, -2.0}) {
      follower->reset(test::small_robot());
      follower->set_path(&path);
      Random random(1);
      Body body;
      body.pose.p_O_m = Vector2(1, y);
      body.pose.yaw_rad = yaw;
      for (int tick = 0; tick < 4000; ++tick) {
        body.move(follower->follow(body.pose, *objects, milliseconds(5) * tick), random, 0);
      }
      EXPECT_LT(std::abs(follower->off_path_m()), 0.05) << y << " " << yaw;
      EXPECT_GT(body.pose.p_O_m[0], 3) << y << " " << yaw;
    }
  }
}

TEST(PathFollower, StopsBeforeWhatStandsOnThePath) {
  const auto follower = std::make_unique<PathFollower>();
  const auto objects = std::make_unique<objects::Objects>();
  for (const NavigationConfig& config : {test::small_robot(), test::large_robot()}) {
    const Path path = winding(15, 1000, 0);
    objects->clear();
    objects::Object post;
    post.centre_O_m = Vector2(8, 0.1);
    ASSERT_TRUE(ok(post.points_O_m.push_back(post.centre_O_m)));
    ASSERT_TRUE(ok(objects->push_back(post)));
    follower->reset(config);
    follower->set_path(&path);
    Random random(1);
    Body body;
    for (int tick = 0; tick < 8000; ++tick) {
      const VelocityCommand command = follower->follow(body.pose, *objects, milliseconds(5) * tick);
      // What braking needs never exceeds the free way but by 5 cm.
      EXPECT_LE(command.forward_m_s * command.forward_m_s,
                2 * config.follow.braking_m_s2 * (follower->free_m() + 0.05));
      body.move(command, random, 0);
    }
    EXPECT_EQ(follower->reason(), SpeedReason::kBlocked);
    EXPECT_LT(body.pose.p_O_m[0] + config.half_length_m, 8);
    EXPECT_GT(body.pose.p_O_m[0] + config.half_length_m, 7);
  }
}

TEST(NearObjects, KeepsTheNearestUpToTheBound) {
  const auto objects = std::make_unique<objects::Objects>();
  const auto near = std::make_unique<NearObjects>();
  Random random(9);
  for (std::size_t i = 0; i < objects::kMaxObjects; ++i) {
    objects::Object object;
    object.moving = i % 8 == 0;
    object.centre_O_m[0] = random.uniform(-6, 6);
    object.centre_O_m[1] = random.uniform(-6, 6);
    ASSERT_TRUE(ok(object.points_O_m.resize(objects::kMaxObjectPoints)));
    ASSERT_TRUE(ok(objects->push_back(object)));
  }
  near->gather(*objects, Vector2::Zero(), 10, false);
  std::size_t points = 0;
  double farthest_m = 0;
  for (const objects::Object* object : near->standing()) {
    points += object->points_O_m.size();
    farthest_m = std::max(farthest_m, object->centre_O_m.norm());
  }
  EXPECT_EQ(points, NearObjects::kMaxPoints);
  EXPECT_EQ(near->moving().size(), NearObjects::kMaxMoving);
  std::size_t nearer = 0;
  for (const objects::Object& object : *objects) {
    if (!object.moving && object.centre_O_m.norm() < farthest_m - 0.25) ++nearer;
  }
  EXPECT_LE(nearer, near->standing().size());  // none left out but in the last ring
}

TEST(PathFollower, ChangesPathsWithoutAStepOfTheCommand) {
  const auto follower = std::make_unique<PathFollower>();
  const auto objects = std::make_unique<objects::Objects>();
  follower->reset(test::small_robot());
  const Path a = winding(15, 1000, 0);
  const Path b = winding(15, 5, 0.9);
  Random random(1);
  Body body;
  VelocityCommand last;
  for (int tick = 0; tick < 4000; ++tick) {
    if (tick % 200 == 0) follower->set_path(tick % 400 == 0 ? &a : &b);
    const VelocityCommand now = follower->follow(body.pose, *objects, milliseconds(5) * tick);
    EXPECT_LE(std::abs(now.forward_m_s - last.forward_m_s), 0.05);
    EXPECT_LE(std::abs(now.left_m_s - last.left_m_s), 0.05);
    EXPECT_LE(std::abs(now.yaw_rate_rad_s - last.yaw_rate_rad_s), 0.05);
    last = now;
    body.move(now, random, 0);
  }
}

// Also without a goal.
TEST(WalkerAvoidance, MakesWayWhileStanding) {
  for (int i = 0; i < 12; ++i) {
    const double from = M_PI / 6 * i;
    const auto navigator = std::make_unique<Navigator>();
    const NavigationConfig config = test::small_robot();
    ASSERT_TRUE(ok(navigator->reset(config)));
    const auto objects = std::make_unique<objects::Objects>();
    Random random(1);
    Body body;
    double least = 10;
    for (int tick = 0; tick < 2400; ++tick) {
      const TimeNs stamp = milliseconds(5) * tick;
      const Vector2 towards(-std::cos(from), -std::sin(from));
      const Vector2 p = -towards * 5.0 + towards * (tick * kTick_s);
      objects->clear();
      objects::Object walker;
      walker.moving = true;
      walker.last_seen = stamp;
      walker.centre_O_m = p;
      walker.velocity_O_m_s = towards;
      ASSERT_TRUE(ok(walker.points_O_m.push_back(p + Vector2(0.25, 0))));
      ASSERT_TRUE(ok(objects->push_back(walker)));
      body.move(navigator->follow(body.pose, *objects, stamp), random, 0);
      least = std::min(least, test::gap_to_point(config, body.pose, p) - 0.25);
    }
    EXPECT_GT(least, 0.05) << i;
    EXPECT_GT(navigator->status().counters.steps_aside, 0u);
  }
}

TEST(Navigator, RefusesWhatIsOutOfItsDomainAndKeepsTheGoal) {
  const auto navigator = std::make_unique<Navigator>();
  NavigationConfig config = test::small_robot();
  config.map.cell_m = std::nan("");
  EXPECT_EQ(navigator->reset(config), Status::kInvalid);
  ASSERT_TRUE(ok(navigator->reset(test::small_robot())));
  EXPECT_EQ(navigator->set_goal(Vector2(std::nan(""), 0)), Status::kInvalid);
  EXPECT_EQ(navigator->set_goal(Vector2(1e6, 0)), Status::kOutOfRange);
  EXPECT_EQ(navigator->status().state, NavigationState::kIdle);
  ASSERT_TRUE(ok(navigator->set_goal(Vector2(5, 0))));
  EXPECT_EQ(navigator->set_goal(Vector2(0, INFINITY)), Status::kInvalid);
  EXPECT_EQ(navigator->status().state, NavigationState::kGoing);
}

TEST(Navigator, DropsAPlanForAnotherGoal) {
  const auto navigator = std::make_unique<Navigator>();
  const auto objects = std::make_unique<objects::Objects>();
  ASSERT_TRUE(ok(navigator->reset(test::small_robot())));
  ASSERT_TRUE(ok(navigator->set_goal(Vector2(5, 0))));
  ASSERT_TRUE(navigator->release(*objects, RobotPose{}, TimeNs{}));
  navigator->run();
  ASSERT_TRUE(ok(navigator->set_goal(Vector2(-5, 0))));
  navigator->publish();
  EXPECT_EQ(navigator->status().counters.plans_dropped, 1u);
  EXPECT_TRUE(navigator->path().empty());
  navigator->plan(*objects, RobotPose{}, milliseconds(1000));
  ASSERT_FALSE(navigator->path().empty());
  EXPECT_LT((navigator->path().back().p_O_m - Vector2(-5, 0)).norm(), 0.05);
}

// The published path is the follower's own: planning on does not touch it.
TEST(Navigator, GivesTheSameBitsTwice) {
  std::vector<double> runs[2];
  for (auto& run : runs) {
    test::World world;
    world.circles.push_back({Vector2(4, 0.1), 0.3});
    test::RunOptions options;
    options.config = test::small_robot();
    options.goal = Vector2(8, 0);
    for (const Vector2& p : test::Simulation(world, options).run().trail) {
      run.push_back(p[0]);
      run.push_back(p[1]);
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
}

}  // namespace
}  // namespace surefoot::navigation
