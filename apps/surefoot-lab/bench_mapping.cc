#include "apps/surefoot-lab/bench_mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "apps/common/config_root.h"
#include "apps/common/statistics.h"
#include "apps/surefoot-lab/stopwatch.h"
#include "core/autonomy/map_task.h"
#include "core/base/random.h"
#include "core/mapping/line_of_sight.h"
#include "core/mapping/mapper.h"
#include "core/mapping/traversability_filter.h"

namespace surefoot::apps {
namespace {

using mapping::kWindowSide;
using Filter = mapping::TraversabilityFilter<kWindowSide>;
constexpr int kRounds = 400;

template <class Work>
std::vector<double> times_us(int rounds, Work&& work) {
  std::vector<double> times;
  for (int i = 0; i < rounds; ++i) times.push_back(work());
  return times;
}

// The median, and the tenth parts below and above it.
void print(const char* what, std::vector<double> times_us, const std::string& note) {
  std::sort(times_us.begin(), times_us.end());
  const std::size_t tenth = times_us.size() / 10;
  std::fputs(fmt::format("  {:<58} {:>8.1f} us ({:.1f} to {:.1f})  {}\n", what, median(times_us),
                         times_us[tenth], times_us[times_us.size() - 1 - tenth], note)
                 .c_str(),
             stdout);
}

// Blocks of up to 0.3 m with noise of some millimetres.
cv::Mat heights() {
  Random random(1);
  cv::Mat grid(kWindowSide, kWindowSide, CV_32F, cv::Scalar(0));
  for (int block = 0; block < 60; ++block) {
    const int x = static_cast<int>(random.below(kWindowSide - 14));
    const int y = static_cast<int>(random.below(kWindowSide - 14));
    grid(cv::Rect(x, y, 14, 14)).setTo(random.uniform(0, 0.3));
  }
  for (int i = 0; i < kWindowSide * kWindowSide; ++i) {
    float& height = grid.at<float>(i / kWindowSide, i % kWindowSide);
    height = mapping::on_filter_grid(height + 0.002F * static_cast<float>(random.normal()));
  }
  return grid;
}

// The paper's filter and traversability in OpenCV: opening, gradient map, three thresholds.
class PaperInOpenCv {
 public:
  void run(const cv::Mat& in, const mapping::TraversabilityLimits& limits, double cell_m) {
    cv::morphologyEx(in, opened, cv::MORPH_OPEN, kernel_);
    cv::Sobel(opened, gx_, CV_32F, 1, 0);
    cv::Sobel(opened, gy_, CV_32F, 0, 1);
    cv::absdiff(gx_, cv::Scalar::all(0), gx_);
    cv::absdiff(gy_, cv::Scalar::all(0), gy_);
    cv::max(gx_, gy_, gradient);
    classes_.create(in.size(), CV_8U);
    classes_.setTo(1);
    const double bounds[] = {8 * limits.max_slope * cell_m, 4 * limits.max_step_m,
                             4 * limits.max_jump_m};
    for (int i = 0; i < 3; ++i) {
      cv::compare(gradient, cv::Scalar(bounds[i]), mask_, cv::CMP_GT);
      classes_.setTo(2 + i, mask_);
    }
  }
  cv::Mat opened;
  cv::Mat gradient;

 private:
  cv::Mat kernel_ = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::Mat gx_, gy_, mask_, classes_;
};

bool same(const Filter& filter, const PaperInOpenCv& paper) {
  for (int y = 0; y < kWindowSide; ++y) {
    for (int x = 0; x < kWindowSide; ++x) {
      if (filter.opened_m(x, y) != paper.opened.at<float>(y, x)) return false;
      if (filter.gradient_m(x, y) != paper.gradient.at<float>(y, x)) return false;
    }
  }
  return true;
}

bool bench_filter(const mapping::TraversabilityLimits& limits, double cell_m) {
  const cv::Mat in = heights();
  cv::setNumThreads(1);
  const auto filter = std::make_unique<Filter>();
  filter->reset(limits, cell_m);
  const auto set_all = [&] {
    for (int y = 0; y < kWindowSide; ++y) {
      for (int x = 0; x < kWindowSide; ++x) filter->set(x, y, in.at<float>(y, x));
    }
  };
  const auto ours = [&] { filter->update({0, kWindowSide, 0, kWindowSide}); };
  print("setting 100 x 100 heights", times_us(kRounds, [&] { return time_us(set_all); }), "");
  PaperInOpenCv paper;
  std::vector<double> theirs;
  const std::vector<double> mine = times_us(kRounds, [&] {
    theirs.push_back(time_us([&] { paper.run(in, limits, cell_m); }));
    return time_us(ours);
  });
  print("filter and traversability, 100 x 100 cells, all changed", mine,
        same(*filter, paper) ? "opening and gradient equal OpenCV's" : "DIFFERS from OpenCV");
  print("OpenCV, one thread: opening, Sobel, maximum, thresholds", theirs, "");
  return same(*filter, paper);
}

// A camera that looks straight down from `depth_m` on level ground, 160 x 128 pixels over `reach_m`
// to either side.
class Downward {
 public:
  static constexpr std::uint32_t kNow_ms = 1000;

  Downward(const mapping::MappingConfig& config, const mapping::DepthSensorModel& sensor,
           const mapping::TraversabilityLimits& limits)
      : config_(config), sensor_(sensor), limits_(limits) {
    config_.max_height_above_body_m = 3.0;
    X_OC_.rotation.matrix << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  }

