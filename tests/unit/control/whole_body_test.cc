#include "core/control/whole_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/Dense>

#include "core/base/random.h"
#include "core/control/friction_pyramid.h"
#include "core/geometry/rotations.h"
#include "core/robot/kinematics.h"
#include "tests/support/mini_cheetah.h"
#include "tests/support/samples.h"

namespace surefoot::control {
namespace {

using robot::GeneralisedVector;
using robot::kLegs;

constexpr double kG = 9.81;

WholeBodyConfig config() {
  WholeBodyConfig c;
  c.friction = 0.4;
  c.max_normal_N = 150.0;
  c.position_gain_1_s2 = {100, 100, 100};
  c.velocity_gain_1_s = {10, 10, 10};
  c.attitude_gain_1_s2 = {100, 100, 100};
  c.rate_gain_1_s = {10, 10, 10};
  c.foot_position_gain_1_s2 = {500, 500, 500};
  c.foot_velocity_gain_1_s = {10, 10, 10};
  c.force_weight = 1.0;
  c.linear_relaxation_weight = 0.1;
  c.angular_relaxation_weight = 0.1;
  c.max_residual_N = 0.1;
  c.max_joint_step_rad = 0.5;
  c.joint_kp_Nm_rad = {3, 3, 3};
  c.joint_kd_Nm_s_rad = {1, 0.2, 0.2};
  return c;
}

// No limit is met: what comes out is what was computed.
robot::RobotModel limitless() {
  robot::RobotModel model = robot::full_mini_cheetah();
  for (robot::Actuator& actuator : model.actuators) {
    actuator.torque_limit_Nm = 1e6;
    actuator.no_load_speed_rad_s = 1e6;
    actuator.min_rad = -100;
    actuator.max_rad = 100;
  }
  return model;
}

Vector3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

struct Situation {
  WholeBodyState state;
  BodyTask body;
  LegTasks legs;
};

// Walking with bent knees, anywhere in the workspace, tasks near and far.
Situation random_situation(Random& random) {
  Situation s;
  s.state.p_OB_m = random_vector(random, 2.0);
  s.state.v_OB_m_s = random_vector(random, 1.5);
  const Vector3 angles = random_vector(random, 0.4);
  s.state.R_OB = geometry::from_roll_pitch_yaw(angles[0], angles[1], 7.0 * angles[2]);
  s.state.angular_velocity_B_rad_s = random_vector(random, 2.0);
  for (int leg = 0; leg < 4; ++leg) {
    s.state.q_rad[3 * leg] = random.uniform(-0.5, 0.5);
    s.state.q_rad[3 * leg + 1] = random.uniform(-1.4, 0.2);
    s.state.q_rad[3 * leg + 2] = random.uniform(0.5, 2.4);
  }
  for (int i = 0; i < 12; ++i) s.state.qd_rad_s[i] = random.uniform(-6, 6);
  s.body.p_OB_m = s.state.p_OB_m + random_vector(random, 0.03);
  s.body.v_OB_m_s = random_vector(random, 1.5);
  s.body.a_OB_m_s2 = random_vector(random, 2.0);
  const Vector3 turn = random_vector(random, 0.2);
  s.body.R_OB = s.state.R_OB * geometry::from_roll_pitch_yaw(turn[0], turn[1], turn[2]);
  s.body.angular_velocity_O_rad_s = random_vector(random, 1.0);
  s.body.angular_acceleration_O_rad_s2 = random_vector(random, 3.0);
  const robot::RobotModel model = robot::full_mini_cheetah();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    LegTask& task = s.legs[leg];
    task.in_contact = random.below(2) == 0;
    task.force_O_N = random_vector(random, 15.0) + Vector3(0, 0, 35);
    const robot::LegVector q = s.state.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg));
    const Vector3 p_B = robot::foot_position_B_m(model, leg, q);
    task.position_O_m = s.state.p_OB_m + s.state.R_OB * p_B + random_vector(random, 0.03);
    task.velocity_O_m_s = random_vector(random, 2.0);
    task.acceleration_O_m_s2 = random_vector(random, 20.0);
  }
  return s;
}

