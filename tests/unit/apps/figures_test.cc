// Drawing code on a synthetic run: what must be visible is there, and nothing breaks on an empty
// log.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "apps/common/axes.h"
#include "apps/common/figures.h"

namespace surefoot::apps {
namespace {

using autonomy::MissionPhase;
using control::FootholdReason;

// Three metres of trot over a field of bumps, with a little drift.
RunLog synthetic_log() {
  RunLog log(4000, true);
  for (int i = 0; i < 1500; ++i) {
    const double t = i * 0.008;
    autonomy::Telemetry telemetry;
    sim::Truth truth;
    telemetry.phase = t < 2    ? MissionPhase::kSettle
                      : t < 10 ? MissionPhase::kWalk
                               : MissionPhase::kArrived;
    const double walked = std::clamp(t - 2, 0.0, 8.0) * 0.375;
    truth.p_WB_m = {walked, 0.04 * std::sin(walked * 2), 0.28 + 0.006 * std::sin(12 * t)};
    truth.v_WB_m_s = {t > 2 && t < 10 ? 0.375 + 0.05 * std::sin(15 * t) : 0.0, 0, 0};
    telemetry.p_OB_m = {walked * 1.01, truth.p_WB_m[1], 0.281};
    telemetry.v_OB_m_s = {truth.v_WB_m_s[0] + 0.01 * std::sin(40 * t), 0, 0};
    telemetry.velocity_command_B = {t > 2 && t < 10 ? 0.4 : 0.0, 0, 0};
    for (std::size_t leg = 0; leg < 4; ++leg) {
      const bool first = leg == 0 || leg == 3;
      const bool swing = t > 2 && t < 10 && (std::fmod(t, 0.5) < 0.25) == first;
      auto& shown = telemetry.legs[leg];
      shown.stance_planned = !swing;
      shown.contact = (std::fmod(t + 0.02, 0.5) < 0.25) != first;
      const double x = walked + robot::front_sign(leg) * 0.19;
      const double y = truth.p_WB_m[1] + robot::left_sign(leg) * 0.11;
      shown.foothold_nominal_O_m = {x, y, 0};
      shown.foothold_reason = i % 3 == 0 ? FootholdReason::kMoved : FootholdReason::kNominal;
      shown.foothold_O_m = {x + (i % 3 == 0 ? 0.03 : 0.0), y + (i % 3 == 0 ? 0.02 : 0.0), 0};
      truth.feet[leg].p_WF_m = {x + 0.03 * std::sin(12 * t), y, 0};
      for (std::size_t joint = 0; joint < 3; ++joint) {
        telemetry.joints[robot::joint_index(leg, joint)].torque_Nm =
            (4.0 + 3.0 * static_cast<double>(joint)) * std::sin(12 * t + static_cast<double>(leg)) *
            (t > 1 ? 1 : 0.1);
      }
    }
    log.add(TimeNs{static_cast<std::int64_t>(t * 1e9)}, telemetry, &truth);
  }
  return log;
}

TerrainFigure synthetic_terrain(const RunLog& log) {
  TerrainFigure figure;
  figure.truth = HeightGrid(-0.6, -0.75, 4.2, 1.5, 0.015);
  figure.perceived = figure.truth;
  figure.classes = ClassGrid(figure.truth);
  figure.goal_x_m = 3.0;
  figure.lane_half_width_m = 0.6;
  figure.O_in_W = align_at_start(log);
  for (int row = 0; row < figure.truth.rows; ++row) {
    for (int column = 0; column < figure.truth.columns; ++column) {
      const double x = figure.truth.x_of(column);
      const double y = figure.truth.y_of(row);
      const bool box = x > 0.4 && x < 2.7 && std::sin(11 * x) * std::cos(13 * y + x) > 0.3;
      const double height = box ? 0.03 + 0.02 * std::sin(5 * x + 3 * y) : 0.0;
      figure.truth.set(column, row, height);
      if (std::fabs(y) < 0.5 + 0.1 * std::sin(9 * x) && x > -0.3) {
        figure.perceived.set(column, row, height + 0.004 * std::sin(70 * x) * std::sin(90 * y));
      }
    }
  }
  return figure;
}

// SUREFOOT_PICTURES=dir keeps the pictures for a look.
void keep(const Drawing& drawing, const std::string& name) {
  const char* folder = std::getenv("SUREFOOT_PICTURES");
  if (folder == nullptr) return;
  const auto png = to_png(drawing);
  std::ofstream(std::string(folder) + "/" + name + ".png", std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  std::ofstream(std::string(folder) + "/" + name + ".svg") << to_svg(drawing);
}

std::vector<runtime::TaskReport> synthetic_tasks() {
  runtime::TaskReport control;
  control.name = "control";
  control.budget_us = 500;
  control.p50_us = 61;
  control.p99_us = 140;
  control.max_us = 310;
  runtime::TaskReport mapping;
  mapping.name = "mapping";
  mapping.budget_us = 10000;
  mapping.p50_us = 2100;
  mapping.p99_us = 4200;
  mapping.max_us = 12000;
  return {control, mapping};
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

TEST(Figures, TerrainShowsFourPanelsAndTheReasonsOfMovedFootholds) {
  const RunLog log = synthetic_log();
  const Drawing drawing = terrain_figure(log, synthetic_terrain(log));
  keep(drawing, "terrain");
  const std::string svg = to_svg(drawing);
  EXPECT_EQ(count(svg, "data:image/png;base64,"), 7u);  // four maps, three colour bars
  EXPECT_NE(svg.find("Perceived minus true"), std::string::npos);
  EXPECT_NE(svg.find("moved to bear a foot ("), std::string::npos);
  EXPECT_NE(svg.find("unseen (0)"), std::string::npos);
  EXPECT_NE(svg.find("impassable"), std::string::npos);
  EXPECT_EQ(svg.find("fields of obstacles"), std::string::npos);  // there are none
  EXPECT_GT(log.touchdowns().size(), 50u);
}

TEST(Figures, TimeFiguresHaveTitlesAndUnits) {
  const RunLog log = synthetic_log();
  robot::RobotModel robot;
  for (auto& actuator : robot.actuators) actuator.torque_limit_Nm = 17;
  const Drawing motion = motion_figure(log);
  const Drawing torque = torque_figure(log, robot);
  const Drawing gait = gait_figure(log);
  const Drawing timing = timing_figure(synthetic_tasks());
  keep(motion, "motion");
  keep(torque, "torque");
  keep(gait, "gait");
  keep(timing, "timing");
  EXPECT_NE(to_svg(motion).find("m/s"), std::string::npos);
  EXPECT_NE(to_svg(motion).find("command"), std::string::npos);
  EXPECT_EQ(count(to_svg(torque), "N m"), 3u);
  EXPECT_EQ(count(to_svg(torque), "time [s]"), 1u);
  EXPECT_NE(to_svg(gait).find("contact estimated"), std::string::npos);
  EXPECT_NE(to_svg(timing).find("mapping"), std::string::npos);
}

TEST(Figures, EmptyLogDrawsEmptyAxes) {
  const RunLog log(10, true);
  TerrainFigure figure;
  figure.truth = HeightGrid(0, 0, 1, 1, 0.1);
  figure.perceived = figure.truth;
  figure.classes = ClassGrid(figure.truth);
  EXPECT_GT(to_png(terrain_figure(log, figure)).size(), 100u);
  EXPECT_GT(to_png(motion_figure(log)).size(), 100u);
  EXPECT_GT(to_png(gait_figure(log)).size(), 100u);
  EXPECT_GT(to_png(timing_figure({})).size(), 100u);
}

TEST(Figures, PngAndSvgAreWellFormed) {
  Drawing drawing(100, 50);
  drawing.text({50, 25}, "a < b & c", {12, palette::kInk, Anchor::kMiddle, false, true});
  const auto png = to_png(drawing, 2.0);
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png[1], 'P');
  EXPECT_EQ(png[19], 200);  // width, low byte
  EXPECT_EQ(png[23], 100);  // height
  EXPECT_NE(to_svg(drawing).find("a &lt; b &amp; c"), std::string::npos);
}

TEST(Figures, Base64KnownAnswers) {
  const auto text = [](std::string s) { return base64({s.begin(), s.end()}); };
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("f"), "Zg==");
  EXPECT_EQ(text("fo"), "Zm8=");
  EXPECT_EQ(text("foobar"), "Zm9vYmFy");
}

TEST(Figures, TicksAreRound) {
  EXPECT_EQ(ticks({0, 10}, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(tick_text(0.1 + 0.2, 0.1), "0.3");
  EXPECT_EQ(tick_text(-1e-12, 0.5), "0.0");
}

TEST(Figures, ThinnedSeriesKeepsExtremes) {
  std::vector<double> x(10000);
  std::vector<double> y(10000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<double>(i);
    y[i] = i == 7777 ? 1.0 : 0.0;
  }
  Drawing drawing(200, 100);
  Axes axes(drawing, {0, 0, 100, 100}, {0, 9999}, {0, 1}, {});
  axes.series(x, y, {});
  const Shape& line = drawing.shapes().back();
  EXPECT_LT(line.points.size(), 500u);
  double top = 100;
  for (const Point& point : line.points) top = std::min(top, point.y);
  EXPECT_NEAR(top, 0.0, 1e-9);
}

TEST(RunLog, AlignmentUndoesATurnAndAShift) {
  RunSample sample;
  sample.truth.p_WB_m = {1, 2, 0.3};
  sample.truth.q_WB_wxyz = {std::cos(0.5), 0, 0, std::sin(0.5)};
  sample.telemetry.p_OB_m = {0.5, 0, 0.28};
  const Alignment alignment = align(sample);
  const auto back = alignment.to_world(sample.telemetry.p_OB_m);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back[i], sample.truth.p_WB_m[i], 1e-12);
  const auto there = alignment.to_odometry(sample.truth.p_WB_m);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(there[i], sample.telemetry.p_OB_m[i], 1e-12);
  EXPECT_NEAR(alignment.yaw_rad, 1.0, 1e-12);
}

TEST(RunLog, FullLogDropsAndCounts) {
  RunLog log(2, false);
  for (int i = 0; i < 5; ++i) log.add(TimeNs{i}, {}, nullptr);
  EXPECT_EQ(log.samples().size(), 2u);
  EXPECT_EQ(log.dropped(), 3u);
}

}  // namespace
}  // namespace surefoot::apps
