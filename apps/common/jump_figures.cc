#include "apps/common/jump_figures.h"

#include <algorithm>
#include <cmath>

namespace surefoot::apps {
namespace {

using motions::JumpStage;

constexpr double kOneLevel_m = 0.03;

int standing_feet(const sim::Truth& truth) {
  double highest_m = -1e9;
  for (const sim::FootTruth& foot : truth.feet) highest_m = std::max(highest_m, foot.p_WF_m[2]);
  return static_cast<int>(
      std::count_if(truth.feet.begin(), truth.feet.end(), [&](const sim::FootTruth& foot) {
        return foot.contact && foot.p_WF_m[2] > highest_m - kOneLevel_m;
      }));
}

bool in_the_air(const sim::Truth& truth) {
  return std::none_of(truth.feet.begin(), truth.feet.end(),
                      [](const sim::FootTruth& foot) { return foot.contact; });
}

}  // namespace

JumpFigures measure_jumps(const RunLog& log,
                          const std::array<double, robot::kJoints>& torque_limit_Nm) {
  JumpFigures figures;
  if (log.samples().empty()) return figures;
  const autonomy::JumpCounters& counters = log.samples().back().telemetry.jump.counters;
  figures.attempts = counters.attempts;
  figures.jumps = counters.jumps;
  figures.refusals = counters.refusals;
  figures.last_refusal =
      motions::kJumpRefusalNames[static_cast<std::size_t>(counters.last_refusal)];
  if (!log.has_truth()) return figures;
  JumpStage before = JumpStage::kIdle;
  double lift_off_s = 0;
  double sinking_m_s = 0;
  bool flew = false;
  for (const RunSample& sample : log.samples()) {
    const JumpStage stage = sample.telemetry.jump.stage;
    const bool plays = stage >= JumpStage::kPushFour && stage <= JumpStage::kRise;
    if (plays) {
      for (std::size_t i = 0; i < robot::kJoints; ++i) {
        const double share = std::fabs(sample.truth.joints[i].motor_torque_Nm) / torque_limit_Nm[i];
        figures.max_torque_share = std::max(figures.max_torque_share, share);
      }
    }
    const bool flies = plays && stage <= JumpStage::kLanding && in_the_air(sample.truth);
    if (flies && !flew) lift_off_s = sample.stamp.seconds();
    if (!flies && flew) {
      figures.flight_s = sample.stamp.seconds() - lift_off_s;
      figures.landing_speed_m_s = sinking_m_s;
    }
    flew = flies;
    sinking_m_s = -sample.truth.v_WB_m_s[2];
    if (before == JumpStage::kLanding && stage != before) {
      figures.landed_feet = std::min(figures.landed_feet, standing_feet(sample.truth));
    }
    before = stage;
  }
  if (before >= JumpStage::kPushFour && before <= JumpStage::kLanding) figures.landed_feet = 0;
  return figures;
}

}  // namespace surefoot::apps