GeneralisedVector velocity_of(const WholeBodyState& state) {
  GeneralisedVector nu;
  nu.head<3>() = state.angular_velocity_B_rad_s;
  nu.segment<3>(3) = state.R_OB.transpose() * state.v_OB_m_s;
  nu.tail<12>() = state.qd_rad_s;
  return nu;
}

// Of hip and knee.
Vector3 axis_y_B(double abad_rad) { return {0.0, std::cos(abad_rad), std::sin(abad_rad)}; }

// Where the ground touches, from the centre.
Vector3 down_B(const WholeBodyState& state, const robot::RobotModel& model) {
  return state.R_OB.transpose() * Vector3(0, 0, -model.foot_radius_m);
}

// M nu' + C nu + g - J' f, by Newton-Euler and full Jacobians: the joints' torques below six zeros.
GeneralisedVector required_force(const robot::RobotModel& model, const WholeBodyState& state,
                                 const GeneralisedVector& acceleration, const LegTasks& legs,
                                 const std::array<Vector3, kLegs>& force_O_N) {
  robot::Dynamics dynamics;
  dynamics.reset(model);
  dynamics.update({state.R_OB, state.q_rad, velocity_of(state)});
  GeneralisedVector force = dynamics.inverse_dynamics(acceleration);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (!legs[leg].in_contact) continue;
    const auto jacobian = robot::point_jacobian_B(leg, dynamics.foot(leg, down_B(state, model)));
    force -= jacobian.transpose() * (state.R_OB.transpose() * force_O_N[leg]);
  }
  return force;
}

TEST(WholeBody, TorquesForcesAndAccelerationsFulfilTheEquationsOfMotion) {
  const robot::RobotModel model = limitless();
  WholeBody control;
  control.reset(config(), model);
  Random random(2);
  double worst_base = 0;
  double worst_joints = 0;
  for (int trial = 0; trial < tests::samples(5000, 500); ++trial) {
    const Situation s = random_situation(random);
    const WholeBodyCommand& c = control.update(s.state, s.body, s.legs);
    const GeneralisedVector force =
        required_force(model, s.state, c.acceleration, s.legs, c.force_O_N);
    worst_base = std::max(worst_base, force.head<6>().norm());
    worst_joints = std::max(worst_joints, (force.tail<12>() - c.torque_Nm).norm());
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      const Vector3& f = c.force_O_N[leg];
      if (!s.legs[leg].in_contact) {
        ASSERT_EQ(f.norm(), 0.0);
        continue;
      }
      ASSERT_LE(std::fabs(f[0]), 0.4 * f[2] + 1e-9);
      ASSERT_LE(std::fabs(f[1]), 0.4 * f[2] + 1e-9);
      ASSERT_GE(f[2], 0.0);
      ASSERT_LE(f[2], 150.0);
    }
    ASSERT_LT(c.force_residual_N, 1e-5);
  }
  std::printf("largest residual: trunk %.1e N, joints %.1e Nm\n", worst_base, worst_joints);
  EXPECT_LT(worst_base, 1e-8);
  EXPECT_LT(worst_joints, 1e-8);
  EXPECT_EQ(control.counters().refused, 0u);
  EXPECT_EQ(control.counters().torque_limited, 0u);
}

