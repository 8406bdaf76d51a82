#include "apps/common/run_measures.h"

#include <algorithm>
#include <array>
#include <cmath>

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
  // Index 0 the trunk, then the legs.
  std::array<double, robot::kLegs + 1> last_s;
  last_s.fill(-1e9);
  for (std::size_t i = begin; i < end; ++i) {
    const RunSample& sample = log.samples()[i];
    for (std::size_t part = 0; part < last_s.size(); ++part) {
      const bool touching =
          part == 0 ? sample.truth.trunk_contact : sample.truth.leg_contact[part - 1];
      if (!touching) continue;
      const double now = sample.stamp.seconds();
      if (now - last_s[part] > kTouchApart_s) ++touches;
      last_s[part] = now;
    }
  }
  return touches;
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

}  // namespace

RunMeasures measure(const RunLog& log, double goal_x_m) {
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
  if (!log.has_truth()) return measures;
  measures.foot_slips = count_slips(log, begin, end);
  measures.collisions = count_touches(log, begin, end);
  measures.estimate = estimate_errors(log, begin, end, measures.path_length_m);
  return measures;
}

}  // namespace surefoot::apps
