#include <algorithm>
#include <cmath>

#include "apps/surefoot-lab/jump/jump_problem.h"

namespace surefoot::apps::jump {
namespace {

constexpr double kArc_m = 0.08;  // of the feet on their way

}  // namespace

// Absolute thigh and shank angles that put a foot at (ahead, below) of its hip.
std::array<double, 2> leg_angles(const PlanarModel& model, double ahead_m, double below_m) {
  const double thigh = model.thigh_length_m;
  const double shank = model.shank_length_m;
  const double reach = std::hypot(ahead_m, below_m);
  const double knee = std::acos(
      std::clamp((reach * reach - thigh * thigh - shank * shank) / (2 * thigh * shank), -1.0, 1.0));
  const double upper = std::atan2(ahead_m, below_m) -
                       std::atan2(shank * std::sin(knee), thigh + shank * std::cos(knee));
  return {upper, upper + knee};
}

// A jump drawn by hand: the trunk on a path through lift-off, its nose up in between; feet on the
// ground while they stand, then on arcs to their landing places.
std::array<double, kCoordinates> JumpProblem::drawn_pose(const JumpNode& node) const {
  const double end_s = nodes_.back().time_s;
  const double standing_s = settings_.step_s * (settings_.steps[0] + settings_.steps[1]);
  const double front_s = settings_.step_s * settings_.steps[0];
  const double flight_s = end_s - standing_s;
  const double t = node.time_s;
  const double lift_off_z = 0.85 * (model_.thigh_length_m + model_.shank_length_m) * 0.85;
  const double lift_off_x = 0.25 * settings_.travel_m;
  std::array<double, kCoordinates> q{};
  if (t <= standing_s) {
    const double s = t / standing_s;
    q[0] = lift_off_x * s * s;
    q[1] = first_q_[1] + (lift_off_z - first_q_[1]) * s * s;
    q[2] = 0.35 * s * s * (3.0 - 2.0 * s);
  } else {
    const double s = (t - standing_s) / flight_s;
    q[0] = lift_off_x + (settings_.travel_m - lift_off_x) * s;
    q[1] = lift_off_z + (last_q_[1] - lift_off_z) * s +
           0.5 * kGravity_m_s2 * flight_s * flight_s * s * (1.0 - s);
    q[2] = 0.35 * (1.0 - s * s * (3.0 - 2.0 * s));
  }
  for (int leg = 0; leg < 2; ++leg) {
    const double hip_x = leg == 0 ? model_.hip_x_m : -model_.hip_x_m;
    const double from_s = leg == 0 ? front_s : standing_s;
    const double s = std::clamp((t - from_s) / (end_s - from_s), 0.0, 1.0);
    const double landing_m = leg == 0 ? settings_.landing_front_m : settings_.landing_hind_m;
    const double begin_x = hip_x + settings_.start_foot_m;
    const double foot_x = begin_x + (settings_.travel_m + hip_x + landing_m - begin_x) * s;
    const double foot_z = model_.foot_radius_m + settings_.rise_m * std::min(1.0, 2.0 * s) +
                          4.0 * kArc_m * s * (1.0 - s);
    const double ahead = foot_x - q[0] - hip_x * std::cos(q[2]);
    const double below = q[1] + hip_x * std::sin(q[2]) - foot_z;
    const auto angles = leg_angles(model_, ahead, below);
    q[static_cast<std::size_t>(3 + 2 * leg)] = angles[0];
    q[static_cast<std::size_t>(4 + 2 * leg)] = angles[1];
  }
  return q;
}

std::vector<double> JumpProblem::initial_guess() const {
  std::vector<double> x(static_cast<std::size_t>(variables()), 1.0);
  std::fill(x.begin(), x.end() - 3, 0.0);
  const double weight_N = model_.mass_kg() * kGravity_m_s2;
  const double h = settings_.step_s;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const JumpNode& node = nodes_[n];
    const auto set = [&](int index, double value) {
      x[n * kNodeSize + static_cast<std::size_t>(index)] = value / scale_of(index);
    };
    JumpNode before = node;
    JumpNode after = node;
    before.time_s -= 0.5 * h;
    after.time_s += 0.5 * h;
    const auto q = drawn_pose(node);
    const auto q0 = drawn_pose(before);
    const auto q1 = drawn_pose(after);
    for (int i = 0; i < kCoordinates; ++i) {
      const auto k = static_cast<std::size_t>(i);
      set(i, q[k]);
      set(kVelocity + i, n == 0 ? 0.0 : (q1[k] - q0[k]) / h);
    }
    if (node.phase == JumpPhase::kFourFeet) set(kForce + 1, 0.7 * weight_N);
    if (node.phase != JumpPhase::kFlight) {
      set(kForce + 3, node.phase == JumpPhase::kTwoFeet ? 1.6 * weight_N : 0.7 * weight_N);
    }
  }
  return x;
}

}  // namespace surefoot::apps::jump
