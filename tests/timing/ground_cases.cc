// The tasks between a picture of depth and the footsteps, with LittleDog's settings: the picture is
// registered with the scans before it; a window is completed and rated.
#include <cmath>
#include <memory>

#include "core/autonomy/localisation_task.h"
#include "core/autonomy/terrain_task.h"
#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/math/elementary.h"
#include "tests/support/terrain_task_parts.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

apps::Config little_dog() {
  const apps::RunRequest request{"littledog", "flat", "cross", "sim", 1, {}};
  apps::ConfigIssues issues;
  apps::Config config = apps::load_config(request, SUREFOOT_SOURCE_DIR "/config", issues);
  SUREFOOT_ASSERT(issues.empty());
  return config;
}

// The picture after as many as are kept, each with about as many pixels as the map takes of one.
class Localisation final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = little_dog();
    scans_ = config.autonomy.localisation.scans;
    way_m_ = 1.05 * config.autonomy.localisation.scan_distance_m;
    camera_.X_BC = autonomy::optical_pose(config.robot.stereo_camera.mount);
    camera_.sensor.inverse_depth_sigma_per_m = 0.01;
    camera_.sensor.min_range_m = config.robot.stereo_camera.min_range_m;
    camera_.sensor.max_range_m = config.robot.stereo_camera.max_range_m;
    SUREFOOT_ASSERT(ok(
        task_.reset(config.autonomy.localisation, config.autonomy.mapping, config.robot, camera_)));
    for (int i = 0; i < scans_; ++i) {
      see(i, Vector3::Zero());
      task_.run();
      task_.publish();
    }
    see(scans_, kDrift_m);
    return true;
  }
  void run() override {
    task_.run();
    task_.publish();
  }
  bool did_the_work() override {
    return task_.counters().registered == static_cast<std::uint64_t>(scans_) &&
           task_.observed_directions() >= 5 && (task_.shift().shift_O_m + kDrift_m).norm() < 0.002;
  }

 private:
  static constexpr std::uint16_t kWidth_px = 160;
  static constexpr std::uint16_t kHeight_px = 120;
  static constexpr double kFocal_px = 104.8;
  static constexpr double kUnit_m = 0.0001;
  const Vector3 kDrift_m{0.003, -0.002, 0.002};

  // Gentle waves, so that a few steps along the ray find the ground.
  static double height_m(double x_m, double y_m) {
    return 0.012 * math::sin(25.0 * x_m) * math::cos(21.0 * y_m);
  }

  void see(int number, const Vector3& drift_m) {
    const Vector3 p_OB_m(way_m_ * number, 0.0, 0.13);
    const Vector3 eye_m = p_OB_m + camera_.X_BC.origin.m;
    frame_.stamp = milliseconds(500 * (number + 1));
    frame_.intrinsics = {kWidth_px, kHeight_px, kFocal_px, kFocal_px, 79.5, 59.5};
    frame_.depth_unit_m = static_cast<float>(kUnit_m);
    for (std::size_t v = 0; v < kHeight_px; ++v) {
      for (std::size_t u = 0; u < kWidth_px; ++u) {
        const Vector3 ray_C((static_cast<double>(u) - 79.5) / kFocal_px,
                            (static_cast<double>(v) - 59.5) / kFocal_px, 1.0);
        const Vector3 ray = camera_.X_BC.rotation.matrix * ray_C;
        frame_.depth[v * kWidth_px + u] = depth(eye_m, ray);
      }
    }
    autonomy::PastPose pose;
    pose.stamp = frame_.stamp;
    pose.p_OB_m = p_OB_m + drift_m;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      pose.joint_rad[robot::joint_index(leg, 1)] = -0.8;
      pose.joint_rad[robot::joint_index(leg, 2)] = 1.6;
    }
    SUREFOOT_ASSERT(task_.release(frame_, nullptr, pose));
  }

  std::uint16_t depth(const Vector3& eye_m, const Vector3& ray) {
    if (ray[2] > -0.05) return 0;
    double z_m = -eye_m[2] / ray[2];
    for (int i = 0; i < 4; ++i) {
      z_m = (height_m(eye_m[0] + ray[0] * z_m, eye_m[1] + ray[1] * z_m) - eye_m[2]) / ray[2];
    }
    const double seen_m = 1.0 / (1.0 / z_m + 0.01 * noise_.normal());
    return seen_m > 0.05 && seen_m < 6.0 ? static_cast<std::uint16_t>(std::lround(seen_m / kUnit_m))
                                         : std::uint16_t{0};
  }

  int scans_ = 0;
  double way_m_ = 0;
  autonomy::MapCamera camera_;
  autonomy::LocalisationTask task_;
  hal::DepthFrame frame_;
  Random noise_{3};
};

