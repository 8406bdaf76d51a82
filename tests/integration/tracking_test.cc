// The map around the robot while the tracking camera drops out and comes back: it must not tear.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/common/backend.h"
#include "apps/common/stack.h"

namespace surefoot {
namespace {

constexpr double kRadius_m = 0.5;  // around the trunk: where feet are put
constexpr double kOffFrom_s = 9.0;
constexpr double kOffUntil_s = 17.0;

// Of the published window against the ground, both seen from the trunk.
struct Heights {
  double rms_m = 0;
  double worst_step_m = 0;  // between neighbours; the ground is level
};

Heights heights(const mapping::MapWindow& window, const autonomy::Telemetry& telemetry,
                const sim::Truth& truth) {
  Heights heights;
  double sum = 0;
  int count = 0;
  const auto& p = telemetry.p_OB_m;
  for (std::int32_t dy = 0; dy < mapping::kWindowSide; ++dy) {
    for (std::int32_t dx = 0; dx < mapping::kWindowSide; ++dx) {
      const mapping::CellIndex i{window.first.ix + dx, window.first.iy + dy};
      const double x = mapping::cell_centre(i.ix, window.cell_size_m) - p[0];
      const double y = mapping::cell_centre(i.iy, window.cell_size_m) - p[1];
      const mapping::WindowCell& cell = window.at(i);
      if (std::hypot(x, y) > kRadius_m || !cell.has_height()) continue;
      const double off = (static_cast<double>(cell.height_m) - p[2]) + truth.p_WB_m[2];
      sum += off * off;
      ++count;
      for (const mapping::CellIndex j : {mapping::CellIndex{i.ix + 1, i.iy}, {i.ix, i.iy + 1}}) {
        const mapping::WindowCell* next = window.find(j);
        if (next == nullptr || !next->has_height()) continue;
        const double step =
            static_cast<double>(next->height_m) - static_cast<double>(cell.height_m);
        heights.worst_step_m = std::max(heights.worst_step_m, std::fabs(step));
      }
    }
  }
  if (count > 0) heights.rms_m = std::sqrt(sum / count);
  return heights;
}

struct Span {
  double worst_rms_m = 0;
  double worst_step_m = 0;
  double worst_position_step_m = 0;  // of the estimate against the truth, within a tick
  int samples = 0;
};

class Walk {
 public:
  Walk() {
    request_.robot = "mini_cheetah";
    request_.world = "flat";
    request_.mission = "cross";
    request_.seed = 11;
    request_.sets = {"mission.goal_x_m=9.0", "sim.faults.pose_off_from_s=9.0",
                     "sim.faults.pose_off_until_s=17.0", "sim.tracking.jump_interval_s=3.0"};
    apps::ConfigIssues issues;
    config_ = apps::load_config(request_, SUREFOOT_SOURCE_DIR "/config", issues);
    EXPECT_EQ(apps::to_string(issues), "");
    backend_ = apps::make_backend(request_, config_);
  }

  void run() {
    runtime::InlineRunner runner(nullptr);
    stack_ = std::make_unique<apps::Stack>();
    ASSERT_EQ(stack_->start(config_, backend_->board(), runner, nullptr), Status::kOk);
    while (!stack_->autonomy().finished() && stack_->executive().ticks() < 20000) {
      ASSERT_EQ(stack_->executive().run_tick(), Status::kOk);
      const autonomy::Telemetry& telemetry = stack_->executive().outputs().telemetry;
      if (telemetry.phase == autonomy::MissionPhase::kWalk) observe(telemetry);
    }
  }

  Span before;
  Span without;
  Span after;
  const estimation::TrackingCounters& counters() const {
    return stack_->autonomy().estimator().drift().counters();
  }
  bool arrived() const {
    return stack_->autonomy().mission().phase() == autonomy::MissionPhase::kArrived;
  }
  double end_error_m() const { return std::hypot(error_m_[0], error_m_[1]); }

 private:
  void observe(const autonomy::Telemetry& telemetry) {
    const TimeNs now = stack_->executive().inputs().stamp;
    Span& span = now.seconds() < kOffFrom_s    ? before
                 : now.seconds() < kOffUntil_s ? without
                                               : after;
    const sim::Truth truth = backend_->truth();
    const Vector3 error_m = Vector3(telemetry.p_OB_m[0], telemetry.p_OB_m[1], telemetry.p_OB_m[2]) -
                            Vector3(truth.p_WB_m[0], truth.p_WB_m[1], truth.p_WB_m[2]);
    if (seen_) {
      span.worst_position_step_m =
          std::max(span.worst_position_step_m, (error_m - error_m_).norm());
    }
    seen_ = true;
    error_m_ = error_m;
    if (stack_->executive().ticks() % 25 != 0) return;
    const Heights now_heights = heights(stack_->autonomy().map().window(), telemetry, truth);
    span.worst_rms_m = std::max(span.worst_rms_m, now_heights.rms_m);
    span.worst_step_m = std::max(span.worst_step_m, now_heights.worst_step_m);
    ++span.samples;
  }

  apps::RunRequest request_;
  apps::Config config_;
  std::unique_ptr<apps::Backend> backend_;
  std::unique_ptr<apps::Stack> stack_;
  bool seen_ = false;
  Vector3 error_m_ = Vector3::Zero();
};

TEST(Tracking, TheMapDoesNotTearWhenTheCameraComesBack) {
  const auto walk = std::make_unique<Walk>();
  walk->run();
  ASSERT_TRUE(walk->arrived());
  ASSERT_GT(walk->before.samples, 50);
  ASSERT_GT(walk->without.samples, 100);
  ASSERT_GT(walk->after.samples, 50);
  EXPECT_GE(walk->counters().jumps, 2u);
  EXPECT_GT(walk->counters().low_confidence, 0u);
  for (const Span* span : {&walk->before, &walk->without, &walk->after}) {
    EXPECT_LT(span->worst_rms_m, 0.012);
    EXPECT_LT(span->worst_step_m, 0.008);
    EXPECT_LT(span->worst_position_step_m, 0.001);
  }
  EXPECT_LT(walk->end_error_m(), 0.25);
}

}  // namespace
}  // namespace surefoot
