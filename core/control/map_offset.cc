#include "core/control/map_offset.h"

#include <utility>

#include "core/mapping/foothold.h"
#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

// After the contact was noticed: the foot has come to rest, the ball of rubber is pressed.
constexpr std::uint32_t kSettledTicks = 10;
constexpr double kHangs_m = 0.015;  // above the map's highest cell under the foot

}  // namespace

void MapOffset::reset(double max_offset_m, double foot_radius_m) {
  max_offset_m_ = max_offset_m;
  foot_radius_m_ = foot_radius_m;
  clear();
}

void MapOffset::clear() {
  noted_.fill(false);
  offset_m_ = 0;
}

void MapOffset::update(const estimation::RobotState& state,
                       const std::array<LegStatus, robot::kLegs>& legs,
                       const mapping::MapWindow* window) {
  if (window == nullptr) return;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const estimation::FootState& foot = state.feet[leg];
    const bool stands = legs[leg].mode == LegMode::kStance && foot.in_contact;
    if (!stands || foot.ticks_since_change != kSettledTicks) continue;
    const Result<double> map_m = mapping::level_ground_m(*window, foot.p_O_m[0], foot.p_O_m[1]);
    if (!map_m.ok()) continue;
    note_m_[leg] = foot.p_O_m[2] - foot_radius_m_ - map_m.value();
    noted_[leg] = true;
  }
  offset_m_ = math::clamp(middle(), -max_offset_m_, max_offset_m_);
}

bool MapOffset::hangs(const Vector3& foot_O_m, const mapping::MapWindow* window) const {
  if (window == nullptr) return false;
  const Result<mapping::CellIndex> under = window->locate(foot_O_m[0], foot_O_m[1]);
  if (!under.ok()) return false;
  const Result<float> ground_m = mapping::highest_ground_m(*window, under.value());
  if (!ground_m.ok()) return false;
  const double above_m = foot_O_m[2] - foot_radius_m_ - offset_m_;
  return above_m - static_cast<double>(ground_m.value()) > kHangs_m;
}

// Of the notes there are: the middle one, or the mean of the middle two.
double MapOffset::middle() const {
  std::array<double, robot::kLegs> sorted{};
  std::size_t count = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (!noted_[leg]) continue;
    std::size_t place = count++;
    sorted[place] = note_m_[leg];
    for (; place > 0 && sorted[place] < sorted[place - 1]; --place) {
      std::swap(sorted[place], sorted[place - 1]);
    }
  }
  if (count == 0) return 0.0;
  return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

}  // namespace surefoot::control
