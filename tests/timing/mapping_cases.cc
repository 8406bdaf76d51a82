// The mapping task.
#include <algorithm>

#include "core/base/assert.h"
#include "core/mapping/mapper.h"
#include "core/math/elementary.h"
#include "tests/timing/kinematic_robot.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

// Level ground as the robot's own camera sees it, at z = ground_z_m below the camera's origin.
void render_ground(const robot::DepthCameraSpecification& camera, double camera_height_m,
                   hal::DepthFrame& frame) {
  const double pitch = camera.mount.roll_pitch_yaw_rad[1];
  const math::SinCos down = math::sin_cos(pitch);
  hal::PinholeIntrinsics& lens = frame.intrinsics;
  const math::SinCos half_h = math::sin_cos(0.5 * camera.horizontal_view_rad);
  const math::SinCos half_v = math::sin_cos(0.5 * camera.vertical_view_rad);
  lens.width_px = camera.width_px;
  lens.height_px = camera.height_px;
  lens.fx_px = 0.5 * camera.width_px * half_h.cos / half_h.sin;
  lens.fy_px = 0.5 * camera.height_px * half_v.cos / half_v.sin;
  lens.cx_px = 0.5 * (camera.width_px - 1);
  lens.cy_px = 0.5 * (camera.height_px - 1);
  for (std::size_t v = 0; v < lens.height_px; ++v) {
    // Downward share of a ray of unit depth.
    const double ray = (static_cast<double>(v) - lens.cy_px) / lens.fy_px;
    const double descent = down.sin + down.cos * ray;
    const double z = descent > 0.01 ? camera_height_m / descent : 0.0;
    const bool seen = z >= camera.min_range_m && z <= camera.max_range_m;
    const double mm = seen ? z * 1000.0 + 0.5 : 0.0;
    const auto row = frame.depth.begin() + static_cast<std::ptrdiff_t>(v * lens.width_px);
    std::fill_n(row, lens.width_px, static_cast<std::uint16_t>(mm));
  }
}

// A frame of the robot's own camera over level ground, integrated, classified and hashed, while the
// robot trots; the map has seen thirty frames before.
class NominalFrame final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    SUREFOOT_ASSERT(robot_.reach(autonomy::MissionPhase::kWalk, 700));
    for (int frames = 0; frames < 30; ++frames) {
      for (int i = 0; i < 17; ++i) robot_.tick();
      if (!release()) return false;
      robot_.autonomy().run_mapping();
      robot_.autonomy().publish_mapping();
    }
    robot_.tick();
    return release();
  }
  void run() override { robot_.autonomy().run_mapping(); }
  bool did_the_work() override {
    return robot_.autonomy().map().counters().frames_integrated == 31;
  }

 private:
  bool release() {
    const double mount_m = config_.robot.depth_camera.mount.position_B_m[2];
    render_ground(config_.robot.depth_camera, robot_.height_m() + mount_m, frame_);
    frame_.stamp = robot_.now();
    autonomy::TickInputs& inputs = robot_.inputs();
    inputs.depth_fresh = true;
    inputs.depth = &frame_;
    const bool released = robot_.autonomy().begin_mapping(inputs);
    inputs.depth_fresh = false;
    inputs.depth = nullptr;
    return released;
  }

  apps::Config config_ = load({"mission.rest_s=0.1", "mission.settle_s=0.1",
                               "control.stand_up.fold_s=0.1", "control.stand_up.rise_s=0.2"});
  KinematicRobot robot_{config_};
  hal::DepthFrame frame_;
};

// A camera that looks straight down on a level plane.
class Downward {
 public:
  Downward() : config_(load({})) {
    mapping::MappingConfig mapping = config_.autonomy.mapping;
    mapping.max_height_above_body_m = 3.0;
    SUREFOOT_ASSERT(
        ok(mapper_.configure(mapping, mapping::sensor_model(config_.robot.depth_camera),
                             mapping::traversability_limits(
                                 mapping, config_.robot, config_.autonomy.control.body.height_m,
                                 config_.autonomy.control.swing.clearance_m))));
    R_OC_ << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  }

