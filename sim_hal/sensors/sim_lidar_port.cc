#include "sim_hal/sensors/sim_lidar_port.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/robot/articulation.h"

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kLidarStream = 21;
constexpr double kTurn_rad = 6.283185307179586;
// Two surfaces in a beam: nearer together than the first they are one echo; farther apart than the
// second they are two, of which the stronger counts (a pulse is some 1.5 m long).
constexpr double kOneEcho_m = 0.1;
constexpr double kTwoEchoes_m = 2.0;

double median(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

SimLidarPort::SimLidarPort(const robot::LidarSpecification& specification,
                           const LidarNoiseConfig& noise, const FaultConfig& faults,
                           const TerrainIndex& terrain, const SolidIndex& solids,
                           std::uint64_t seed)
    : specification_(specification),
      noise_(noise),
      faults_(faults),
      terrain_(terrain),
      solids_(solids),
      seed_(seed),
      mount_B_m_(specification.mount.position_B_m[0], specification.mount.position_B_m[1],
                 specification.mount.position_B_m[2]),
      rotation_BL_(mount_rotation(specification.mount)),
      latency_{std::llround(noise.latency_s * 1e9)} {
  // The mirror turns once per scan.
  const double step = specification_.angle_step_rad();
  beam_interval_ = {std::llround(1e9 * step / (kTurn_rad * specification_.rate_Hz))};
  const auto direction = [](double angle) {
    return Vector3(std::cos(angle), std::sin(angle), 0.0);
  };
  const double part = specification_.beam_divergence_rad / 3;
  for (std::uint16_t i = 0; i < specification_.beams; ++i) {
    const double angle = -0.5 * specification_.view_rad + step * i;
    beams_.push_back({direction(angle - part), direction(angle), direction(angle + part)});
  }
}

SimLidarPort::Pose SimLidarPort::pose(const Vector3& p_WB_m, const Matrix3& rotation_WB) const {
  return {p_WB_m + rotation_WB * mount_B_m_,
          Eigen::Quaterniond(rotation_WB * rotation_BL_).normalized()};
}

void SimLidarPort::advance(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
                           std::span<const Solid> moving, const TerrainBox* obstacle) {
  now_ = now;
  if (sweeping_) {
    const std::int64_t swept_ns = beam_interval_.ns * (specification_.beams - 1);
    const std::int64_t passed_ns = (now - current_.stamp).ns;
    if (!seen_moving_ && 2 * passed_ns >= swept_ns) {
      seen_moving_ = true;
      current_.moving.solids.clear();
      for (const Solid& solid : moving) {
        static_cast<void>(current_.moving.solids.push_back(solid));  // at most kMaxWalkers
      }
      current_.moving.obstacle.reset();
      if (obstacle != nullptr) current_.moving.obstacle = *obstacle;
    }
    if (passed_ns >= swept_ns) finish(now, pose(p_WB_m, rotation_WB));
  }
  if (sweeping_ || now.seconds() * specification_.rate_Hz < static_cast<double>(next_) - 1e-6) {
    return;
  }
  next_ = static_cast<std::uint64_t>(std::floor(now.seconds() * specification_.rate_Hz + 1e-6)) + 1;
  current_.stamp = now;
  current_.sequence = sequence_++;
  current_.first = pose(p_WB_m, rotation_WB);
  seen_moving_ = false;
  sweeping_ = true;
}

void SimLidarPort::finish(TimeNs now, const Pose& pose) {
  sweeping_ = false;
  const double t = current_.stamp.seconds();
  if (t >= faults_.lidar_off_from_s && t < faults_.lidar_off_until_s) {
    ++lidar_counters_.scans_lost;
    return;
  }
  current_.last = pose;
  current_.end = now;
  // Gaps are what never came here; what a full queue loses is counted as dropped, once.
  if (arrived_) counters_.gaps += current_.sequence - expected_;
  arrived_ = true;
  expected_ = current_.sequence + 1;
  if (queue_.push_overwrite(current_)) ++counters_.dropped;
}

Status SimLidarPort::do_receive(hal::LidarScan& out) {
  if (queue_.empty() || queue_.front().end + latency_ > now_) return Status::kUnavailable;
  cast(queue_.front(), out);
  queue_.pop_front();
  ++counters_.delivered;
  return Status::kOk;
}

// Between first and last the body is taken to move evenly: over one sweep of a trot this is wrong
// by tenths of a millimetre.
void SimLidarPort::cast(const Sweep& sweep, hal::LidarScan& out) {
  Random random(seed_ + 0x9e3779b97f4a7c15ull * (sweep.sequence + 1ull), kLidarStream);
  out.stamp = sweep.stamp;
  out.beam_interval = beam_interval_;
  out.sequence = sweep.sequence;
  out.beam_count = specification_.beams;
  out.first_angle_rad = static_cast<float>(-0.5 * specification_.view_rad);
  out.angle_step_rad = static_cast<float>(specification_.angle_step_rad());
  const auto span_ns = static_cast<double>((sweep.end - sweep.stamp).ns);
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const double passed = static_cast<double>(beam_interval_.ns) * static_cast<double>(i);
    const double s = span_ns > 0 ? passed / span_ns : 0.0;
    const Pose at{sweep.first.p_WL_m + s * (sweep.last.p_WL_m - sweep.first.p_WL_m),
                  sweep.first.q_WL.slerp(s, sweep.last.q_WL)};
    out.range_m[i] = static_cast<float>(measure(sweep, at, beams_[i], random));
  }
  lidar_counters_.beams += beams_.size();
}

