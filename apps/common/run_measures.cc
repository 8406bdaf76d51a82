#include "apps/common/run_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/autonomy/autonomy.h"

namespace surefoot::apps {
namespace {

constexpr double kPathStep_m = 0.05;
constexpr double kSlip_m = 0.02;
constexpr double kTouchApart_s = 0.2;  // touches closer than this are one

using Position = std::array<double, 3>;

double plane_distance(const Position& a, const Position& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

double distance(const Position& a, const Position& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Position body(const RunLog& log, const RunSample& sample) {
  return log.has_truth() ? sample.truth.p_WB_m : sample.telemetry.p_OB_m;
}

double path_length(const RunLog& log, std::size_t begin, std::size_t end) {
  double length = 0;
  Position last = body(log, log.samples()[begin]);
  for (std::size_t i = begin; i < end; ++i) {
    const Position now = body(log, log.samples()[i]);
    if (plane_distance(last, now) < kPathStep_m && i + 1 < end) continue;
    length += plane_distance(last, now);
    last = now;
  }
  return length;
}

std::uint64_t count_slips(const RunLog& log, std::size_t begin, std::size_t end) {
  std::uint64_t slips = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    bool contact = false;
    bool counted = false;
    double slip_at_touch = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const sim::FootTruth& foot = log.samples()[i].truth.feet[leg];
      if (foot.contact && !contact) {
        slip_at_touch = foot.slip_m;
        counted = false;
      }
      contact = foot.contact;
      if (contact && !counted && foot.slip_m - slip_at_touch > kSlip_m) {
        ++slips;
        counted = true;
      }
    }
  }
  return slips;
}

std::uint64_t count_touches(const RunLog& log, std::size_t begin, std::size_t end) {
  std::uint64_t touches = 0;
  std::uint64_t obstacle_steps = 0;
  // Index 0 the trunk, then the legs, at last any part on the obstacle.
  std::array<double, robot::kLegs + 2> last_s;
  last_s.fill(-1e9);
  for (std::size_t i = begin; i < end; ++i) {
    const RunSample& sample = log.samples()[i];
    for (std::size_t part = 0; part < last_s.size(); ++part) {
      bool touching = sample.truth.trunk_contact;
      if (part > robot::kLegs) {
        touching = sample.truth.obstacle_steps > obstacle_steps;
        obstacle_steps = sample.truth.obstacle_steps;
      } else if (part > 0) {
        touching = sample.truth.leg_contact[part - 1];
      }
      if (!touching) continue;
      const double now = sample.stamp.seconds();
      if (now - last_s[part] > kTouchApart_s) ++touches;
      last_s[part] = now;
    }
  }
  return touches;
}

// Forward, left and turning speed of a sample, axes of the heading.
std::array<double, 3> heading_speeds(const RunLog& log, const RunSample& sample) {
  const bool truth = log.has_truth();
  const Position& v = truth ? sample.truth.v_WB_m_s : sample.telemetry.v_OB_m_s;
  const double yaw = yaw_of(truth ? sample.truth.q_WB_wxyz : sample.telemetry.q_OB_wxyz);
  const Position& rate =
      truth ? sample.truth.angular_velocity_B_rad_s : sample.telemetry.angular_velocity_B_rad_s;
  return {v[0] * std::cos(yaw) + v[1] * std::sin(yaw), v[1] * std::cos(yaw) - v[0] * std::sin(yaw),
          rate[2]};
}

// The largest, over all windows of `window` values, of the smallest of their means over `mean`
// values in a row.
double sustained(const std::vector<double>& values, std::size_t mean, std::size_t window) {
  if (values.size() < window || mean == 0) return 0;
  std::vector<double> means;
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    if (i >= mean) sum -= values[i - mean];
    if (i + 1 >= mean) means.push_back(sum / static_cast<double>(mean));
  }
  const auto count = static_cast<std::ptrdiff_t>(window - mean + 1);
  double best = 0;
  for (auto first = means.begin(); means.end() - first >= count; ++first) {
    best = std::max(best, *std::min_element(first, first + count));
  }
  return best;
}

SustainedSpeeds sustained_speeds(const RunLog& log, std::size_t begin, std::size_t end) {
  constexpr double kSamples_1_s = 1.0 / (kTicksPerSample * autonomy::kTickPeriod.seconds());
  constexpr auto kMean = static_cast<std::size_t>(0.5 * kSamples_1_s);
  constexpr auto kWindow = static_cast<std::size_t>(5.0 * kSamples_1_s);
  std::array<std::vector<double>, 5> columns;  // forward, left, right, turning left, right
  for (std::size_t i = begin; i < end; ++i) {
    const auto [forward, left, turn] = heading_speeds(log, log.samples()[i]);
    columns[0].push_back(forward);
    columns[1].push_back(left);
    columns[2].push_back(-left);
    columns[3].push_back(turn);
    columns[4].push_back(-turn);
  }
  std::array<double, 5> best{};
  for (std::size_t i = 0; i < best.size(); ++i) best[i] = sustained(columns[i], kMean, kWindow);
  return {best[0], std::max(best[1], best[2]), std::max(best[3], best[4])};
}

EstimateErrors estimate_errors(const RunLog& log, std::size_t begin, std::size_t end,
                               double path_length_m) {
  EstimateErrors errors;
  const Alignment alignment = align(log.samples()[begin]);
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const RunSample& sample = log.samples()[i];
    const double off = distance(alignment.to_world(sample.telemetry.p_OB_m), sample.truth.p_WB_m);
    sum += off * off;
    errors.end_error_m = off;
  }
  errors.rms_error_m = std::sqrt(sum / static_cast<double>(end - begin));
  if (path_length_m > 0) errors.drift_percent = 100 * errors.end_error_m / path_length_m;
  return errors;
}

