// Simulated stereo camera: on trigger, both eyes' pictures of the patterned ground and of the
// robot's legs, through their calibration's lenses. README.md "Stereo camera" has the model.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/stereo_camera_port.h"
#include "sim_hal/sensors/capsule.h"
#include "sim_hal/sensors/frame_queue.h"
#include "sim_hal/sensors/surface_pattern.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

struct StereoImageCounters {
  std::uint64_t exposures = 0;
  std::uint64_t exposures_lost = 0;
  std::uint64_t rays = 0;
};

class SimStereoCameraPort final : public hal::StereoCameraPort {
 public:
  static constexpr std::size_t kQueue = 4;
  static constexpr std::size_t kMaxCapsules = 3 * robot::kLegs;

  SimStereoCameraPort(const robot::StereoCameraSpecification& specification,
                      const StereoImageConfig& config, const FaultConfig& faults,
                      const TerrainIndex& terrain, std::uint64_t seed);

  // True when an exposure was asked for and not yet taken.
  bool triggered() const { return triggered_; }
  // Takes it: camera pose from the trunk's, the robot's shapes in W.
  void expose(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
              std::span<const Capsule> robot_shapes_W);
  // Makes pairs visible to receive() whose latency has passed.
  void advance(TimeNs now) { queue_.advance(now); }

  const StereoImageCounters& image_counters() const { return image_counters_; }

 private:
  struct Eye {
    Matrix3 rotation_BC;
    Vector3 p_BC_m;
    std::vector<Vector3> directions_C;  // (x, y, 1) of each pixel
  };

  Status do_trigger() override;
  Status do_receive(hal::StereoFrame& out) override { return queue_.receive(out); }
  hal::SensorCounters do_counters() const override { return queue_.counters(); }

  void set_up(const robot::StereoLens& lens, Eye& eye) const;
  void cast(const Eye& eye, const Vector3& p_WC_m, const Matrix3& rotation_WC,
            std::span<const Capsule> shapes_W);
  double grey_at(std::size_t u, std::size_t v, const Vector3& p_WC_m) const;
  Vector3 nearer_step(std::size_t pixel, std::size_t stride, bool first, bool last) const;
  void render(const Eye& eye, const Vector3& p_WB_m, const Matrix3& rotation_WB,
              std::span<const Capsule> shapes_W, double gain, double offset, std::uint8_t* out);

  robot::StereoCameraSpecification specification_;
  StereoImageConfig config_;
  FaultConfig faults_;
  const TerrainIndex& terrain_;
  SurfacePattern pattern_;
  Random random_;
  Eye left_;
  Eye right_;
  bool triggered_ = false;
  std::uint32_t sequence_ = 0;
  std::vector<Vector3> points_W_m_;  // what each pixel of the present picture sees
  std::vector<bool> hit_;
  FrameQueue<hal::StereoFrame, kQueue> queue_;
  StereoImageCounters image_counters_;
};

}  // namespace surefoot::sim