  // width x height pixels over `reach_m` to either side at `depth_m` below the camera. Neighbouring
  // pixels differ by a little, so that no two hold the same number.
  void look(std::uint16_t width, std::uint16_t height, double depth_m, double reach_m) {
    hal::PinholeIntrinsics& lens = frame_.intrinsics;
    lens = {width,
            height,
            0.5 * width * depth_m / reach_m,
            0.5 * height * depth_m / reach_m,
            0.5 * (width - 1),
            0.5 * (height - 1)};
    const auto mm = static_cast<std::uint16_t>(depth_m * 1000.0);
    for (std::size_t i = 0; i < frame_.pixel_count(); ++i) {
      frame_.depth[i] = static_cast<std::uint16_t>(mm + (i + i / width) % 2);
    }
    frame_.stamp = frame_.stamp + milliseconds(33);
  }
  Status integrate(double x_O_m, double y_O_m, double z_O_m) {
    mapping::CameraPose X_OC;
    X_OC.rotation.matrix = R_OC_;
    X_OC.origin.m = Vector3(x_O_m, y_O_m, z_O_m);
    self_.X_OB.origin.m = X_OC.origin.m;
    return mapper_.integrate(frame_, X_OC, self_, &report_);
  }
  // Sixteen thin links whose boxes hold all points and whose surfaces hold none: the self filter
  // must try every one for every point.
  void spread_links() {
    for (std::size_t i = 0; i < mapping::kMaxSelfCapsules; ++i) {
      const double x = i % 2 == 0 ? 20.0 : -20.0;
      const double y = 16.0 + static_cast<double>(i);
      mapping::SelfCapsule capsule;
      capsule.a_O_m = Vector3(-x, -y, -9.0);
      capsule.b_O_m = Vector3(x, y, 30.0 + static_cast<double>(i));
      SUREFOOT_ASSERT(ok(self_.capsules.push_back(capsule)));
    }
  }

 protected:
  apps::Config config_;
  mapping::Mapper mapper_;
  hal::DepthFrame frame_;
  mapping::SelfModel self_;
  mapping::IntegrationReport report_;
  Matrix3 R_OC_;
};

// 160 x 128 pixels, each in a cell of its own; within the clearing radius every cell holds a ghost,
// a surface half way between camera and ground. The first frames look at five eighths of the rows
// of cells, all they may; the fifth clears what is left and traces all the rays it may.
class Ghosts final : public WorkCase, private Downward {
 public:
  static constexpr double kCamera_m = 2.4;
  static constexpr double kGhost_m = 1.1;

  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    mapping::AssumedPad pad;
    pad.z_O_m = kGhost_m;
    pad.half_length_m = 5.0;
    pad.half_width_m = 5.0;
    SUREFOOT_ASSERT(ok(mapper_.assume(pad)));
    spread_links();
    for (int frames = 1; frames < 5; ++frames) {
      look(160, 128, kCamera_m, 7.2);
      SUREFOOT_ASSERT(ok(integrate(0.0, 0.0, kCamera_m)));
    }
    look(160, 128, kCamera_m, 7.2);
    return true;
  }
  void run() override { status_ = integrate(0.0, 0.0, kCamera_m); }
  bool did_the_work() override {
    return ok(status_) && report_.points == mapping::kMaxPixels && report_.self == 0 &&
           report_.cells_hit == mapping::kMaxPixels && report_.cells_cleared > 110000 &&
           report_.cells_looked_at > 110000 && report_.rays_put_off > 0;
  }

 private:
  Status status_ = Status::kNotFound;
};

