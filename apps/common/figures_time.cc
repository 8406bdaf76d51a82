// Figures over time and of time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "apps/common/axes.h"
#include "apps/common/figures.h"
#include "apps/common/leg_curves.h"

namespace surefoot::apps {
namespace {

constexpr double kWidth = 1000;
constexpr double kLeft = 66;
constexpr double kRight = 34;
constexpr double kDegrees = 180.0 / std::numbers::pi;

using Value = std::function<double(const RunSample&)>;

std::vector<double> column(const RunLog& log, const Value& value) {
  std::vector<double> values;
  values.reserve(log.samples().size());
  for (const RunSample& sample : log.samples()) values.push_back(value(sample));
  return values;
}

std::vector<double> seconds(const RunLog& log) {
  return column(log, [](const RunSample& s) { return s.stamp.seconds(); });
}

Limits time_limits(const std::vector<double>& t) {
  return t.size() < 2 ? Limits{0, 1} : Limits{t.front(), t.back()};
}

// Along the walking direction in the horizontal plane.
double horizontal_speed(const std::array<double, 3>& v, double yaw) {
  return v[0] * std::cos(yaw) + v[1] * std::sin(yaw);
}

// Begin and end of walking.
void mark_walking(const RunLog& log, Axes& axes) {
  const std::size_t begin = log.walk_begin();
  const std::size_t end = log.walk_end();
  if (begin >= end) return;
  const Stroke edge{palette::kFaint, 1, true};
  for (const std::size_t i : {begin, end - 1}) {
    axes.vertical(log.samples()[i].stamp.seconds(), edge);
  }
}

Rectangle row_area(int row, double row_height, double height) {
  return {kLeft, 40 + row * row_height, kWidth - kLeft - kRight, height};
}

}  // namespace

Drawing motion_figure(const RunLog& log) {
  constexpr double kRowHeight = 190;
  Drawing drawing(kWidth, 3 * kRowHeight + 66);
  const std::vector<double> t = seconds(log);
  const Limits time = time_limits(t);
  const Stroke truth{palette::kInk, 1.2, false};
  const Stroke estimate{palette::kBlue, 1.2, false};
  const Stroke command{palette::kRed, 1.4, true};

  const auto row = [&](int index, const AxesLabels& labels, const std::vector<double>& estimated,
                       const std::vector<double>& real, const std::vector<double>& commanded) {
    Limits y = limits_of(estimated, 0.08);
    if (log.has_truth()) y = joined(y, limits_of(real, 0.08));
    if (!commanded.empty()) y = joined(y, limits_of(commanded, 0.08));
    Axes axes(drawing, row_area(index, kRowHeight, 140), time, y, labels);
    mark_walking(log, axes);
    std::vector<LegendItem> legend;
    if (log.has_truth()) {
      axes.series(t, real, truth);
      legend.push_back({"truth", truth});
    }
    axes.series(t, estimated, estimate);
    legend.push_back({"estimate", estimate});
    if (!commanded.empty()) {
      axes.series(t, commanded, command);
      legend.push_back({"command", command});
    }
    axes.legend(legend);
  };

  row(0, {"Forward speed", "", "m/s", 10, 4, true},
      column(log,
             [](const RunSample& s) {
               return horizontal_speed(s.telemetry.v_OB_m_s, yaw_of(s.telemetry.q_OB_wxyz));
             }),
      column(log,
             [](const RunSample& s) {
               return horizontal_speed(s.truth.v_WB_m_s, yaw_of(s.truth.q_WB_wxyz));
             }),
      column(log, [](const RunSample& s) { return s.telemetry.velocity_command_B[0]; }));
  row(1, {"Tilt of the trunk", "", "degrees", 10, 4, true},
      column(log, [](const RunSample& s) { return tilt_of(s.telemetry.q_OB_wxyz) * kDegrees; }),
      column(log, [](const RunSample& s) { return tilt_of(s.truth.q_WB_wxyz) * kDegrees; }), {});
  const double shift = align_at_start(log).p_WO_m[2];
  row(2, {"Height of the trunk", "time [s]", "m", 10, 4, true},
      column(log, [&](const RunSample& s) { return s.telemetry.p_OB_m[2] + shift; }),
      column(log, [](const RunSample& s) { return s.truth.p_WB_m[2]; }), {});
  return drawing;
}

Drawing torque_figure(const RunLog& log, const robot::RobotModel& robot) {
  constexpr double kRowHeight = 190;
  Drawing drawing(kWidth, 3 * kRowHeight + 66);
  const std::vector<double> t = seconds(log);
  for (std::size_t joint = 0; joint < robot::kJointsPerLeg; ++joint) {
    const double limit = robot.actuators[joint].torque_limit_Nm;
    const bool last = joint + 1 == robot::kJointsPerLeg;
    Axes axes(drawing, row_area(static_cast<int>(joint), kRowHeight, 140), time_limits(t),
              {-1.12 * limit, 1.12 * limit},
              {kTorqueTitles[joint], last ? "time [s]" : "", "N m", 10, 4, true});
    draw_torques(axes, t, log.samples(), joint, limit, 1);
  }
  return drawing;
}

Drawing gait_figure(const RunLog& log) {
  constexpr double kShown_s = 4.0;  // a few strides from the middle of the walk
  constexpr double kRow = 30;
  Drawing drawing(kWidth, 40 + 4 * kRow + 62);
  const std::vector<RunSample>& samples = log.samples();
  const std::size_t begin = log.walk_begin();
  const std::size_t end = log.walk_end();
  Limits time{0, 1};
  if (begin < end) {
    const double from = samples[begin].stamp.seconds();
    const double to = samples[end - 1].stamp.seconds();
    const double start = std::max(from, 0.5 * (from + to) - 0.5 * kShown_s);
    time = {start, std::max(start + 0.1, std::min(to, start + kShown_s))};
  }
  const Rectangle area{kLeft, 40, kWidth - kLeft - kRight, 4 * kRow};
  Axes axes(drawing, area, time, {0, 4},
            {"Stance and swing, middle of the walk", "time [s]", "", 8, 0, true});
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const double top = 4 - static_cast<double>(leg);
    drawing.text({kLeft - 8, axes.at(time.low, top - 0.5).y + 4}, kLegNames[leg],
                 {12, palette::kInk, Anchor::kEnd, false, false});
    for (std::size_t i = begin; i + 1 < end; ++i) {
      const autonomy::LegTelemetry& now = samples[i].telemetry.legs[leg];
      const double a = samples[i].stamp.seconds();
      const double b = samples[i + 1].stamp.seconds();
      if (b < time.low || a > time.high) continue;
      if (now.stance_planned) axes.band(a, b, top - 0.62, top - 0.14, palette::kBlue);
      if (now.contact) axes.band(a, b, top - 0.88, top - 0.70, palette::kOrange);
    }
  }
  axes.frame();
  axes.legend({{"stance planned", {palette::kBlue, 1, false}, LegendItem::Mark::kBox},
               {"contact estimated", {palette::kOrange, 1, false}, LegendItem::Mark::kBox}});
  return drawing;
}

