// Problems for the predictive controller: every gait, nominal and disturbed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/random.h"
#include "core/control/convex_mpc.h"
#include "core/geometry/rotations.h"

namespace surefoot::tests {

struct MpcGait {
  const char* name;
  double period_s;
  double stance_share;
  std::array<double, robot::kLegs> offset;  // FR FL HR HL
};

inline constexpr std::array<MpcGait, 7> kMpcGaits{{
    {"trot", 0.40, 0.50, {0.0, 0.5, 0.5, 0.0}},
    {"trot_run", 0.30, 0.40, {0.0, 0.5, 0.5, 0.0}},
    {"pronk", 0.40, 0.40, {0.0, 0.0, 0.0, 0.0}},
    {"bound", 0.36, 0.40, {0.5, 0.5, 0.0, 0.0}},
    {"pace", 0.40, 0.50, {0.5, 0.0, 0.5, 0.0}},
    {"walk", 1.00, 0.80, {0.25, 0.0, 0.75, 0.5}},
    {"stand", 0.40, 1.00, {0.0, 0.0, 0.0, 0.0}},
}};

inline control::MpcConfig mpc_config(double step_s = 0.03) {
  control::MpcConfig c;
  c.step_s = step_s;
  c.friction = 0.4;
  c.min_normal_N = 5.0;
  c.max_normal_N = 120.0;
  c.attitude_weight = {0.25, 0.25, 10.0};
  c.position_weight = {2.0, 2.0, 50.0};
  c.rate_weight = {0.0, 0.0, 0.3};
  c.velocity_weight = {0.2, 0.2, 0.1};
  c.effort_weight = 4e-5;
  c.max_residual_N = 10.0;
  return c;
}

inline Vector3 normal_vector(Random& random, double x, double y, double z) {
  Vector3 v;
  v[0] = x * random.normal();
  v[1] = y * random.normal();
  v[2] = z * random.normal();
  return v;
}

inline Vector3 uniform_vector(Random& random, const Vector3& low, const Vector3& high) {
  Vector3 v;
  for (int i = 0; i < 3; ++i) v[i] = random.uniform(low[i], high[i]);
  return v;
}

// Walks with a random command at a random phase. `disturbed` is the size of the deviation from the
// reference: 1 is sigma 0.25 rad in attitude, 0.5 m/s, 1 rad/s, 0.05 m.
inline control::MpcProblem random_mpc_problem(Random& random, const MpcGait& gait,
                                              const control::MpcConfig& config, double disturbed) {
  control::MpcProblem problem;
  problem.mass_kg = 9.0;
  problem.inertia_B_kg_m2 = Vector3(0.07, 0.26, 0.242).asDiagonal();
  const double yaw_rad = random.uniform(-3.1, 3.1);
  const double yaw_rate_rad_s = random.uniform(-1.5, 1.5);
  const double phase = random.uniform();
  const Matrix3 heading = geometry::rotation_z(yaw_rad);
  const Vector3 velocity =
      heading * uniform_vector(random, Vector3(-0.5, -0.5, 0.0), Vector3(2.0, 0.5, 0.0));
  const Vector3 start = uniform_vector(random, Vector3(-3.0, -3.0, 0.29), Vector3(3.0, 3.0, 0.29));

  const Vector3 tilt = disturbed * normal_vector(random, 0.25, 0.25, 0.25);
  problem.R_OB = geometry::from_roll_pitch_yaw(tilt[0], tilt[1], yaw_rad + tilt[2]);
  problem.p_OB_m = start + disturbed * normal_vector(random, 0.05, 0.05, 0.04);
  problem.v_OB_m_s = velocity + disturbed * normal_vector(random, 0.5, 0.5, 0.4);
  problem.angular_velocity_O_rad_s =
      Vector3(0.0, 0.0, yaw_rate_rad_s) + disturbed * normal_vector(random, 1.0, 1.0, 1.0);

  for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
    const double end_s = static_cast<double>(k + 1) * config.step_s;
    control::MpcState& reference = problem.reference[k];
    reference.p_OB_m = start + end_s * velocity;
    reference.v_OB_m_s = velocity;
    reference.roll_pitch_yaw_rad = Vector3(0.0, 0.0, yaw_rad + end_s * yaw_rate_rad_s);
    reference.angular_velocity_O_rad_s = Vector3(0.0, 0.0, yaw_rate_rad_s);
  }
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 scatter = normal_vector(random, 0.02, 0.015, 0.01);
    for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
      const double middle_s = (static_cast<double>(k) + 0.5) * config.step_s;
      const double cycles = phase + gait.offset[leg] + middle_s / gait.period_s;
      const double whole = static_cast<double>(static_cast<int>(cycles));
      const double share = cycles - whole;
      problem.stands[k][leg] = share < gait.stance_share;
      // Where the foot was or will be set down: half a stance ahead of the hip at touchdown.
      const double since_s = share * gait.period_s;
      const double stance_s = gait.stance_share * gait.period_s;
      const double at_s = gait.stance_share < 1.0 ? middle_s - since_s + 0.5 * stance_s : 0.0;
      const Matrix3 turn = geometry::rotation_z(yaw_rad + at_s * yaw_rate_rad_s);
      const Vector3 hip(robot::front_sign(leg) * 0.19, robot::left_sign(leg) * 0.115, -0.29);
      problem.contact_O_m[k][leg] = start + at_s * velocity + turn * hip + scatter;
    }
  }
  return problem;
}

// By how much a plan leaves the pyramids; feet that do not stand must have exactly nothing.
inline double violation_N(const control::MpcProblem& problem, const control::MpcSolution& solution,
                          const control::MpcConfig& c) {
  double worst = 0;
  for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const Vector3& f = solution.force_O_N[k][leg];
      if (!problem.stands[k][leg]) {
        worst = std::max(worst, f == Vector3::Zero() ? 0.0 : f.norm() + 1.0);
        continue;
      }
      if (!f.allFinite()) return std::numeric_limits<double>::infinity();
      worst =
          std::max({worst, std::fabs(f[0]) - c.friction * f[2], std::fabs(f[1]) - c.friction * f[2],
                    c.min_normal_N - f[2], f[2] - c.max_normal_N});
    }
  }
  return worst;
}

}  // namespace surefoot::tests
