// The horizon of the predictive controller: who stands when, where, and what the body should do.
#include "core/control/horizon_plan.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/mini_cheetah.h"

namespace surefoot::control {
namespace {

constexpr double kStep_s = 0.03;

struct Walk {
  Walk() : model(robot::full_mini_cheetah()) {
    config.mpc.step_s = kStep_s;
    config.body.inertia_kg_m2 = {0.07, 0.26, 0.24};
    GaitConfig trot;
    trot.period_s = 0.3;
    trot.stance_share = 0.5;
    trot.offset = {0.0, 0.5, 0.5, 0.0};
    gait.reset(trot);
    state.p_OB_m = Vector3(0, 0, 0.29);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      state.feet[leg].p_O_m = robot::hip_joint_B_m(model, leg);
      state.feet[leg].p_O_m[2] = model.foot_radius_m;
    }
    reference.p_OB_m = state.p_OB_m;
  }
  // Legs as the gait has them; swings go to 0.1 m ahead of the foot.
  void follow_gait() {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      legs[leg].mode = gait.legs()[leg].stance ? LegMode::kStance : LegMode::kSwing;
      legs[leg].foothold.position_O_m = state.feet[leg].p_O_m + Vector3(0.1, 0, 0);
    }
  }
  const MpcProblem& plan() {
    plan_horizon({model, config, state, reference, command, gait, running, legs}, *problem);
    return *problem;
  }

  robot::RobotModel model;
  ControlConfig config;
  estimation::RobotState state;
  BodyReference reference;
  VelocityCommand command;
  Gait gait;
  bool running = true;
  std::array<LegStatus, robot::kLegs> legs;
  std::unique_ptr<MpcProblem> problem = std::make_unique<MpcProblem>();
};

TEST(HorizonPlan, AStandingRobotStandsThroughout) {
  Walk walk;
  walk.running = false;
  const MpcProblem& problem = walk.plan();
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      EXPECT_TRUE(problem.stands[k][leg]);
      EXPECT_NEAR(problem.contact_O_m[k][leg][2], 0.0, 1e-12);
    }
    EXPECT_EQ(problem.reference[k].p_OB_m, walk.reference.p_OB_m);
  }
  EXPECT_NEAR(problem.mass_kg, walk.model.total_mass_kg(), 1e-12);
}

// FR and HL stand for five steps of 30 ms, then FL and HR do; the swing under way ends at its
// foothold, the next step is taken half a stance ahead of the hip.
TEST(HorizonPlan, ATrotAlternatesAndStepsAhead) {
  Walk walk;
  walk.gait.advance(1e-6);
  walk.follow_gait();
  walk.command.forward_m_s = 1.0;
  const MpcProblem& problem = walk.plan();
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    const bool first_pair = k < 5;
    EXPECT_EQ(problem.stands[k][0], first_pair) << k;
    EXPECT_EQ(problem.stands[k][3], first_pair) << k;
    EXPECT_EQ(problem.stands[k][1], !first_pair) << k;
    EXPECT_EQ(problem.stands[k][2], !first_pair) << k;
    EXPECT_NEAR(problem.reference[k].p_OB_m[0], static_cast<double>(k + 1) * kStep_s, 1e-12);
    EXPECT_NEAR(problem.reference[k].v_OB_m_s[0], 1.0, 1e-12);
  }
  EXPECT_NEAR(problem.contact_O_m[5][1][0], walk.state.feet[1].p_O_m[0] + 0.1, 1e-12);
}

TEST(HorizonPlan, AStepThatIsNotDecidedYetIsTakenAtTheRaibertPoint) {
  Walk walk;
  walk.gait.advance(0.1);  // FR and HL: 50 ms of stance left, then 150 ms of swing
  walk.follow_gait();
  walk.command.forward_m_s = 1.0;
  const MpcProblem& problem = walk.plan();
  EXPECT_TRUE(problem.stands[1][0]);
  EXPECT_FALSE(problem.stands[3][0]);
  ASSERT_TRUE(problem.stands[7][0]);
  const double hip_x = robot::hip_joint_B_m(walk.model, 0)[0];
  EXPECT_NEAR(problem.contact_O_m[7][0][0], 8 * kStep_s + hip_x + 0.5 * 0.15, 1e-12);
}

// A foot that landed early bears load for the rest of its planned swing; one that feels no ground
// bears none now and is trusted to find it by the next step.
TEST(HorizonPlan, TheFirstStepTakesTheLegsAsTheyAre) {
  Walk walk;
  walk.gait.advance(0.1);
  walk.follow_gait();
  walk.legs[0].mode = LegMode::kSearch;
  walk.legs[1].mode = LegMode::kStance;
  const MpcProblem& problem = walk.plan();
  EXPECT_FALSE(problem.stands[0][0]);
  EXPECT_TRUE(problem.stands[1][0]);
  EXPECT_TRUE(problem.stands[0][1]);
  EXPECT_TRUE(problem.stands[1][1]);
  EXPECT_TRUE(problem.stands[2][1]);
}

TEST(HorizonPlan, TheReferenceTurnsWithTheYawRate) {
  Walk walk;
  walk.running = false;
  walk.reference.yaw_rad = 0.5;
  walk.reference.yaw_rate_rad_s = 2.0;
  const MpcProblem& problem = walk.plan();
  EXPECT_NEAR(problem.reference[9].roll_pitch_yaw_rad[2], 0.5 + 10 * kStep_s * 2.0, 1e-12);
  EXPECT_EQ(problem.reference[9].angular_velocity_O_rad_s, Vector3(0, 0, 2.0));
}

}  // namespace
}  // namespace surefoot::control
