#include "apps/common/run_log.h"

#include <algorithm>
#include <cmath>

namespace surefoot::apps {

using autonomy::MissionPhase;

RunLog::RunLog(std::size_t capacity, bool has_truth) : has_truth_(has_truth), capacity_(capacity) {
  constexpr std::size_t kAtFirst = 4096;  // half a minute
  samples_.reserve(std::min(capacity, kAtFirst));
}

void RunLog::add(TimeNs stamp, const autonomy::Telemetry& telemetry, const sim::Truth* truth) {
  if (samples_.size() == capacity_) {
    ++dropped_;
    return;
  }
  samples_.emplace_back();
  samples_.back().stamp = stamp;
  samples_.back().telemetry = telemetry;
  if (truth != nullptr) samples_.back().truth = *truth;
}

std::size_t RunLog::walk_begin() const {
  const auto walking = [](const RunSample& s) { return s.telemetry.phase == MissionPhase::kWalk; };
  return static_cast<std::size_t>(std::find_if(samples_.begin(), samples_.end(), walking) -
                                  samples_.begin());
}

std::size_t RunLog::walk_end() const {
  std::size_t end = samples_.size();
  while (end > 0 && samples_[end - 1].telemetry.phase != MissionPhase::kWalk) --end;
  return end == 0 ? samples_.size() : end;
}

std::vector<Touchdown> RunLog::touchdowns() const {
  std::vector<Touchdown> found;
  for (std::size_t i = walk_begin() + 1; i < samples_.size(); ++i) {
    const autonomy::Telemetry& before = samples_[i - 1].telemetry;
    const autonomy::Telemetry& now = samples_[i].telemetry;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      if (before.legs[leg].stance_planned || !now.legs[leg].stance_planned) continue;
      // The plan as it stood in the last sample of the swing.
      const autonomy::LegTelemetry& plan = before.legs[leg];
      found.push_back({samples_[i].stamp, leg, plan.foothold_nominal_O_m, plan.foothold_O_m,
                       plan.foothold_reason});
    }
  }
  return found;
}

std::array<double, 3> Alignment::to_world(const std::array<double, 3>& p) const {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {p_WO_m[0] + c * p[0] - s * p[1], p_WO_m[1] + s * p[0] + c * p[1], p_WO_m[2] + p[2]};
}

std::array<double, 3> Alignment::to_odometry(const std::array<double, 3>& p) const {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  const double x = p[0] - p_WO_m[0];
  const double y = p[1] - p_WO_m[1];
  return {c * x + s * y, -s * x + c * y, p[2] - p_WO_m[2]};
}

double yaw_of(const std::array<double, 4>& q) {
  return std::atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
}

double tilt_of(const std::array<double, 4>& q) {
  return std::acos(std::clamp(1 - 2 * (q[1] * q[1] + q[2] * q[2]), -1.0, 1.0));
}

Alignment align(const RunSample& sample) {
  Alignment alignment;
  alignment.yaw_rad = yaw_of(sample.truth.q_WB_wxyz) - yaw_of(sample.telemetry.q_OB_wxyz);
  const auto turned = alignment.to_world(sample.telemetry.p_OB_m);
  for (std::size_t i = 0; i < 3; ++i) alignment.p_WO_m[i] = sample.truth.p_WB_m[i] - turned[i];
  return alignment;
}

Alignment align_at_start(const RunLog& log) {
  if (!log.has_truth() || log.samples().empty()) return {};
  return align(log.samples()[std::min(log.walk_begin(), log.samples().size() - 1)]);
}

}  // namespace surefoot::apps
