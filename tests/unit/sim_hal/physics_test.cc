// Checks of the physics against what can be worked out by hand, before anything is tuned on it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/robot/kinematics.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/robot/ode_runtime.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

constexpr double kG = 9.81;

Vector3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

double total_normal_N(const Truth& truth) {
  double sum = 0;
  for (const FootTruth& foot : truth.feet) sum += foot.force_W_N[2];
  return sum;
}

robot::RobotModel without_friction() {
  robot::RobotModel model = mini_cheetah();
  for (robot::Actuator& actuator : model.actuators) {
    actuator.dry_friction_Nm = 0;
    actuator.viscous_friction_Nm_s = 0;
    actuator.min_rad = -60;
    actuator.max_rad = 60;
  }
  return model;
}

TEST(Physics, FreeFallFollowsTheParabola) {
  SimulatorConfig config;
  config.start.drop_height_m = 2.0;
  Rig rig({}, config, 1, without_friction());
  const double z0 = rig.simulator->truth().p_WB_m[2];
  ASSERT_TRUE(ok(rig.board.clock->wait_until(milliseconds(500))));
  const Truth truth = rig.simulator->truth();
  // Semi-implicit Euler is late by g t h / 2 = 1.2 mm; beyond that the parabola holds.
  const double h = config.physics.step_s;
  EXPECT_NEAR(truth.p_WB_m[2], z0 - 0.5 * kG * 0.5 * (0.5 + h), 1e-6);
  EXPECT_NEAR(truth.v_WB_m_s[2], -kG * 0.5, 1e-6);
  EXPECT_NEAR(truth.p_WB_m[0], 0, 1e-9);
  EXPECT_FALSE(truth.feet[0].contact);
}

TEST(Physics, StandingFeetCarryTheWeightAndTheBaseRests) {
  Rig rig;
  rig.stand(4.0);
  const double weight_N = mini_cheetah().total_mass_kg() * kG;
  EXPECT_NEAR(weight_N, 87.43, 0.01);
  const Vector3 reference = vector(rig.simulator->truth().p_WB_m);
  double worst_m = 0;
  double sum_N = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.send_all({0.0, -0.8, 1.6}, 80, 2);
    rig.tick();
    const Truth truth = rig.simulator->truth();
    worst_m = std::max(worst_m, (vector(truth.p_WB_m) - reference).norm());
    sum_N += total_normal_N(truth);
    ASSERT_FALSE(truth.trunk_contact);
  }
  EXPECT_TRUE(rig.accepted);
  EXPECT_NEAR(sum_N / 1000, weight_N, 0.01 * weight_N);
  EXPECT_LT(worst_m, 0.0005);
  for (const FootTruth& foot : rig.simulator->truth().feet) {
    EXPECT_NEAR(foot.p_WF_m[2], mini_cheetah().foot_radius_m, 0.0002);  // depth
    EXPECT_TRUE(foot.contact);
  }
}

TEST(Physics, LinksFollowTheKinematicsOfTheRobot) {
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 0.5;
  config.start.leg_rad = {0.3, -0.9, 1.7};
  Rig rig({}, config);
  ASSERT_TRUE(ok(rig.board.clock->wait_until(milliseconds(300))));  // legs hang down, swinging
  const Truth truth = rig.simulator->truth();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const robot::LegVector q(truth.joints[3 * leg].position_rad,
                             truth.joints[3 * leg + 1].position_rad,
                             truth.joints[3 * leg + 2].position_rad);
    const Vector3 foot = robot::foot_position_B_m(rig.model, leg, q);
    const Vector3 expected = vector(truth.p_WB_m) + foot;  // the stand keeps the trunk level
    EXPECT_LT((vector(truth.feet[leg].p_WF_m) - expected).norm(), 1e-5) << leg;
    EXPECT_GT(std::fabs(truth.joints[3 * leg + 1].position_rad + 0.9), 0.05);
  }
  // Mirror symmetry of the legs: same motion left and right.
  EXPECT_NEAR(truth.joints[0].position_rad, -truth.joints[3].position_rad, 1e-6);
  EXPECT_NEAR(truth.joints[1].position_rad, truth.joints[4].position_rad, 1e-6);
}