// Before the relaxation every task is met exactly: legs are not singular and their number of joints
// is that of the tasks.
TEST(WholeBody, AccelerationsAndSpeedsMeetAllTasksOfARegularRobot) {
  const robot::RobotModel model = limitless();
  WholeBodyConfig c = config();
  c.max_joint_step_rad = 3.0;
  WholeBody control;
  control.reset(c, model);
  robot::Dynamics dynamics;
  dynamics.reset(model);
  Random random(3);
  for (int trial = 0; trial < tests::samples(2000, 300); ++trial) {
    Situation s = random_situation(random);
    s.legs[random.below(4)].in_contact = true;
    const WholeBodyCommand& command = control.update(s.state, s.body, s.legs);
    GeneralisedVector a = command.acceleration;
    a.head<6>() -= command.relaxation;
    dynamics.update({s.state.R_OB, s.state.q_rad, velocity_of(s.state)});
    const Matrix3& R = s.state.R_OB;
    const Vector3 w = R * s.state.angular_velocity_B_rad_s;
    const Vector3 turn = geometry::to_rotation_vector(R.transpose() * s.body.R_OB);
    const Vector3 spin = s.body.angular_acceleration_O_rad_s2 + 100 * (R * turn) +
                         10 * (s.body.angular_velocity_O_rad_s - w);
    EXPECT_LT((R * a.head<3>() - spin).norm(), 1e-6);
    const Vector3 linear = s.body.a_OB_m_s2 + 100 * (s.body.p_OB_m - s.state.p_OB_m) +
                           10 * (s.body.v_OB_m_s - s.state.v_OB_m_s);
    EXPECT_LT((R * a.segment<3>(3) + w.cross(s.state.v_OB_m_s) - linear).norm(), 1e-6);
    // Commanded speeds: the trunk's by the task, then every foot as its task says.
    GeneralisedVector nu;
    nu.head<3>() = R.transpose() * s.body.angular_velocity_O_rad_s;
    nu.segment<3>(3) = R.transpose() * s.body.v_OB_m_s;
    nu.tail<12>() = command.qd_rad_s;
    GeneralisedVector step;
    step.head<3>() = turn;
    step.segment<3>(3) = R.transpose() * (s.body.p_OB_m - s.state.p_OB_m);
    step.tail<12>() = command.q_rad - s.state.q_rad;
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      const LegTask& task = s.legs[leg];
      const robot::PointMotion foot =
          dynamics.foot(leg, task.in_contact ? down_B(s.state, model) : Vector3(0, 0, 0));
      const auto j = robot::point_jacobian_B(leg, foot);
      const Vector3 got = R * (j * a + foot.bias_B_m_s2);
      Vector3 wanted_a = Vector3::Zero();
      Vector3 wanted_v = Vector3::Zero();
      Vector3 wanted_p = Vector3::Zero();
      if (!task.in_contact) {
        wanted_p = task.position_O_m - s.state.p_OB_m - R * foot.p_B_m;
        wanted_v = task.velocity_O_m_s;
        wanted_a = task.acceleration_O_m_s2 + 500 * wanted_p +
                   10 * (task.velocity_O_m_s - R * foot.v_B_m_s);
      }
      EXPECT_LT((got - wanted_a).norm(), 1e-5);
      EXPECT_LT((R * (j * nu) - wanted_v).norm(), 1e-7);
      if (step.tail<12>().cwiseAbs().maxCoeff() < 2.99) {
        EXPECT_LT((R * (j * step) - wanted_p).norm(), 1e-8);
      }
    }
  }
  EXPECT_EQ(control.counters().damped, 0u);
}

TEST(WholeBody, InFlightTheTrunkFallsAndTheFeetFollowTheirTasks) {
  const robot::RobotModel model = limitless();
  WholeBody control;
  control.reset(config(), model);
  robot::Dynamics dynamics;
  dynamics.reset(model);
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    Situation s = random_situation(random);
    for (LegTask& leg : s.legs) leg.in_contact = false;
    const WholeBodyCommand& c = control.update(s.state, s.body, s.legs);
    for (const Vector3& force : c.force_O_N) EXPECT_EQ(force.norm(), 0.0);
    // The centre of mass falls freely.
    dynamics.update({s.state.R_OB, s.state.q_rad, velocity_of(s.state)});
    const GeneralisedVector force = dynamics.inverse_dynamics(c.acceleration);
    EXPECT_LT(force.head<6>().norm(), 1e-8);
    EXPECT_LT((force.tail<12>() - c.torque_Nm).norm(), 1e-8);
  }
  EXPECT_EQ(control.counters().refused, 0u);
}

