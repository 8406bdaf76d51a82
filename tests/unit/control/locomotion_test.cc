// Which forces reach whole-body control: those of the plan while it covers the present, the shared
// weight otherwise. How a trot ends.
#include "core/control/locomotion.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/math/gravity.h"
#include "core/robot/kinematics.h"
#include "tests/support/mini_cheetah.h"

namespace surefoot::control {
namespace {

struct Standing {
  Standing() {
    ControlConfig config;
    config.body.height_m = 0.29;
    config.body.ground_filter_s = 0.15;
    config.body.max_acceleration_m_s2 = 1.0;
    config.body.max_reference_error_m = 0.05;
    config.mpc.step_s = 0.03;
    GaitConfig& trot = config.gaits.gaits[static_cast<std::size_t>(GaitKind::kTrot)];
    trot.period_s = 0.3;
    trot.stance_share = 0.5;
    trot.offset = {0.0, 0.5, 0.5, 0.0};
    config.swing.clearance_m = 0.05;
    config.whole_body.friction = 0.4;
    config.whole_body.max_normal_N = 150;
    config.whole_body.force_weight = 1.0;
    config.whole_body.linear_relaxation_weight = 1e-6;  // the reference forces decide
    config.whole_body.angular_relaxation_weight = 1e-6;
    config.whole_body.max_residual_N = 0.1;
    config.whole_body.max_joint_step_rad = 0.5;
    state.stamp = milliseconds(10000);
    state.p_OB_m = Vector3(0, 0, config.body.height_m);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      estimation::FootState& foot = state.feet[leg];
      foot.p_B_m = robot::hip_joint_B_m(model, leg);
      foot.p_B_m[2] = model.foot_radius_m - config.body.height_m;
      foot.p_O_m = state.p_OB_m + foot.p_B_m;
      foot.in_contact = true;
      const Vector3 q = robot::solve_leg(model, leg, foot.p_B_m).q_rad;
      for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
        state.joints[robot::joint_index(leg, i)].position_rad = q[static_cast<Eigen::Index>(i)];
      }
    }
    locomotion->reset(config, model);
    locomotion->start(state);
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      for (Vector3& force : plan.solution.force_O_N[k]) force = Vector3(0, 0, planned_N(k));
    }
  }
  static double planned_N(std::size_t k) { return 40.0 + 2.0 * static_cast<double>(k); }
  // Of a foot, with a plan that was solved for a state so long ago.
  double force_N(double age_s) {
    plan.stamp = state.stamp - TimeNs{static_cast<std::int64_t>(age_s * 1e9)};
    locomotion->update(state, nullptr, WalkCommand{}, plan, 0.002);
    return locomotion->legs()[0].force_O_N[2];
  }
  // One tick; feet touch the ground where they do not swing. The number of swings begun.
  int walk(const WalkCommand& command) {
    std::array<bool, robot::kLegs> swung{};
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      swung[leg] = locomotion->legs()[leg].mode == LegMode::kSwing;
      state.feet[leg].in_contact = !swung[leg];
    }
    state.stamp = state.stamp + milliseconds(2);
    locomotion->update(state, nullptr, command, plan, 0.002);
    int begun = 0;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      begun += !swung[leg] && locomotion->legs()[leg].mode == LegMode::kSwing ? 1 : 0;
    }
    return begun;
  }
  double share_N() const { return model.total_mass_kg() * kGravity_m_s2 / 4.0; }

  robot::RobotModel model = robot::full_mini_cheetah();
  estimation::RobotState state;
  ForcePlan plan;
  std::unique_ptr<Locomotion> locomotion = std::make_unique<Locomotion>();
};

TEST(Locomotion, TheFeetShareTheWeightBeforeTheFirstPlan) {
  Standing robot;
  EXPECT_NEAR(robot.force_N(0.01), robot.share_N(), 0.05);
}

TEST(Locomotion, TakesTheStepOfThePlanThatThePresentFallsInto) {
  Standing robot;
  robot.plan.valid = true;
  EXPECT_NEAR(robot.force_N(0.004), Standing::planned_N(0), 0.05);
  EXPECT_NEAR(robot.force_N(0.031), Standing::planned_N(1), 0.05);
  EXPECT_NEAR(robot.force_N(0.299), Standing::planned_N(9), 0.05);
}

TEST(Locomotion, APlanFromBeforeAFallIsNotUsed) {
  Standing robot;
  robot.plan.valid = true;
  EXPECT_NEAR(robot.force_N(5.0), robot.share_N(), 0.05);
}

// From 0.5 m/s at 1 m/s^2: half a second of braking, one more cycle for all four feet, the swings
// under way, no step afterwards.
TEST(Locomotion, TrotsUntilItsSpeedIsGoneAndOneCycleMore) {
  Standing robot;
  WalkCommand command;
  robot.walk(command);
  EXPECT_TRUE(robot.locomotion->at_rest());
  command.gait = GaitKind::kTrot;
  command.velocity.forward_m_s = 0.5;
  for (int tick = 0; tick < 400; ++tick) robot.walk(command);
  EXPECT_FALSE(robot.locomotion->at_rest());
  int ticks = 0;
  int swings_at_rest_speed = 0;
  for (; ticks < 1000 && !robot.locomotion->at_rest(); ++ticks) {
    const int begun = robot.walk(WalkCommand{});
    if (ticks >= 250) swings_at_rest_speed += begun;
  }
  EXPECT_GE(ticks, 250 + 149);
  EXPECT_LE(ticks, 250 + 150 + 76);
  EXPECT_EQ(swings_at_rest_speed, 4);
  for (int tick = 0; tick < 500; ++tick) {
    EXPECT_EQ(robot.walk(WalkCommand{}), 0);
    EXPECT_TRUE(robot.locomotion->at_rest());
  }
}

}  // namespace
}  // namespace surefoot::control