double SimLidarPort::surface(const Sweep& sweep, const Vector3& origin,
                             const Vector3& direction) const {
  double nearest = terrain_.cast_fixed(origin, direction, specification_.max_range_m);
  for (const Solid& solid : sweep.moving.solids) {
    nearest = std::min(nearest, cast_solid(solid, origin, direction));
  }
  if (sweep.moving.obstacle) {
    nearest = std::min(nearest, cast_box(*sweep.moving.obstacle, origin, direction));
  }
  return nearest;
}

// What comes back, without noise. Three parts of the beam's footprint decide.
double SimLidarPort::echo(const Sweep& sweep, const Pose& at, const Beam& beam, Random& random) {
  const Matrix3 R_WL = at.q_WL.toRotationMatrix();
  const Vector3 centre = R_WL * beam.centre;
  const double a = surface(sweep, at.p_WL_m, R_WL * beam.right);
  const double b = surface(sweep, at.p_WL_m, centre);
  const double c = surface(sweep, at.p_WL_m, R_WL * beam.left);
  const double near = std::min(a, std::min(b, c));
  const double far = std::max(a, std::max(b, c));
  double range = median(a, b, c);
  if (far - near > kOneEcho_m && far - near < kTwoEchoes_m &&
      random.uniform() < noise_.mixed_pixel) {
    ++lidar_counters_.mixed;
    range = random.uniform(near, far);
  }
  double share = 0;
  const double limit = std::min(range, specification_.max_range_m);
  const double sapling =
      solids_.cast_saplings(at.p_WL_m, centre, limit, specification_.beam_divergence_rad, share);
  if (sapling != kNoHit && random.uniform() < noise_.sapling_return * share) {
    ++lidar_counters_.sapling_returns;
    return sapling;
  }
  return range;
}

double SimLidarPort::measure(const Sweep& sweep, const Pose& at, const Beam& beam, Random& random) {
  const double exact = echo(sweep, at, beam, random);
  const double error_m = specification_.range_noise_m * random.normal();
  if (random.uniform() < noise_.random_dropout) {
    ++lidar_counters_.random_dropouts;
    return 0.0;
  }
  const double range = exact + error_m;
  if (!(range >= specification_.min_range_m && range <= specification_.max_range_m)) {
    ++lidar_counters_.no_returns;
    return 0.0;
  }
  return range;
}

}  // namespace surefoot::sim