// Level, still, on four feet, every wish fulfilled: the forces carry the weight with their
// resultant under the centre of mass, and torques are those of statics, g_joints - J' f.
TEST(WholeBody, AStandingRobotCarriesItsWeight) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  WholeBodyConfig c = config();
  c.force_weight = 1e-3;  // as the reference forces are far off
  c.linear_relaxation_weight = 10.0;
  c.angular_relaxation_weight = 0.1;
  WholeBody control;
  control.reset(c, model);
  WholeBodyState state;
  BodyTask body;
  LegTasks legs;
  body.p_OB_m = state.p_OB_m = Vector3(1.0, -2.0, 0.29);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    legs[leg].in_contact = true;
    legs[leg].force_O_N = Vector3(0, 0, 10);  // less than half of what is needed
    Vector3 foot = robot::hip_joint_B_m(model, leg);
    foot[0] += 0.02;  // the centre of mass is not in the middle
    foot[2] = -0.29 + model.foot_radius_m;
    state.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg)) =
        robot::solve_leg(model, leg, foot).q_rad;
  }
  constexpr int kTicks = 20;  // from the last solution, as on a robot
  for (int tick = 0; tick < kTicks; ++tick) control.update(state, body, legs);
  const WholeBodyCommand& command = control.command();
  std::printf("residual %.1e N, relaxation %.1e\n", command.force_residual_N,
              command.relaxation.norm());
  const double mass_kg = 3.3 + 4 * (0.54 + 0.634 + 0.064) + 12 * 0.055;
  Vector3 total = Vector3::Zero();
  for (const Vector3& force : command.force_O_N) total += force;
  EXPECT_NEAR(total[2], mass_kg * kG, 0.5);
  EXPECT_NEAR(total.head<2>().norm(), 0.0, 0.1);
  EXPECT_LT(command.relaxation.norm(), 0.1);
  robot::Dynamics dynamics;
  dynamics.reset(model);
  dynamics.update({state.R_OB, state.q_rad, GeneralisedVector::Zero()});
  const GeneralisedVector gravity = dynamics.bias();
  // By virtual work, without the engine's Jacobians: the foot moves by central differences.
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    for (int i = 0; i < 3; ++i) {
      const auto joint = static_cast<Eigen::Index>(3 * leg) + i;
      constexpr double kTurn_rad = 1e-6;
      robot::LegVector q = state.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg));
      q[i] += kTurn_rad;
      const Vector3 ahead = robot::foot_position_B_m(model, leg, q);
      q[i] -= 2 * kTurn_rad;
      const Vector3 moved = ahead - robot::foot_position_B_m(model, leg, q);
      // The contact point is part of the shank: it turns with it about x (abad) or y.
      const Vector3 axis =
          i == 0 ? Vector3::UnitX() : axis_y_B(state.q_rad[static_cast<Eigen::Index>(3 * leg)]);
      const Vector3 turned = 2 * kTurn_rad * axis.cross(down_B(state, model));
      const double work = command.force_O_N[leg].dot(moved + turned) / (2 * kTurn_rad);
      EXPECT_NEAR(command.torque_Nm[joint], gravity[6 + joint] - work, 0.02) << joint;
    }
  }
}

// Weights that 50 iterations cannot settle: the reference forces, inside their pyramids, and the
// equations of motion hold all the same.
TEST(WholeBody, AnUnsettledProgramFallsBackToTheReferenceForces) {
  const robot::RobotModel model = limitless();
  WholeBodyConfig c = config();
  c.linear_relaxation_weight = c.angular_relaxation_weight = 1e4;
  WholeBody control;
  Random random(7);
  int unsettled = 0;
  for (int trial = 0; trial < 200; ++trial) {
    control.reset(c, model);
    const Situation s = random_situation(random);
    const WholeBodyCommand& command = control.update(s.state, s.body, s.legs);
    const GeneralisedVector force =
        required_force(model, s.state, command.acceleration, s.legs, command.force_O_N);
    EXPECT_LT(force.head<6>().norm(), 1e-8);
    EXPECT_LT((force.tail<12>() - command.torque_Nm).norm(), 1e-8);
    if (control.counters().unsettled == 0) continue;
    ++unsettled;
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      Vector3 expected = s.legs[leg].force_O_N;
      FrictionPyramid<double>(0.4).project(expected[0], expected[1], expected[2], 0.0, 150.0);
      const double contact = s.legs[leg].in_contact ? 1.0 : 0.0;
      EXPECT_LT((command.force_O_N[leg] - contact * expected).norm(), 1e-12);
    }
  }
  EXPECT_GT(unsettled, 50);
}

