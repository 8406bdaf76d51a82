// Simulated stereo depth camera: own ray caster against the ground and the robot's legs, then the
// errors of such a device. README.md "Depth camera" has the model.
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
#include "hal/api/depth_camera_port.h"
#include "sim_hal/sensors/capsule.h"
#include "sim_hal/sensors/frame_queue.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

struct DepthCounters {
  std::uint64_t rays = 0;
  std::uint64_t edge_dropouts = 0;
  std::uint64_t random_dropouts = 0;
  std::uint64_t out_of_range = 0;
  std::uint64_t exposures_lost = 0;
};

class SimDepthCameraPort final : public hal::DepthCameraPort {
 public:
  static constexpr std::size_t kQueue = 8;
  static constexpr std::size_t kMaxCapsules = 3 * robot::kLegs;

  SimDepthCameraPort(const robot::DepthCameraSpecification& specification,
                     const DepthNoiseConfig& noise, const FaultConfig& faults,
                     const TerrainIndex& terrain, std::uint64_t seed);

  // True when an exposure is due at `now`.
  bool due(TimeNs now) const;
  // Takes the exposure: camera pose from the trunk's, the robot's shapes in W.
  void expose(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
              std::span<const Capsule> robot_shapes_W);
  // Makes frames visible to receive() whose latency has passed.
  void advance(TimeNs now) { queue_.advance(now); }

  const DepthCounters& depth_counters() const { return depth_counters_; }
  const hal::PinholeIntrinsics& intrinsics() const { return intrinsics_; }
  // Exact z of the last exposure's pixels, kNoHit where there is no surface in range. For tests.
  std::span<const double> exact_depth_m() const { return exact_; }

 private:
  struct Window {  // a capsule in C and the pixels it may cover
    Capsule capsule;
    int u0 = 0;
    int u1 = -1;
    int v0 = 0;
    int v1 = -1;
  };

  Status do_receive(hal::DepthFrame& out) override { return queue_.receive(out); }
  hal::SensorCounters do_counters() const override { return queue_.counters(); }

  void render(const Vector3& p_WC_m, const Matrix3& rotation_WC);
  void render_row(int v, const Vector3& p_WC_m, const Matrix3& rotation_WC);
  Window window_of(const Capsule& capsule_C) const;
  double curvature_px(std::size_t u, std::size_t v) const;
  void draw_patches();
  std::uint16_t measure(std::size_t u, std::size_t v);

  robot::DepthCameraSpecification specification_;
  DepthNoiseConfig noise_;
  FaultConfig faults_;
  const TerrainIndex& terrain_;
  hal::PinholeIntrinsics intrinsics_;
  Vector3 mount_B_m_;
  Matrix3 rotation_BC_;
  double disparity_m_px_ = 0;  // native focal length times baseline: disparity = this / z
  Random random_;
  std::uint64_t next_ = 1;  // next exposure at next_ / rate
  std::uint32_t sequence_ = 0;
  std::array<Window, kMaxCapsules> windows_;
  std::size_t window_count_ = 0;
  std::vector<double> exact_;
  std::vector<double> patches_;
  std::size_t patches_wide_ = 0;
  FrameQueue<hal::DepthFrame, kQueue> queue_;
  DepthCounters depth_counters_;
};

}  // namespace surefoot::sim
