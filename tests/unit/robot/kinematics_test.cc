#include "core/robot/kinematics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/random.h"
#include "tests/support/little_dog.h"
#include "tests/support/mini_cheetah.h"

namespace surefoot::robot {
namespace {

LegVector random_angles(Random& random) {
  LegVector q;
  q[0] = random.uniform(-0.8, 0.8);
  q[1] = random.uniform(-1.5, 0.6);
  q[2] = random.uniform(0.3, 2.6);
  return q;
}

TEST(Kinematics, ZeroAnglesHangStraightDown) {
  const RobotModel model = full_mini_cheetah();
  const Vector3 foot = foot_position_B_m(model, kHindLeft, LegVector::Zero());
  EXPECT_NEAR(foot[0], -0.19, 1e-15);
  EXPECT_NEAR(foot[1], 0.049 + 0.062 + 0.004, 1e-15);
  EXPECT_NEAR(foot[2], -0.404, 1e-15);
}

// research: stand (0, -0.8, 1.6) puts the foot 0.2815 m below the hip.
TEST(Kinematics, StandPoseMatchesThePublishedHeight) {
  const Vector3 foot = foot_position_B_m(full_mini_cheetah(), kFrontRight, {0.0, -0.8, 1.6});
  EXPECT_NEAR(foot[2], -0.2815, 1e-4);
}

TEST(Kinematics, JacobianAgreesWithFiniteDifferences) {
  const RobotModel model = full_mini_cheetah();
  Random random(1);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t leg = random.below(4);
    const LegVector q = random_angles(random);
    const Matrix3 jacobian = foot_jacobian_B(model, leg, q);
    for (int joint = 0; joint < 3; ++joint) {
      LegVector plus = q;
      LegVector minus = q;
      plus[joint] += kStep;
      minus[joint] -= kStep;
      const Vector3 difference =
          (foot_position_B_m(model, leg, plus) - foot_position_B_m(model, leg, minus)) /
          (2 * kStep);
      EXPECT_LT((difference - jacobian.col(joint)).norm(), 1e-9);
    }
  }
}

TEST(Kinematics, SolveInvertsForwardKinematics) {
  const RobotModel model = full_mini_cheetah();
  Random random(2);
  for (int trial = 0; trial < 5000; ++trial) {
    const std::size_t leg = random.below(4);
    const LegVector q = random_angles(random);
    // Above the hip a second solution exists: the solver's domain is the foot below the hip.
    if (0.209 * std::cos(q[1]) + 0.195 * std::cos(q[1] + q[2]) < 0.01) continue;
    const LegSolution solution = solve_leg(model, leg, foot_position_B_m(model, leg, q));
    EXPECT_EQ(solution.status, Status::kOk);
    EXPECT_LT((solution.q_rad - q).norm(), 1e-9) << q.transpose();
  }
}

TEST(Kinematics, TargetsOutOfReachArePulledOntoTheShellAndReported) {
  const RobotModel model = full_mini_cheetah();
  const Vector3 hip = hip_joint_B_m(model, kFrontLeft);
  const Vector3 target = hip + Vector3(0.3, 0.0, -0.5);
  const LegSolution solution = solve_leg(model, kFrontLeft, target);
  EXPECT_EQ(solution.status, Status::kOutOfRange);
  const Vector3 reached = foot_position_B_m(model, kFrontLeft, solution.q_rad) - hip;
  EXPECT_NEAR(reached.norm(), 0.403, 1e-9);
  EXPECT_NEAR(reached.normalized().dot((target - hip).normalized()), 1.0, 1e-9);
}

TEST(Kinematics, ATargetOnTheAbductionAxisStillGivesFiniteAngles) {
  const RobotModel model = full_mini_cheetah();
  const LegSolution solution = solve_leg(model, kHindRight, abduction_joint_B_m(model, kHindRight));
  EXPECT_EQ(solution.status, Status::kOutOfRange);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(solution.q_rad[i]));
}

TEST(Kinematics, CanReachWhatTheSolverReaches) {
  const RobotModel model = little_dog();
  Random random(6);
  int reached = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::size_t leg = random.below(4);
    Vector3 p = hip_joint_B_m(model, leg);
    for (int i = 0; i < 3; ++i) p[i] += random.uniform(-0.15, 0.15);
    const bool solved = solve_leg(model, leg, p).status == Status::kOk;
    EXPECT_EQ(can_reach(model, leg, p, 0.0), solved) << p.transpose();
    reached += solved ? 1 : 0;
  }
  EXPECT_GT(reached, 2000);
}

TEST(Kinematics, AMarginOfReachIsLeftAtBothEnds) {
  const RobotModel model = little_dog();
  const Vector3 hip = hip_joint_B_m(model, kHindLeft);
  const auto reach = [&](double depth_m) {
    return can_reach(model, kHindLeft, hip - Vector3(0.0, 0.0, depth_m), 0.01);
  };
  EXPECT_FALSE(reach(0.1661 + 1e-6));  // 0.1771 less 1 mm less the margin
  EXPECT_TRUE(reach(0.1661 - 1e-6));
  EXPECT_TRUE(reach(0.0379 + 1e-6));  // 0.0269 and as much
  EXPECT_FALSE(reach(0.0379 - 1e-6));
}

