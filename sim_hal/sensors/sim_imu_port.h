// Simulated IMU. The gyroscope reads the angular velocity at the sample's stamp; the accelerometer
// the mean specific force since the sample before, as a delta-velocity sensor does.
#pragma once

#include <cstdint>

#include "core/base/random.h"
#include "core/base/ring_buffer.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/imu_port.h"
#include "sim_hal/simulator_config.h"

namespace surefoot::sim {

class SimImuPort final : public hal::ImuPort {
 public:
  static constexpr std::size_t kQueue = 64;

  SimImuPort(const robot::ImuSpecification& specification, const ImuNoiseConfig& noise,
             const FaultConfig& faults, std::uint64_t seed);

  // Once per physics step, after it: the mount's mean specific force during the step and the
  // angular velocity at its end, both in B.
  void advance(TimeNs now, double step_s, const Vector3& specific_force_B,
               const Vector3& angular_velocity_B);

  const Vector3& mount_B_m() const { return mount_B_m_; }
  std::uint64_t lost() const { return lost_; }

 private:
  std::size_t do_receive(std::span<hal::ImuSample> out) override;
  hal::SensorCounters do_counters() const override { return counters_; }

  void sample(TimeNs now, const Vector3& angular_velocity_B);
  Vector3 normal_vector(double sigma);

  ImuNoiseConfig noise_;
  FaultConfig faults_;
  Vector3 mount_B_m_;
  Matrix3 rotation_IB_;
  double rate_Hz_;
  Random random_;
  Vector3 gyro_bias_;
  Vector3 accelerometer_bias_;
  Vector3 force_sum_ = Vector3::Zero();  // specific force times time since the last sample, B
  double span_s_ = 0;
  std::uint64_t next_ = 1;  // index of the next sample: due at next_ / rate
  std::uint32_t sequence_ = 0;
  std::uint32_t expected_ = 0;  // sequence number that follows the last arrival
  bool arrived_ = false;
  RingBuffer<hal::ImuSample, kQueue> queue_;
  hal::SensorCounters counters_;
  std::uint64_t lost_ = 0;
};

}  // namespace surefoot::sim