TEST(WholeBody, DegenerateLegsGiveFiniteLimitedCommands) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  WholeBody control;
  control.reset(config(), model);
  Random random(5);
  for (int trial = 0; trial < tests::samples(5000, 500); ++trial) {
    Situation s = random_situation(random);
    for (int leg = 0; leg < 4; ++leg) {
      const auto kind = random.below(4);
      if (kind == 0) s.state.q_rad[3 * leg + 2] = 0.0;  // straight
      if (kind == 1) s.state.q_rad[3 * leg + 2] = 3.14159265358979;
      // The foot on the abduction axis' side: lateral offset only.
      if (kind == 2) s.state.q_rad.segment<3>(3 * leg) = Vector3(1.5, 0.0, 1e-4);
    }
    if (random.below(3) == 0) s.body.p_OB_m += random_vector(random, 100.0);
    if (random.below(3) == 0) s.state.qd_rad_s *= 10.0;
    if (random.below(3) == 0) s.legs[1].force_O_N = random_vector(random, 5000.0);
    s.state.R_OB = robot::random_attitude(random);
    const WholeBodyCommand& c = control.update(s.state, s.body, s.legs);
    for (int i = 0; i < 12; ++i) {
      const robot::Actuator& actuator = model.actuators[static_cast<std::size_t>(i % 3)];
      ASSERT_TRUE(std::isfinite(c.q_rad[i] + c.qd_rad_s[i] + c.torque_Nm[i]));
      ASSERT_LE(std::fabs(c.torque_Nm[i]), actuator.torque_limit_Nm);
      ASSERT_LE(std::fabs(c.qd_rad_s[i]), actuator.no_load_speed_rad_s);
      ASSERT_GE(c.q_rad[i], actuator.min_rad);
      ASSERT_LE(c.q_rad[i], actuator.max_rad);
    }
    for (const Vector3& f : c.force_O_N) {
      ASSERT_LE(std::fabs(f[0]), 0.4 * f[2] + 1e-9);
      ASSERT_LE(std::fabs(f[1]), 0.4 * f[2] + 1e-9);
      ASSERT_LE(f[2], 150.0);
    }
  }
  EXPECT_EQ(control.counters().refused, 0u);
  EXPECT_GT(control.counters().damped, 100u);
  EXPECT_GT(control.counters().torque_limited, 10u);
}

TEST(WholeBody, RefusesWhatIsNoNumberAndHoldsTheJoints) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  Random random(6);
  const Situation good = random_situation(random);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (int fault = 0; fault < 9; ++fault) {
    WholeBody control;
    control.reset(config(), model);
    const robot::JointVector last = control.update(good.state, good.body, good.legs).q_rad;
    Situation s = good;
    LegTask& contact = s.legs[0];
    contact.in_contact = fault < 5;
    switch (fault) {
      case 0: s.state.q_rad[4] = nan; break;
      case 1: s.state.qd_rad_s[4] = infinite; break;
      case 2: s.state.R_OB(1, 1) = nan; break;
      case 3: s.body.a_OB_m_s2[0] = 1e9; break;
      case 4: contact.force_O_N[1] = -infinite; break;
      case 5: contact.position_O_m[1] = nan; break;
      case 6: s.body.R_OB *= 1.1; break;
      case 7: s.state.q_rad[0] = 1e5; break;
      default: s.state.R_OB.col(0) *= -1.0; break;
    }
    const WholeBodyCommand& c = control.update(s.state, s.body, s.legs);
    EXPECT_EQ(control.counters().refused, 1u) << fault;
    EXPECT_EQ(c.torque_Nm.norm() + c.qd_rad_s.norm(), 0.0) << fault;
    const double expected = fault == 0 ? last[4] : good.state.q_rad[4];
    EXPECT_DOUBLE_EQ(c.q_rad[4], expected) << fault;
    // And goes on with the next good input as if nothing had been.
    EXPECT_GT(control.update(good.state, good.body, good.legs).torque_Nm.norm(), 1.0);
    EXPECT_EQ(control.counters().refused, 1u);
  }
}