// A robot whose hind legs mirror the front ones.
TEST(Kinematics, HindLegsMirrorTheFrontOnesWhereTheirKneesPointForward) {
  const RobotModel model = little_dog();
  Random random(7);
  for (int trial = 0; trial < 1000; ++trial) {
    const std::array<double, 3> pose{random.uniform(-0.6, 0.6), random.uniform(-1.2, 0.2),
                                     random.uniform(0.3, 2.4)};
    const auto foot = [&](std::size_t leg) {
      const std::array<double, 3> q = model.pose_of(leg, pose);
      return foot_position_B_m(model, leg, {q[0], q[1], q[2]});
    };
    const Vector3 front = foot(kFrontLeft);
    EXPECT_LT((foot(kHindLeft) - Vector3(-front[0], front[1], front[2])).norm(), 1e-15);
    EXPECT_LT((foot(kHindRight) - Vector3(-front[0], -front[1], front[2])).norm(), 1e-15);
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      const std::array<double, 3> q = model.pose_of(leg, pose);
      for (std::size_t i = 0; i < kJointsPerLeg; ++i) {
        const JointRange range = model.joint_range(joint_index(leg, i));
        EXPECT_TRUE(q[i] >= range.min_rad && q[i] <= range.max_rad);
      }
      if (0.0751 * std::cos(q[1]) + 0.102 * std::cos(q[1] + q[2]) < 0.01) continue;
      const LegSolution solution = solve_leg(model, leg, foot(leg));
      EXPECT_EQ(solution.status, Status::kOk);
      EXPECT_LT((solution.q_rad - LegVector(q[0], q[1], q[2])).norm(), 1e-9);
    }
  }
}

// A body's inertia as seen in a mirror: the products with the mirrored axis change sign.
TEST(Kinematics, LinksAreMirroredWithTheirLegs) {
  const RobotModel model = little_dog();
  const Link link{1.0, {1, 2, 3}, {10, 11, 12, 4, 5, 6}};
  const Link front_right = model.link_of(kFrontRight, link);
  EXPECT_EQ(front_right.centre_of_mass_m, (std::array<double, 3>{1, -2, 3}));
  EXPECT_EQ(front_right.inertia_kg_m2, (std::array<double, 6>{10, 11, 12, -4, 5, -6}));
  const Link hind_left = model.link_of(kHindLeft, link);
  EXPECT_EQ(hind_left.centre_of_mass_m, (std::array<double, 3>{-1, 2, 3}));
  EXPECT_EQ(hind_left.inertia_kg_m2, (std::array<double, 6>{10, 11, 12, -4, -5, 6}));
  const Link trotter = full_mini_cheetah().link_of(kHindLeft, link);
  EXPECT_EQ(trotter.inertia_kg_m2, link.inertia_kg_m2);
}

TEST(Kinematics, ShankAngularVelocityAgreesWithTheMovingKneeAndFoot) {
  const RobotModel model = full_mini_cheetah();
  Random random(3);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 500; ++trial) {
    const LegVector q = random_angles(random);
    LegVector qd;
    for (int i = 0; i < 3; ++i) qd[i] = random.uniform(-5.0, 5.0);
    const LegPoints now = leg_points_B(model, kFrontLeft, q);
    const LegPoints next = leg_points_B(model, kFrontLeft, q + qd * kStep);
    const LegPoints last = leg_points_B(model, kFrontLeft, q - qd * kStep);
    const Vector3 shank = now.p_B_m[3] - now.p_B_m[2];
    const Vector3 rate =
        ((next.p_B_m[3] - next.p_B_m[2]) - (last.p_B_m[3] - last.p_B_m[2])) / (2 * kStep);
    EXPECT_LT((shank_angular_velocity_B(q, qd).cross(shank) - rate).norm(), 1e-8);
  }
}

// Every joint of every leg in turn, next to either of its stops; the others in the middle.
TEST(Kinematics, WithinStopsLeavesItsMarginToEitherStop) {
  constexpr double kMargin_rad = 0.03;
  constexpr double kLittle_rad = 1e-9;
  for (const RobotModel& model : {little_dog(), full_mini_cheetah()}) {
    std::array<double, kJointsPerLeg> middle{};
    for (std::size_t i = 0; i < kJointsPerLeg; ++i) {
      middle[i] = 0.5 * (model.actuators[i].min_rad + model.actuators[i].max_rad);
    }
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      // Angles of the front left leg, for which the stops are stated.
      const auto within = [&](std::size_t joint, double q_rad) {
        std::array<double, kJointsPerLeg> pose = middle;
        pose[joint] = q_rad;
        pose = model.pose_of(leg, pose);
        return within_stops(model, leg, {pose[0], pose[1], pose[2]}, kMargin_rad);
      };
      for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
        const double low = model.actuators[joint].min_rad + kMargin_rad;
        const double high = model.actuators[joint].max_rad - kMargin_rad;
        EXPECT_TRUE(within(joint, middle[joint]));
        EXPECT_TRUE(within(joint, low + kLittle_rad)) << leg << ' ' << joint;
        EXPECT_FALSE(within(joint, low - kLittle_rad)) << leg << ' ' << joint;
        EXPECT_TRUE(within(joint, high - kLittle_rad)) << leg << ' ' << joint;
        EXPECT_FALSE(within(joint, high + kLittle_rad)) << leg << ' ' << joint;
      }
    }
  }
}

}  // namespace
}  // namespace surefoot::robot
