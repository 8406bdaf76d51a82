// Plans of a robot that stands nearer to something than its clearance.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/math/elementary.h"
#include "core/navigation/planner.h"
#include "tests/unit/navigation/parts.h"

namespace surefoot::navigation {
namespace {

constexpr double kRing_m = 0.75;

// A ring of posts around (kRing_m, 0), with an opening of this width towards the origin.
objects::Objects ring(double opening_m) {
  objects::Objects objects;
  EXPECT_EQ(objects.resize(1), Status::kOk);
  objects::Object& posts = objects[0];
  posts.kind = objects::ObjectClass::kObstacle;
  for (int i = 0; i < 60; ++i) {
    const double angle_rad = math::kTwoPi * i / 60;
    const Vector2 p(kRing_m - kRing_m * std::cos(angle_rad), kRing_m * std::sin(angle_rad));
    const bool opens = p[0] < 0.5 * kRing_m && std::fabs(p[1]) < 0.5 * opening_m;
    if (opens) continue;
    EXPECT_EQ(posts.points_O_m.push_back(p), Status::kOk);
  }
  return objects;
}

Plan plan_from(const Vector2& robot_O_m, const objects::Objects& objects) {
  const auto planner = std::make_unique<Planner>();
  planner->reset(test::small_robot());
  const auto input = std::make_unique<PlanInput>();
  input->goal_O_m = Vector2(-5, 0);
  input->robot.p_O_m = robot_O_m;
  input->past_O_m = robot_O_m;
  input->stamp = milliseconds(1000);
  input->objects = objects;
  Plan plan;
  planner->run(*input, plan);
  EXPECT_TRUE(planner->map().lethal_at(robot_O_m));
  return plan;
}

// In a doorway, a little nearer to the room without another door than to the outside.
TEST(WayOut, LeavesToWhereItLeadsOn) {
  const Plan plan = plan_from(Vector2(0.05, 0), ring(0.5));
  ASSERT_EQ(plan.outcome, PlanOutcome::kPath);
  EXPECT_TRUE(plan.to_goal);
  for (const PathPoint& point : plan.path) EXPECT_LT(point.p_O_m[0], 0.1);
}

TEST(WayOut, DoesNotLeadThroughWhatStandsNear) {
  const Plan plan = plan_from(Vector2(0.2, 0), ring(0.0));
  EXPECT_EQ(plan.outcome, PlanOutcome::kRobotEnclosed);
  EXPECT_TRUE(plan.path.empty());
}

}  // namespace
}  // namespace surefoot::navigation
