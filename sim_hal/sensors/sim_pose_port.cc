#include "sim_hal/sensors/sim_pose_port.h"

#include <cmath>

#include "sim_hal/robot/articulation.h"

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kPoseStream = 4;
constexpr std::uint8_t kLowConfidence = 1;
constexpr std::uint8_t kHighConfidence = 3;

Matrix3 turn_z(double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ()).toRotationMatrix();
}

}  // namespace

SimPosePort::SimPosePort(const robot::TrackingCameraSpecification& specification,
                         const TrackingNoiseConfig& noise, const FaultConfig& faults,
                         std::uint64_t seed, const Vector3& p_WB_m, const Matrix3& rotation_WB)
    : noise_(noise),
      faults_(faults),
      mount_B_m_(specification.mount.position_B_m[0], specification.mount.position_B_m[1],
                 specification.mount.position_B_m[2]),
      rotation_BT_(mount_rotation(specification.mount)),
      rate_Hz_(specification.rate_Hz),
      latency_{static_cast<std::int64_t>(std::llround(noise.latency_s * 1e9))},
      random_(seed, kPoseStream),
      start_W_m_(p_WB_m + rotation_WB * mount_B_m_),
      rotation_SW_((rotation_WB * rotation_BT_).transpose()) {}

Vector3 SimPosePort::normal_vector(double sigma) {
  Vector3 v;
  for (Eigen::Index i = 0; i < 3; ++i) v[i] = sigma * random_.normal();
  return v;
}

// The camera's belief turns about the camera itself: an error of yaw bends the way from here on and
// leaves the place where it happens.
void SimPosePort::turn_and_shift(const Vector3& p_WT_m, double yaw_rad, const Vector3& shift_m) {
  const Vector3 seen = turn_z(yaw_rad_) * p_WT_m + shift_m_ + shift_m;
  yaw_rad_ += yaw_rad;
  shift_m_ = seen - turn_z(yaw_rad_) * p_WT_m;
}

void SimPosePort::drift(const Vector3& p_WT_m, double span_s) {
  const double root = std::sqrt(span_s);
  const Vector3 walk = normal_vector(noise_.position_walk_m_rts * root);
  const double turn = noise_.yaw_walk_rad_rts * root * random_.normal();
  turn_and_shift(p_WT_m, turn, walk);
  const double chance = random_.uniform();
  if (noise_.jump_interval_s <= 0 || chance >= span_s / noise_.jump_interval_s) return;
  ++pose_counters_.jumps;
  const Vector3 step = normal_vector(noise_.jump_m);
  turn_and_shift(p_WT_m, noise_.jump_rad * random_.normal(), step);
}

std::uint8_t SimPosePort::confidence(double t_s) {
  return t_s - regained_s_ < noise_.regain_s ? kLowConfidence : kHighConfidence;
}

hal::PoseSample SimPosePort::measure(TimeNs now, const Vector3& p_WT_m, const Matrix3& rotation_WT,
                                     std::uint8_t confidence) {
  const double factor = confidence == kHighConfidence ? 1.0 : noise_.regain_noise_factor;
  const Matrix3 seen = turn_z(yaw_rad_);
  const Vector3 jitter_m = normal_vector(noise_.position_noise_m * factor);
  const Vector3 jitter_rad = normal_vector(noise_.attitude_noise_rad * factor);
  const Vector3 p_ST_m = rotation_SW_ * (seen * p_WT_m + shift_m_ - start_W_m_) + jitter_m;
  const double angle = jitter_rad.norm();
  const Matrix3 jitter = angle > 0 ? Eigen::AngleAxisd(angle, jitter_rad / angle).toRotationMatrix()
                                   : Matrix3(Matrix3::Identity());
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(rotation_SW_ * seen * rotation_WT * jitter).normalized();
  hal::PoseSample sample;
  sample.stamp = now;
  sample.sequence = sequence_++;
  sample.confidence = confidence;
  sample.p_ST_m = {p_ST_m.x(), p_ST_m.y(), p_ST_m.z()};
  sample.q_ST_wxyz = {q.w(), q.x(), q.y(), q.z()};
  return sample;
}

void SimPosePort::advance(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB) {
  now_ = now;
  if (now.seconds() * rate_Hz_ < static_cast<double>(next_) - 1e-6) return;
  next_ = static_cast<std::uint64_t>(std::floor(now.seconds() * rate_Hz_ + 1e-6)) + 1;
  const Vector3 p_WT_m = p_WB_m + rotation_WB * mount_B_m_;
  drift(p_WT_m, (now - last_).seconds());
  last_ = now;
  const double t = now.seconds();
  const hal::PoseSample sample = measure(now, p_WT_m, rotation_WB * rotation_BT_, confidence(t));
  if (t >= faults_.pose_off_from_s && t < faults_.pose_off_until_s) {
    regained_s_ = faults_.pose_off_until_s;
    ++pose_counters_.lost;
    return;
  }
  // Gaps are what never came here; what a full queue loses is counted as dropped, once.
  if (arrived_) counters_.gaps += sample.sequence - expected_;
  arrived_ = true;
  expected_ = sample.sequence + 1;
  if (queue_.push_overwrite(sample)) ++counters_.dropped;
}

std::size_t SimPosePort::do_receive(std::span<hal::PoseSample> out) {
  std::size_t count = 0;
  while (count < out.size() && !queue_.empty() && queue_.front().stamp + latency_ <= now_) {
    out[count++] = queue_.front();
    queue_.pop_front();
    ++counters_.delivered;
  }
  return count;
}

}  // namespace surefoot::sim