Drawing timing_figure(const std::vector<runtime::TaskReport>& tasks) {
  constexpr double kRow = 34;
  constexpr double kNames = 150;
  const auto rows = static_cast<double>(std::max<std::size_t>(1, tasks.size()));
  Drawing drawing(kWidth, 40 + rows * kRow + 62);
  double longest = 10;
  for (const runtime::TaskReport& task : tasks) {
    longest = std::max({longest, task.max_us, static_cast<double>(task.budget_us)});
  }
  // Decades: a mapping task takes thousands of times longer than a small one.
  const Limits decades{0, std::log10(longest) + 0.1};
  const Rectangle area{kNames, 40, kWidth - kNames - kRight, rows * kRow};
  Axes axes(drawing, area, decades, {0, rows}, {"Task times", "", "", 0, 0, false});
  const auto place = [&](double us) { return std::log10(std::max(1.0, us)); };
  for (int decade = 0; decade <= static_cast<int>(decades.high); ++decade) {
    axes.vertical(decade, {palette::kGrid, 1, false});
    drawing.text({axes.at(decade, 0).x, area.bottom() + 16},
                 fmt::format("{:.0f}", std::pow(10, decade)),
                 {11, palette::kFaint, Anchor::kMiddle, false, false});
  }
  drawing.text({area.x + area.width / 2, area.bottom() + 34}, "microseconds, logarithmic",
               {12, palette::kInk, Anchor::kMiddle, false, false});
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const runtime::TaskReport& task = tasks[i];
    const double top = rows - static_cast<double>(i);
    drawing.text({kNames - 10, axes.at(0, top - 0.5).y + 4}, task.name,
                 {12, palette::kInk, Anchor::kEnd, false, false});
    axes.band(0, place(task.p50_us), top - 0.72, top - 0.28, palette::kBlue);
    axes.band(place(task.p50_us), place(task.p99_us), top - 0.72, top - 0.28, palette::kSky);
    drawing.dot(axes.at(place(task.max_us), top - 0.5), 4, palette::kOrange);
    if (task.budget_us == 0) continue;
    const double budget = place(task.budget_us);
    drawing.line(axes.at(budget, top - 0.9), axes.at(budget, top - 0.1), {palette::kRed, 2, false});
  }
  axes.frame();
  axes.legend({{"median", {palette::kBlue, 1, false}, LegendItem::Mark::kBox},
               {"99 %", {palette::kSky, 1, false}, LegendItem::Mark::kBox},
               {"maximum", {palette::kOrange, 1, false}, LegendItem::Mark::kDot},
               {"budget", {palette::kRed, 2, false}}});
  return drawing;
}

}  // namespace surefoot::apps