// The robot's own camera, standing: level ground, and a ghost 5 cm above it in every cell. The
// frame is the one that clears what it sees.
class OwnCamera final : public WorkCase, private Downward {
 public:
  static constexpr double kGhost_m = 0.05;

  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const robot::DepthCameraSpecification& camera = config_.robot.depth_camera;
    height_m_ = config_.autonomy.control.body.height_m + camera.mount.position_B_m[2];
    const math::SinCos down = math::sin_cos(camera.mount.roll_pitch_yaw_rad[1]);
    R_OC_ << 0, -down.sin, down.cos, -1, 0, 0, 0, -down.cos, -down.sin;
    mapping::AssumedPad pad;
    pad.z_O_m = kGhost_m;
    pad.half_length_m = 5.0;
    pad.half_width_m = 5.0;
    pad.sigma_m = config_.autonomy.mapping.min_sigma_m;
    SUREFOOT_ASSERT(ok(mapper_.assume(pad)));
    for (int frames = 1; frames < config_.autonomy.mapping.clear_frames; ++frames) {
      next_frame();
      SUREFOOT_ASSERT(ok(integrate(0.0, 0.0, height_m_)));
    }
    next_frame();
    return true;
  }
  void run() override { status_ = integrate(0.0, 0.0, height_m_); }
  bool did_the_work() override {
    return ok(status_) && report_.points > 12000 && report_.cells_cleared > 2000;
  }

 private:
  void next_frame() {
    render_ground(config_.robot.depth_camera, height_m_, frame_);
    frame_.stamp = frame_.stamp + milliseconds(33);
  }

  double height_m_ = 0;
  Status status_ = Status::kNotFound;
};

// The body jumps by more than the map's side: every cell is forgotten.
class Jump final : public WorkCase, private Downward {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    look(160, 128, 1.0, 1.0);
    SUREFOOT_ASSERT(ok(integrate(0.0, 0.0, 1.0)));
    look(160, 128, 1.0, 1.0);
    return true;
  }
  void run() override { status_ = integrate(40.0, -40.0, 1.0); }
  bool did_the_work() override {
    return ok(status_) && mapper_.map().find({0, 0}) == nullptr && report_.cells_hit > 15000;
  }

 private:
  Status status_ = Status::kNotFound;
};

// Every second cell of every second row is a hole with eight neighbours, on a slope that makes
// their sorting long; once bridged, every cell of the window is steppable with the full margin.
class Publish final : public WorkCase, private Downward {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const double size = mapper_.cell_size_m();
    constexpr std::int32_t kHalf = 64;
    for (std::int32_t i = -kHalf; i <= kHalf; i += 2) {
      const double line = mapping::cell_centre(i, size);
      mapping::AssumedPad pad;
      pad.slope_x = -0.02;
      pad.slope_y = -0.03;
      pad.half_length_m = kHalf * size;
      pad.half_width_m = 0.4 * size;
      pad.y_O_m = line;
      pad.z_O_m = pad.slope_y * line;
      SUREFOOT_ASSERT(ok(mapper_.assume(pad)));
      std::swap(pad.half_length_m, pad.half_width_m);
      pad.y_O_m = 0;
      pad.x_O_m = line;
      pad.z_O_m = pad.slope_x * line;
      SUREFOOT_ASSERT(ok(mapper_.assume(pad)));
    }
    return true;
  }
  void run() override { status_ = mapper_.publish(0.0, 0.0, window_); }
  bool did_the_work() override {
    std::size_t bridged = 0;
    std::size_t best = 0;
    for (const mapping::WindowCell& cell : window_.cells) {
      bridged += cell.bridged ? 1u : 0u;
      best += cell.margin_cells == mapping::kMaxMargin_cells ? 1u : 0u;
    }
    return ok(status_) && bridged == 2500 && best == window_.cells.size();
  }

 private:
  Status status_ = Status::kNotFound;
  mapping::MapWindow window_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kMappingCases[] = {
    {"mapping_nominal", "mapping task, one frame of 160 x 90 pixels over level ground",
     make<NominalFrame>},
    {"mapping_worst", "integration, 20480 pixels, ghosts in every cell in view, 16 links",
     make<Ghosts>},
    {"mapping_own_camera", "integration, the robot's camera, ghosts in every cell in view",
     make<OwnCamera>},
    {"mapping_jump", "integration, 20480 pixels, the whole map scrolls out", make<Jump>},
    {"mapping_publish", "classification, a quarter of the cells bridged, all steppable",
     make<Publish>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