// A robot on four feet that cannot slip or lift, under its own torques: the rigid-body dynamics
// with the constraint J nu' + Jdot nu = 0, integrated. The trunk is shoved and comes back as the
// gains say, in spite of moving legs.
TEST(WholeBody, AShovedRobotReturnsToItsPose) {
  const robot::RobotModel model = limitless();
  WholeBodyConfig c = config();
  c.force_weight = 1e-3;  // the trunk's task decides, not the reference forces
  c.linear_relaxation_weight = c.angular_relaxation_weight = 1.0;
  c.friction = 2.0;
  WholeBody control;
  control.reset(c, model);
  robot::Dynamics dynamics;
  dynamics.reset(model);
  WholeBodyState state;
  BodyTask body;
  body.p_OB_m = Vector3(0, 0, 0.29);
  state.p_OB_m = body.p_OB_m;
  LegTasks legs;
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    legs[leg].in_contact = true;
    legs[leg].force_O_N = Vector3(0, 0, 8.912 * kG / 4);
    Vector3 foot = robot::hip_joint_B_m(model, leg);
    foot[2] = -0.29 + model.foot_radius_m;
    state.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg)) =
        robot::solve_leg(model, leg, foot).q_rad;
  }
  state.angular_velocity_B_rad_s = Vector3(0.6, -0.5, 0.4);
  state.v_OB_m_s = Vector3(0.2, 0.3, -0.2);
  // Joint speeds that keep the feet where they are.
  dynamics.update({state.R_OB, state.q_rad, GeneralisedVector::Zero()});
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const robot::PointMotion foot = dynamics.foot(leg, down_B(state, model));
    const Vector3 v = state.v_OB_m_s + state.angular_velocity_B_rad_s.cross(foot.p_B_m);
    state.qd_rad_s.segment<3>(static_cast<Eigen::Index>(3 * leg)) = -foot.jacobian_B.inverse() * v;
  }
  constexpr double kStep_s = 0.0005;
  double largest_m = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    const WholeBodyCommand& command = control.update(state, body, legs);
    GeneralisedVector nu = velocity_of(state);
    dynamics.update({state.R_OB, state.q_rad, nu});
    robot::MassMatrix m;
    dynamics.mass_matrix(m);
    Eigen::Matrix<double, 30, 30> kkt = Eigen::Matrix<double, 30, 30>::Zero();
    Eigen::Matrix<double, 30, 1> right = Eigen::Matrix<double, 30, 1>::Zero();
    kkt.topLeftCorner<18, 18>() = m;
    right.head<18>() = -dynamics.bias();
    right.segment<12>(6) += command.torque_Nm;
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      const auto row = 18 + static_cast<Eigen::Index>(3 * leg);
      const robot::PointMotion foot = dynamics.foot(leg, down_B(state, model));
      const auto j = robot::point_jacobian_B(leg, foot);
      kkt.block<3, 18>(row, 0) = j;
      kkt.block<18, 3>(0, row) = -j.transpose();
      right.segment<3>(row) = -foot.bias_B_m_s2 - 20.0 * (j * nu);  // holds against drift
    }
    const GeneralisedVector a = kkt.partialPivLu().solve(right).head<18>();
    nu += kStep_s * a;
    state.angular_velocity_B_rad_s = nu.head<3>();
    state.v_OB_m_s = state.R_OB * nu.segment<3>(3);
    state.qd_rad_s = nu.tail<12>();
    state.p_OB_m += kStep_s * state.v_OB_m_s;
    const Vector3 turn = kStep_s * state.angular_velocity_B_rad_s;
    state.R_OB = state.R_OB * geometry::to_matrix(geometry::from_rotation_vector(turn));
    state.q_rad += kStep_s * state.qd_rad_s;
    largest_m = std::max(largest_m, (state.p_OB_m - body.p_OB_m).norm());
  }
  EXPECT_GT(largest_m, 0.01);
  EXPECT_LT((state.p_OB_m - body.p_OB_m).norm(), 2e-3);
  EXPECT_LT(geometry::to_rotation_vector(state.R_OB).norm(), 5e-3);
  EXPECT_LT(velocity_of(state).norm(), 0.02);
  EXPECT_EQ(control.counters().refused, 0u);
}

}  // namespace
}  // namespace surefoot::control