// Up is what looks like it, not what the robot believes.
bool is_up(const sim::Truth& truth, double standing_height_m) {
  constexpr double kTilt_rad = 0.3;
  constexpr double kHeightShare = 0.8;
  double feet_m = 0;
  for (const sim::FootTruth& foot : truth.feet) feet_m += foot.p_WF_m[2] / robot::kLegs;
  return tilt_of(truth.q_WB_wxyz) < kTilt_rad && !truth.trunk_contact &&
         truth.p_WB_m[2] - feet_m > kHeightShare * standing_height_m;
}

}  // namespace

RecoveryFigures measure_recovery(const RunLog& log, double standing_height_m,
                                 const std::array<double, robot::kJoints>& torque_limit_Nm) {
  constexpr double kHold_s = 0.5;
  RecoveryFigures figures;
  if (!log.has_truth()) return figures;
  bool down = false;
  double down_since_s = 0;
  double up_since_s = 0;
  bool was_up = false;
  for (const RunSample& sample : log.samples()) {
    const double now_s = sample.stamp.seconds();
    if (!down && sample.telemetry.phase == autonomy::MissionPhase::kRecover) {
      down = true;
      down_since_s = now_s;
      was_up = false;
      ++figures.count;
    }
    if (!down) continue;
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      const double share = std::fabs(sample.truth.joints[i].motor_torque_Nm) / torque_limit_Nm[i];
      figures.max_torque_share = std::max(figures.max_torque_share, share);
    }
    const bool up = is_up(sample.truth, standing_height_m);
    if (up && !was_up) up_since_s = now_s;
    was_up = up;
    if (!up || now_s - up_since_s < kHold_s) continue;
    down = false;
    ++figures.stood;
    figures.time_to_stand_s = std::max(figures.time_to_stand_s, up_since_s - down_since_s);
  }
  return figures;
}

RunMeasures measure(const RunLog& log, double goal_x_m, double course_m) {
  RunMeasures measures;
  const bool has_goal = goal_x_m >= 0;
  const std::size_t begin = log.walk_begin();
  const std::size_t end = log.walk_end();
  if (begin >= end) {
    if (has_goal && !log.samples().empty()) {
      measures.start_to_goal_m = plane_distance(body(log, log.samples().back()), {goal_x_m, 0, 0});
    }
    return measures;
  }
  const Position goal{has_goal ? goal_x_m : 0.0, 0, 0};
  const Position start = body(log, log.samples()[begin]);
  const Position last = body(log, log.samples()[end - 1]);
  measures.walk_s = (log.samples()[end - 1].stamp - log.samples()[begin].stamp).seconds();
  measures.path_length_m = path_length(log, begin, end);
  if (has_goal) {
    measures.start_to_goal_m = plane_distance(start, goal);
    const double made = measures.start_to_goal_m - plane_distance(last, goal);
    if (measures.walk_s > 0) measures.mean_speed_m_s = std::max(0.0, made / measures.walk_s);
  }
  if (course_m > 0) {
    measures.start_to_goal_m = course_m;
    measures.mean_speed_m_s = measures.walk_s > 0 ? measures.path_length_m / measures.walk_s : 0.0;
  }
  measures.sustained = sustained_speeds(log, begin, end);
  if (!log.has_truth()) return measures;
  measures.foot_slips = count_slips(log, begin, end);
  measures.collisions = count_touches(log, begin, end);
  measures.estimate = estimate_errors(log, begin, end, measures.path_length_m);
  return measures;
}

double least_clearance_m(const RunLog& log) {
  double least_m = sim::kMaxClearance_m;
  for (std::size_t i = log.walk_begin(); i < log.walk_end(); ++i) {
    least_m = std::min(least_m, log.samples()[i].truth.clearance_m);
  }
  return least_m;
}

}  // namespace surefoot::apps
