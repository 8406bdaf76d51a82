// core's dynamics against ODE's: a robot thrown into the air with its joints moving and torques on
// them, its rotors resisting as both say.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/robot/dynamics.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/robot/ode_runtime.h"
#include "tests/support/little_dog.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

constexpr double kG = 9.81;

robot::RobotModel bare(robot::RobotModel model) {
  model.trunk.centre_of_mass_m = {0.01, -0.004, 0.006};
  for (robot::Actuator& actuator : model.actuators) {
    actuator.dry_friction_Nm = 0;
    actuator.viscous_friction_Nm_s = 0;
    actuator.min_rad = -60;
    actuator.max_rad = 60;
  }
  return model;
}

struct World {
  World() : id(dWorldCreate()) {
    dWorldSetGravity(id, 0, 0, -kG);
    dWorldSetERP(id, 0.8);
    dWorldSetMaxAngularSpeed(id, 1e6);
  }
  ~World() { dWorldDestroy(id); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  dWorldID id;
};

robot::MotionState state_of(const Articulation& articulation) {
  robot::MotionState state;
  state.R_OB = articulation.trunk_rotation();
  const Matrix3 to_B = state.R_OB.transpose();
  state.velocity.head<3>() = to_B * articulation.trunk_angular_velocity_W();
  state.velocity.segment<3>(3) = to_B * articulation.trunk_point_velocity_W(Vector3::Zero());
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    state.q_rad[row] = articulation.joint_position_rad(joint);
    state.velocity[6 + row] = articulation.joint_velocity_rad_s(joint);
  }
  return state;
}

// Turns all bodies about the trunk's origin and gives each the velocity that nu asks of it.
void throw_robot(const Articulation& articulation, robot::Dynamics& dynamics,
                 const Matrix3& rotation, const robot::GeneralisedVector& nu) {
  robot::MotionState state = state_of(articulation);
  state.velocity = nu;
  dynamics.update(state);
  const Vector3 pivot = articulation.trunk_position_m();
  for (std::size_t i = 0; i < kBodies; ++i) {
    const dBodyID body = articulation.body(i);
    const dReal* p = dBodyGetPosition(body);
    const dReal* r = dBodyGetRotation(body);
    const Vector3 offset = Vector3(p[0], p[1], p[2]) - pivot;
    const robot::Motion& motion = dynamics.link_velocity_B(i);
    const Vector3 w = rotation * motion.angular;
    const Vector3 v = rotation * (motion.linear + motion.angular.cross(offset));
    dMatrix3 turned{};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        for (int k = 0; k < 3; ++k) {
          turned[4 * row + column] += rotation(row, k) * r[4 * k + column];
        }
      }
    }
    const Vector3 place = pivot + rotation * offset;
    dBodySetPosition(body, place.x(), place.y(), place.z());
    dBodySetRotation(body, turned);
    dBodySetLinearVel(body, v.x(), v.y(), v.z());
    dBodySetAngularVel(body, w.x(), w.y(), w.z());
  }
}

// Our forward dynamics, midpoint rule.
void integrate(robot::Dynamics& dynamics, robot::MotionState& state,
               const robot::JointVector& torque_Nm, double h) {
  const auto acceleration = [&](const robot::MotionState& at) {
    dynamics.update(at);
    robot::MassMatrix m;
    dynamics.mass_matrix(m);
    robot::MassFactor factor;
    EXPECT_TRUE(factor.factor(m));
    robot::GeneralisedVector force = -dynamics.bias();
    force.tail<12>() += torque_Nm;
    return factor.solve(force);
  };
  const auto moved = [](const robot::MotionState& from, const robot::GeneralisedVector& nu,
                        double t) {
    robot::MotionState to = from;
    const Vector3 turn = nu.head<3>() * t;
    to.R_OB = from.R_OB * geometry::to_matrix(geometry::from_rotation_vector(turn));
    to.q_rad = from.q_rad + nu.tail<12>() * t;
    return to;
  };
  robot::MotionState middle = moved(state, state.velocity, 0.5 * h);
  middle.velocity = state.velocity + 0.5 * h * acceleration(state);
  const robot::GeneralisedVector a = acceleration(middle);
  state = moved(state, middle.velocity, h);
  // The trunk's linear velocity is in axes that turn: `a` holds the rate of its numbers.
  state.velocity += h * a;
}

// Largest relative difference of what 4 ms of motion changed the generalised velocity by.
double disagreement(const robot::RobotModel& model, std::uint64_t seed, double step_s) {
  Random random(seed);
  const World world;
  StartPose start;
  start.leg_rad = {random.uniform(-0.6, 0.6), random.uniform(-1.5, 0.5), random.uniform(0.4, 2.4)};
  start.drop_height_m = 1.0;
  Articulation articulation(world.id, model, start, step_s);
  robot::Dynamics dynamics;
  dynamics.reset(model);
  robot::GeneralisedVector nu;
  for (int i = 0; i < robot::kVelocities; ++i) nu[i] = random.uniform(-5, 5);
  const Vector3 turn{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
  throw_robot(articulation, dynamics, geometry::to_matrix(geometry::from_rotation_vector(turn)),
              nu);
  articulation.update();
  std::array<double, robot::kJoints> torques_Nm{};
  robot::JointVector torques;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    torques_Nm[i] = random.uniform(-3, 3);
    torques[static_cast<Eigen::Index>(i)] = torques_Nm[i];
  }
  robot::MotionState ours = state_of(articulation);
  EXPECT_LT((ours.velocity - nu).norm(), 1e-10);
  constexpr double kDuration_s = 0.004;
  const int steps = static_cast<int>(kDuration_s / step_s + 0.5);
  for (int i = 0; i < steps; ++i) {
    articulation.apply(torques_Nm);
    dWorldStep(world.id, step_s);
    articulation.update();
  }
  for (int i = 0; i < 400; ++i) integrate(dynamics, ours, torques, kDuration_s / 400);
  const robot::MotionState theirs = state_of(articulation);
  return (ours.velocity - theirs.velocity).norm() / (theirs.velocity - nu).norm();
}

// ODE's integrator is of first order: the difference shrinks with its step, and by as much.
void expect_like_motion(const robot::RobotModel& model, const char* name) {
  start_ode();
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double coarse = disagreement(model, seed, 2e-5);
    const double fine = disagreement(model, seed, 5e-6);
    EXPECT_LT(fine, 1e-4) << seed;
    EXPECT_LT(fine, 0.35 * coarse) << seed;
    worst = std::max(worst, fine);
  }
  std::printf("%s: largest relative difference of the change of velocity: %.2e\n", name, worst);
}

TEST(DynamicsAgainstOde, ThrownMiniCheetahsMoveAlike) {
  expect_like_motion(bare(mini_cheetah()), "Mini-Cheetah");
}

TEST(DynamicsAgainstOde, ThrownLittleDogsMoveAlike) {
  expect_like_motion(bare(robot::little_dog()), "LittleDog");
}

}  // namespace
}  // namespace surefoot::sim
