#include "core/control/standing_feet.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

constexpr double kLost_s = 0.03;

}  // namespace

planning::Feet feet_of(const estimation::RobotState& state) {
  planning::Feet feet;
  for (std::size_t i = 0; i < robot::kLegs; ++i) feet[i] = state.feet[i].p_O_m;
  return feet;
}

void StandingFeet::reset(const SwingConfig& swing, const StaticWalkConfig& walk) {
  swing_ = swing;
  walk_ = walk;
  places_O_m_.fill(Vector3::Zero());
  taken_O_m_.fill(Vector3::Zero());
  lost_s_.fill(0);
}

void StandingFeet::take(const estimation::RobotState& state) {
  places_O_m_ = feet_of(state);
  taken_O_m_ = places_O_m_;
  lost_s_.fill(0);
}

void StandingFeet::put(std::size_t leg, const Vector3& place_O_m) {
  places_O_m_[leg] = place_O_m;
  taken_O_m_[leg] = place_O_m;
}

void StandingFeet::follow(const estimation::RobotState& state, const LegStatuses& legs,
                          const LoadShares& shares, double step_s) {
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (legs[i].mode != LegMode::kStance) continue;
    const estimation::FootState& foot = state.feet[i];
    Vector3& place = places_O_m_[i];
    lost_s_[i] = foot.in_contact || shares[i] < 1.0 ? 0.0 : lost_s_[i] + step_s;
    if (lost_s_[i] > kLost_s) {
      const double lowest_m = taken_O_m_[i][2] - swing_.search_depth_m;
      place[2] = std::max(lowest_m, place[2] - swing_.search_speed_m_s * step_s);
      continue;
    }
    const Vector3 off = foot.p_O_m - place;
    const double off_m = math::sqrt(off.squaredNorm());
    if (foot.in_contact && off_m > walk_.slack_m) place += off * (1.0 - walk_.slack_m / off_m);
  }
}

bool StandingFeet::have_slipped(const estimation::RobotState& state, std::size_t stepping) const {
  const double limit_m2 = math::square(walk_.slip_m);
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (i == stepping) continue;
    if ((state.feet[i].p_O_m - taken_O_m_[i]).squaredNorm() > limit_m2) return true;
  }
  return false;
}

bool StandingFeet::have_lost_ground(std::size_t stepping) const {
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (i != stepping && lost_s_[i] > kLost_s) return true;
  }
  return false;
}

}  // namespace surefoot::control