TEST(Physics, PassiveSwingKeepsItsEnergy) {
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 1.0;
  config.start.leg_rad = {0.4, 0.7, 0.5};
  robot::RobotModel model = without_friction();
  // So far apart and beside so slim a trunk that no leg swings into anything.
  model.abad_x_m = 0.6;
  model.abad_y_m = 0.6;
  model.trunk_size_m = {0.38, 0.02, 0.1};
  Rig rig({}, config, 1, model);
  const double start_J = rig.simulator->truth().mechanical_energy_J;
  double worst_J = 0;
  double lowest_hip_rad = 1;
  for (int i = 1; i <= 1500; ++i) {
    ASSERT_TRUE(ok(rig.board.clock->wait_until(milliseconds(2 * i))));
    const Truth truth = rig.simulator->truth();
    worst_J = std::max(worst_J, std::fabs(truth.mechanical_energy_J - start_J));
    lowest_hip_rad = std::min(lowest_hip_rad, truth.joints[1].position_rad);
  }
  // The four legs exchange about 10 J of kinetic energy, at up to 10 rad/s.
  EXPECT_LT(lowest_hip_rad, -0.2);
  EXPECT_LT(worst_J, 0.1);
  RecordProperty("worst_energy_drift_mJ", static_cast<int>(worst_J * 1000));
}

// A robot alone in space that kicks its legs: internal torques change neither momentum, the
// reflected inertia of the rotors included.
TEST(Physics, KickingInFreeFallKeepsTheAngularMomentum) {
  start_ode();
  const dWorldID world = dWorldCreate();
  const robot::RobotModel model = without_friction();
  constexpr double kStep_s = 0.0001;
  Articulation robot(world, model, {}, kStep_s);
  const auto angular_momentum = [&] {
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < kBodies; ++i) {
      dMass mass;
      dBodyGetMass(robot.body(i), &mass);
      const dReal* r = dBodyGetRotation(robot.body(i));
      Matrix3 rotation;
      rotation << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
      Matrix3 inertia;
      inertia << mass.I[0], mass.I[1], mass.I[2], mass.I[4], mass.I[5], mass.I[6], mass.I[8],
          mass.I[9], mass.I[10];
      const dReal* w = dBodyGetAngularVel(robot.body(i));
      const dReal* v = dBodyGetLinearVel(robot.body(i));
      const dReal* p = dBodyGetPosition(robot.body(i));
      sum += rotation * (inertia * (rotation.transpose() * Vector3(w[0], w[1], w[2])));
      sum += mass.mass * Vector3(p[0], p[1], p[2]).cross(Vector3(v[0], v[1], v[2]));
    }
    return sum;
  };
  double fastest_rad_s = 0;
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    std::array<double, robot::kJoints> torques{};
    for (std::size_t k = 0; k < torques.size(); ++k) {
      // Different for every joint, so that the trunk tumbles about all axes.
      torques[k] = 0.6 * std::sin(0.004 * i + 1.7 * static_cast<double>(k));
    }
    robot.apply(torques);
    dWorldStep(world, kStep_s);
    robot.update();
    for (std::size_t k = 0; k < torques.size(); ++k) {
      fastest_rad_s = std::max(fastest_rad_s, std::fabs(robot.joint_velocity_rad_s(k)));
    }
    worst = std::max(worst, angular_momentum().norm());
  }
  EXPECT_GT(fastest_rad_s, 5.0);
  EXPECT_LT(worst, 0.002);  // [N m s]; a leg at 5 rad/s carries 0.1
  dWorldDestroy(world);
}

