#include "sim_hal/sensors/sim_imu_port.h"

#include <cmath>

#include "sim_hal/robot/articulation.h"

namespace surefoot::sim {

namespace {
constexpr std::uint64_t kImuStream = 2;
}  // namespace

SimImuPort::SimImuPort(const robot::ImuSpecification& specification, const ImuNoiseConfig& noise,
                       const FaultConfig& faults, std::uint64_t seed)
    : noise_(noise),
      faults_(faults),
      mount_B_m_(specification.mount.position_B_m[0], specification.mount.position_B_m[1],
                 specification.mount.position_B_m[2]),
      rotation_IB_(mount_rotation(specification.mount).transpose()),
      rate_Hz_(specification.rate_Hz),
      random_(seed, kImuStream) {
  gyro_bias_ = normal_vector(noise.gyro_bias_rad_s);
  accelerometer_bias_ = normal_vector(noise.accelerometer_bias_m_s2);
}

Vector3 SimImuPort::normal_vector(double sigma) {
  Vector3 v;
  for (Eigen::Index i = 0; i < 3; ++i) v[i] = sigma * random_.normal();
  return v;
}

void SimImuPort::advance(TimeNs now, double step_s, const Vector3& specific_force_B,
                         const Vector3& angular_velocity_B) {
  force_sum_ += specific_force_B * step_s;
  span_s_ += step_s;
  // Half a nanosecond of slack: rates that divide the step fall on it.
  if (now.seconds() * rate_Hz_ < static_cast<double>(next_) - 1e-6) return;
  // A rate above the step's gives one sample per step; the index keeps up with time.
  next_ = static_cast<std::uint64_t>(std::floor(now.seconds() * rate_Hz_ + 1e-6)) + 1;
  sample(now, angular_velocity_B);
  force_sum_.setZero();
  span_s_ = 0;
}

void SimImuPort::sample(TimeNs now, const Vector3& angular_velocity_B) {
  const double white = 1.0 / std::sqrt(span_s_);
  const double walk = std::sqrt(span_s_);
  gyro_bias_ += normal_vector(noise_.gyro_bias_walk_rad_s2_rtHz * walk);
  accelerometer_bias_ += normal_vector(noise_.accelerometer_bias_walk_m_s3_rtHz * walk);
  const Vector3 gyro_noise = normal_vector(noise_.gyro_noise_rad_s_rtHz * white);
  const Vector3 force_noise = normal_vector(noise_.accelerometer_noise_m_s2_rtHz * white);
  const Vector3 gyro = rotation_IB_ * angular_velocity_B + gyro_bias_ + gyro_noise;
  const Vector3 force = rotation_IB_ * (force_sum_ / span_s_) + accelerometer_bias_ + force_noise;
  hal::ImuSample sample;
  sample.stamp = now;
  sample.sequence = sequence_++;
  for (std::size_t i = 0; i < 3; ++i) {
    sample.angular_velocity_I_rad_s[i] = gyro[static_cast<Eigen::Index>(i)];
    sample.specific_force_I_m_s2[i] = force[static_cast<Eigen::Index>(i)];
  }
  const double t = now.seconds();
  if (t >= faults_.imu_off_from_s && t < faults_.imu_off_until_s) {
    ++lost_;
    return;
  }
  // Gaps are what never came here; what a full queue loses is counted as dropped, once.
  if (arrived_) counters_.gaps += sample.sequence - expected_;
  arrived_ = true;
  expected_ = sample.sequence + 1;
  if (queue_.push_overwrite(sample)) ++counters_.dropped;
}

std::size_t SimImuPort::do_receive(std::span<hal::ImuSample> out) {
  std::size_t count = 0;
  while (count < out.size() && !queue_.empty()) {
    const hal::ImuSample& sample = queue_.front();
    out[count++] = sample;
    queue_.pop_front();
    ++counters_.delivered;
  }
  return count;
}

}  // namespace surefoot::sim