  void look(double depth_m, double reach_m) {
    if (!ok(mapper_->configure(config_, sensor_, limits_))) return;
    X_OC_.origin.m = Vector3(0.0, 0.0, depth_m);
    self_.X_OB.origin.m = X_OC_.origin.m;
    hal::PinholeIntrinsics& lens = frame_->intrinsics;
    lens = {160, 128, 80 * depth_m / reach_m, 64 * depth_m / reach_m, 79.5, 63.5};
    const auto mm = static_cast<std::uint16_t>(depth_m * 1000.0);
    for (std::size_t i = 0; i < frame_->pixel_count(); ++i) {
      frame_->depth[i] = static_cast<std::uint16_t>(mm + (i + i / 160) % 2);
    }
  }
  double prepare_us() {
    return time_us([&] { mapping::prepare(*frame_, config_, sensor_, *image_); });
  }
  double integrate_us() {
    frame_->stamp = frame_->stamp + milliseconds(33);
    return time_us([&] { (void)mapper_->integrate(*frame_, X_OC_, self_, &report_); });
  }
  // Clearing and ceilings of one frame of stamp kNow_ms over a map whose middle cells all hold
  // `height_m`, measured at `stamp_ms`, and are one frame from being cleared.
  double sight_us(std::int32_t half_side, double height_m, std::uint32_t stamp_ms, bool clear,
                  bool ceilings) {
    mapping::IntegrationReport report;
    map_->reset({0, 0});
    for (std::int32_t y = -half_side; y < half_side; ++y) {
      for (std::int32_t x = -half_side; x < half_side; ++x) {
        mapping::MapCell& cell = *map_->find({x, y});
        cell.height_m = static_cast<float>(height_m);
        cell.state = mapping::CellState::kMeasured;
        cell.stamp_ms = stamp_ms;
        cell.misses = (config_.clear_frames - 1u) & 0xFu;
      }
    }
    const mapping::Sight sight{*image_, X_OC_, config_, sensor_, kNow_ms};
    const double us = time_us([&] {
      mapping::SightTurn turn;
      if (clear) mapping::clear_seen_through(sight, turn, *map_, report);
      if (ceilings) mapping::lower_ceilings(sight, turn, *map_, report);
    });
    report_ = report;
    return us;
  }
  void every_ray() { config_.ceiling_pixel_stride = 1; }
  const mapping::IntegrationReport& report() const { return report_; }

 private:
  mapping::MappingConfig config_;
  mapping::DepthSensorModel sensor_;
  mapping::TraversabilityLimits limits_;
  mapping::CameraPose X_OC_;
  mapping::SelfModel self_;
  mapping::IntegrationReport report_;
  std::unique_ptr<mapping::Mapper> mapper_ = std::make_unique<mapping::Mapper>();
  std::unique_ptr<mapping::ControlMap> map_ = std::make_unique<mapping::ControlMap>();
  std::unique_ptr<mapping::DepthImage> image_ = std::make_unique<mapping::DepthImage>();
  std::unique_ptr<hal::DepthFrame> frame_ = std::make_unique<hal::DepthFrame>();
};

// A frame less its thinning, clearing and ceilings, each timed by itself.
void bench_insertion(Downward& camera) {
  camera.look(1.0, 0.75);
  const auto prepare = times_us(kRounds, [&] { return camera.prepare_us(); });
  const auto total = times_us(kRounds, [&] { return camera.integrate_us(); });
  const std::uint32_t points = camera.report().points;
  const std::uint32_t cells = camera.report().cells_hit;
  const auto sight = [&] { return camera.sight_us(50, 0.0, Downward::kNow_ms, true, true); };
  const double rest = median(prepare) + median(times_us(kRounds, sight));
  const auto print_insertion = [&](const char* what, std::vector<double> frames_us) {
    for (double& us : frames_us) us -= rest;
    print(what, frames_us,
          fmt::format("{:.1f} million points per second", points / median(frames_us)));
  };
  print("whole frame of 160 x 128 pixels over 100 x 100 cells", total,
        fmt::format("{} points, {} cells", points, cells));
  print("  thinning and mixed pixels", prepare, "");
  print_insertion("  points into the map (the rest of the frame)", total);
  print_insertion("  the same after 16 MB of other work", times_us(kRounds, [&] {
                    (void)sight();
                    return camera.integrate_us();
                  }));
}

void bench_clearing(Downward& camera) {
  camera.look(2.4, 3.0);
  (void)camera.prepare_us();
  const auto clear = times_us(40, [&] { return camera.sight_us(200, 0.2, 1, true, false); });
  print("clearing 400 x 400 cells with 20,480 rays", clear,
        fmt::format("{} cells looked at, {} cleared", camera.report().cells_looked_at,
                    camera.report().cells_cleared));
  camera.every_ray();
  const auto ceilings = times_us(40, [&] { return camera.sight_us(0, 0.0, 1, false, true); });
  print("ceilings of unseen cells, as many steps as a frame may take", ceilings,
        fmt::format("{} bounds, {} of 20,480 rays put off", camera.report().ceilings,
                    camera.report().rays_put_off));
}

}  // namespace

int bench_mapping() {
  ConfigIssues issues;
  const Config config =
      load_config({"mini_cheetah", "flat", "cross", "sim", 1, {}}, config_folder(), issues);
  if (!issues.empty()) return 3;
  const mapping::MappingConfig& map = config.autonomy.mapping;
  const mapping::TraversabilityLimits limits = class_limits(config);
  std::fputs("mapping: processor time of one thread, median (10 % to 90 %)\n", stdout);
  const bool equal = bench_filter(limits, map.cell_size_m);
  Downward camera(map, mapping::sensor_model(config.robot.depth_camera), limits);
  bench_insertion(camera);
  bench_clearing(camera);
  return equal ? 0 : 3;
}

}  // namespace surefoot::apps