// A blow of a scenario in mid-air, where nothing else pushes sideways: the robot takes over exactly
// its impulse, to one side or the other as the seed draws.
TEST(Pushes, GiveTheirImpulseOnceAndToEitherSide) {
  int left = 0;
  constexpr int kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SimulatorConfig config;
    config.start.drop_height_m = 2.0;
    config.scenario.push = {1, 3.0, 0.05, 0.05, 0.0, 0.1};
    Simulator simulator(mini_cheetah(), WorldSpec{}, config, seed);
    ASSERT_EQ(simulator.board().clock->wait_until(milliseconds(300)), Status::kOk);
    const Truth truth = simulator.truth();
    ASSERT_FALSE(truth.trunk_contact);
    // Limp legs swing against the trunk: its speed times the mass is near the impulse only.
    const double impulse_N_s = mini_cheetah().total_mass_kg() * truth.v_WB_m_s[1];
    EXPECT_NEAR(std::fabs(impulse_N_s), 3.0, 0.9);
    if (impulse_N_s > 0) ++left;
  }
  EXPECT_GT(left, 0);
  EXPECT_LT(left, kSeeds);
}

class Slip : public testing::TestWithParam<int> {};

// Pushes a crouching robot with a horizontal force: below the friction cone it stays, above it
// goes, in every direction alike. A square pyramid fixed in the world would hold 1.41 mu along its
// diagonals.
TEST_P(Slip, BeginsAtTheConeInEveryDirection) {
  const double angle_rad = GetParam() * std::atan(1.0);
  WorldSpec world;
  world.friction = 0.3;
  const double cone_N = world.friction * mini_cheetah().total_mass_kg() * kG;
  const auto travel_m = [&](double part, double& ratio) {
    Rig rig(world);
    rig.send_special(actuation::FrameKind::kEnterMotorMode);
    rig.tick();
    const auto hold = [&](int ticks, double force_N) {
      rig.simulator->set_trunk_force(
          {force_N * std::cos(angle_rad), force_N * std::sin(angle_rad), 0});
      for (int i = 0; i < ticks; ++i) {
        rig.send_all({0.0, -1.3, 2.5}, 200, 4);
        rig.tick();
      }
    };
    hold(500, 0);
    const Vector3 before = vector(rig.simulator->truth().p_WB_m);
    hold(250, part * cone_N);
    const Truth truth = rig.simulator->truth();
    Vector3 sum = Vector3::Zero();
    for (const FootTruth& foot : truth.feet) sum += vector(foot.force_W_N);
    ratio = std::hypot(sum.x(), sum.y()) / sum.z();
    return (vector(truth.p_WB_m) - before).norm();
  };
  double held_ratio = 0;
  double sliding_ratio = 0;
  const double held_m = travel_m(0.88, held_ratio);
  const double slid_m = travel_m(1.15, sliding_ratio);
  EXPECT_LT(held_m, 0.010) << "ratio " << held_ratio;  // the legs' own springs give 6 mm
  EXPECT_GT(slid_m, 0.050) << "ratio " << sliding_ratio;
  EXPECT_NEAR(sliding_ratio, world.friction, 0.06 * world.friction);
}

INSTANTIATE_TEST_SUITE_P(EightDirections, Slip, testing::Range(0, 8));

TEST(Physics, FootOnABoxStandsOnItsTop) {
  // The terrain height under each foot of a robot that has come to rest equals what it stands on.
  WorldSpec world;
  world.generator = Generator::kSteps;
  world.height_m = 0.05;
  Rig rig(world, {}, 5);
  rig.stand(2.0);
  const Truth truth = rig.simulator->truth();
  for (const FootTruth& foot : truth.feet) {
    const double ground = rig.simulator->terrain_height_m(foot.p_WF_m[0], foot.p_WF_m[1]);
    EXPECT_NEAR(foot.p_WF_m[2] - ground, mini_cheetah().foot_radius_m, 0.0005);
  }
}

TEST(Physics, MechanicalStopHoldsAgainstTheMotor) {
  robot::RobotModel model = mini_cheetah();
  model.actuators[1].max_rad = 0.5;
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 0.5;
  config.start.leg_rad = {0, 0, 0.5};
  Rig rig({}, config, 1, model);
  rig.send_special(actuation::FrameKind::kEnterMotorMode);
  for (int i = 0; i < 500; ++i) {
    rig.send(1, {2.0, 30, 0.5, 0});
    rig.tick();
  }
  EXPECT_GT(rig.simulator->truth().joints[1].position_rad, 0.48);
  EXPECT_LT(rig.simulator->truth().joints[1].position_rad, 0.56);
}

}  // namespace
}  // namespace surefoot::sim