// One slice of the work on a window of rough ground with shadows. The slices before it are made in
// prepare().
class TerrainSlice : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = little_dog();
    config_ = config.autonomy.terrain;
    cell_m_ = config.autonomy.mapping.cell_size_m;
    window_ = tests::terrain_window(1, cell_m_);
    digest_ = window_->digest();
    const int before = slices_before();
    SUREFOOT_ASSERT(ok(task_->reset(config_, cell_m_)));
    for (int i = 0; i < before; ++i) step(*task_);
    return true;
  }
  void run() override { step(*task_); }
  bool did_the_work() override { return task_->counters().maps == 0; }

 protected:
  virtual int slices_before() = 0;
  // All that a window takes, with draws that cost little: what they hold is nothing to the rating.
  int slices_with_cheap_draws() {
    config_.synthesis.samples = 1;
    config_.synthesis.draws = 2;
    const auto task = std::make_unique<autonomy::TerrainTask>();
    SUREFOOT_ASSERT(ok(task->reset(config_, cell_m_)));
    int slices = 0;
    for (; task->counters().maps == 0; ++slices) step(*task);
    return slices;
  }

  std::unique_ptr<autonomy::TerrainTask> task_ = std::make_unique<autonomy::TerrainTask>();

 private:
  void step(autonomy::TerrainTask& task) {
    SUREFOOT_ASSERT(task.release(*window_, digest_, 0.3));
    task.run();
    task.publish();
  }

  autonomy::TerrainConfig config_;
  double cell_m_ = 0;
  std::unique_ptr<mapping::MapWindow> window_;
  std::uint64_t digest_ = 0;
};

class TerrainLoad final : public TerrainSlice {
  int slices_before() override { return 0; }
};

// After the load the first slices are the prior's.
class TerrainPrior final : public TerrainSlice {
  int slices_before() override { return 1; }
};

class TerrainFill final : public TerrainSlice {
  int slices_before() override { return 10; }
};

class TerrainRate final : public TerrainSlice {
  int slices_before() override { return slices_with_cheap_draws() - 2; }
};

class TerrainLast final : public TerrainSlice {
 public:
  bool did_the_work() override {
    return task_->counters().maps == 1 && task_->counters().filled > 1500;
  }

 private:
  int slices_before() override { return slices_with_cheap_draws() - 1; }
};

// All slices of filling a window with 3000 unseen cells.
class TerrainWindow final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = little_dog();
    config_ = config.autonomy.terrain;
    tests::make_shadowed_window(config.autonomy.mapping.cell_size_m, *grid_);
    const auto scratch = std::make_unique<terrain::ModelHeights>();
    SUREFOOT_ASSERT(ok(
        terrain::make_library(config_.model, config_.synthesis.patch_cells, *scratch, *library_)));
    prior_ = terrain::make_prior(config_.model);
    filler_->touch();
    return ok(filler_->configure(config_.synthesis));
  }
  void run() override {
    if (!ok(filler_->start(*grid_, *library_, prior_, 0))) return;
    for (bool done = false; !done; ++slices_) done = filler_->advance(config_.fill_work);
  }
  bool did_the_work() override {
    return filler_->counts().unseen == tests::kWindowUnseen &&
           slices_ >= filler_->total_work() / (config_.fill_work + filler_->cell_work());
  }

 private:
  autonomy::TerrainConfig config_;
  terrain::HeightPrior prior_;
  std::unique_ptr<terrain::TerrainGrid> grid_ = std::make_unique<terrain::TerrainGrid>();
  std::unique_ptr<terrain::PatchLibrary> library_ = std::make_unique<terrain::PatchLibrary>();
  std::unique_ptr<terrain::TerrainFiller> filler_ = std::make_unique<terrain::TerrainFiller>();
  std::int64_t slices_ = 0;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kGroundCases[] = {
    {"localisation_task", "a picture registered with 16 scans", make<Localisation>},
    {"terrain_load", "the terrain task's first slice: a window is taken", make<TerrainLoad>},
    {"terrain_prior", "a slice of filling: learned heights", make<TerrainPrior>},
    {"terrain_fill", "a slice of filling: patches", make<TerrainFill>},
    {"terrain_window", "all slices of filling 3000 unseen cells", make<TerrainWindow>},
    {"terrain_rate", "a slice of rating", make<TerrainRate>},
    {"terrain_last", "the last slice: rating, the map is put together and published",
     make<TerrainLast>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
