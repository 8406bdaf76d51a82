// Simulated tracking camera (class of the RealSense T265): the pose of its frame T in its own start
// frame S, with the errors of visual-inertial odometry. README.md "Tracking camera" has the model.
#pragma once

#include <cstdint>

#include "core/base/random.h"
#include "core/base/ring_buffer.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/pose_port.h"
#include "sim_hal/simulator_config.h"

namespace surefoot::sim {

struct PoseCounters {
  std::uint64_t lost = 0;   // samples the fault took
  std::uint64_t jumps = 0;  // relocalisation steps
};

class SimPosePort final : public hal::PosePort {
 public:
  static constexpr std::size_t kQueue = 64;

  // The trunk's pose when the sensor starts: T is then S.
  SimPosePort(const robot::TrackingCameraSpecification& specification,
              const TrackingNoiseConfig& noise, const FaultConfig& faults, std::uint64_t seed,
              const Vector3& p_WB_m, const Matrix3& rotation_WB);

  // Once per physics step, after it.
  void advance(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB);

  const PoseCounters& pose_counters() const { return pose_counters_; }

 private:
  std::size_t do_receive(std::span<hal::PoseSample> out) override;
  hal::SensorCounters do_counters() const override { return counters_; }

  void drift(const Vector3& p_WT_m, double span_s);
  void turn_and_shift(const Vector3& p_WT_m, double yaw_rad, const Vector3& shift_m);
  std::uint8_t confidence(double t_s);
  hal::PoseSample measure(TimeNs now, const Vector3& p_WT_m, const Matrix3& rotation_WT,
                          std::uint8_t confidence);
  Vector3 normal_vector(double sigma);

  TrackingNoiseConfig noise_;
  FaultConfig faults_;
  Vector3 mount_B_m_;
  Matrix3 rotation_BT_;
  double rate_Hz_;
  TimeNs latency_;
  Random random_;
  Vector3 start_W_m_;    // S's origin
  Matrix3 rotation_SW_;  // and axes
  double yaw_rad_ = 0;   // what the camera takes W for: p_seen = Rz(yaw) p + shift
  Vector3 shift_m_ = Vector3::Zero();
  TimeNs now_;
  TimeNs last_;             // sample before
  std::uint64_t next_ = 1;  // index of the next sample: due at next_ / rate
  std::uint32_t sequence_ = 0;
  std::uint32_t expected_ = 0;  // sequence number that follows the last arrival
  bool arrived_ = false;
  double regained_s_ = 0;  // end of the last outage
  RingBuffer<hal::PoseSample, kQueue> queue_;
  hal::SensorCounters counters_;
  PoseCounters pose_counters_;
};

}  // namespace surefoot::sim
