#include "sim_hal/robot/fast_plant.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/math/gravity.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/simulator_error.h"

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kPlantStream = 22;
constexpr double kPi = 3.141592653589793;

// Rising.
constexpr double kRiseFrom_s = 0.1;
constexpr double kRiseUntil_s = 0.9;
constexpr double kStandingShare = 0.72;  // of the legs' length

// Following a command.
constexpr double kLag_s = 0.15;
constexpr double kMost_m_s2 = 3.0;
constexpr double kMost_rad_s2 = 8.0;
constexpr double kFroude = 0.8;     // fastest trot: this times sqrt(g h)
constexpr double kLeftShare = 0.4;  // fastest sideways, of the fastest
constexpr double kFastestTurn_rad_s = 2.0;

// The trot.
constexpr double kTrot_Hz = 2.0;
constexpr double kStart_s = 0.2;  // from stand to trot
constexpr double kSway_m = 0.006;
constexpr double kBob_m = 0.005;
constexpr double kRoll_rad = 0.025;
constexpr double kPitch_rad = 0.02;
constexpr double kUp_1_s = 15.0;  // how fast the body follows the ground
constexpr double kLean_1_s = 10.0;

// Disturbances: of forward, leftward velocity and yaw rate, one sigma.
constexpr double kWindForward_m_s = 0.03;
constexpr double kWindLeft_m_s = 0.03;
constexpr double kWindTurn_rad_s = 0.04;
constexpr double kWind_s = 0.5;
constexpr double kWindLag_s = 0.05;
constexpr double kGustInterval_s = 8.0;
constexpr double kGust = 5.0;  // a gust: this times sigma

// Stumbling: looked at every so many steps.
constexpr std::uint64_t kLook = 20;
constexpr double kTwistFree_m = 0.04;
constexpr double kStumbles_1_m2 = 50.0;  // per metre of way and metre of twist beyond
constexpr double kStumble_s = 0.25;
constexpr double kStumbleSlows = 0.5;
constexpr double kStumbleLean_rad = 0.08;

// Ground that a trot does not step over.
constexpr double kStepHeight_m = 0.1;
constexpr double kStepRaster_m = 0.05;

// Leg odometry.
constexpr std::uint64_t kOdometryEvery_ns = 2'000'000;
constexpr double kOdometryNoise_m_s = 0.02;
constexpr double kHeightNoise_m = 0.003;

double limited(double value, double most) { return std::clamp(value, -most, most); }

double smooth(double s) { return s * s * (3 - 2 * s); }

}  // namespace

FastPlant::FastPlant(const robot::RobotModel& robot, const SimulatorConfig& config,
                     const TerrainIndex& index, const SolidIndex& solids, const Walkers& walkers,
                     std::uint64_t seed)
    : robot_(robot),
      footprint_(robot),
      step_s_(TimeNs{std::llround(config.physics.step_s * 1e9)}.seconds()),
      step_{std::llround(config.physics.step_s * 1e9)},
      index_(index),
      solids_(solids),
      walkers_(walkers),
      start_(config.scenario.start),
      pushes_(config.scenario.push, seed),
      random_(seed, kPlantStream) {
  if (start_.kind != StartConfig::Kind::kFolded) {
    throw SimulatorError("simulator: plant: fast stands on its feet; scenario.start.kind: folded");
  }
  const auto& leg = config.start.leg_rad;
  folded_m_ = robot.thigh_length_m * std::cos(leg[1]) +
              robot.shank_length_m * std::cos(leg[1] + leg[2]) + robot.foot_radius_m;
  standing_m_ =
      kStandingShare * (robot.thigh_length_m + robot.shank_length_m) + robot.foot_radius_m;
  fastest_m_s_ = kFroude * std::sqrt(kGravity_m_s2 * standing_m_);
  errors_.forward = 1 + 0.03 * random_.normal();
  errors_.left = 1 + 0.05 * random_.normal();
  errors_.turn = 1 + 0.03 * random_.normal();
  errors_.drift = 0.02 * random_.normal();
  const auto odometry = [this] {
    const double size = random_.uniform(0.005, 0.018);
    return random_.below(2) == 0 ? 1 - size : 1 + size;
  };
  errors_.odometry_forward = odometry();
  errors_.odometry_left = odometry();
  errors_.odometry_across = random_.uniform(-0.008, 0.008);
  set_down(seed);
}

void FastPlant::set_down(std::uint64_t) {
  p_WB_m_ = Vector3(start_.x_m, 0, 0);
  up_ = {ground().height_m, 0};
  p_WB_m_.z() = up_.value + folded_m_;
}

void FastPlant::place_obstacle(const TerrainBox& box) {
  obstacle_ = Solid{SolidKind::kWall, {}, box};
}

FastPlant::Ground FastPlant::ground() const {
  std::array<double, robot::kLegs> heights{};
  const double x = footprint_.half_length_m;
  const double y = footprint_.half_width_m;
  const double c = std::cos(yaw_rad_);
  const double s = std::sin(yaw_rad_);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const double along = robot::front_sign(leg) * x;
    const double across = robot::left_sign(leg) * y;
    heights[leg] =
        index_.height_m(p_WB_m_.x() + c * along - s * across, p_WB_m_.y() + s * along + c * across);
  }
  const auto& h = heights;  // FR, FL, HR, HL
  return {(h[0] + h[1] + h[2] + h[3]) / 4, (h[0] + h[1] - h[2] - h[3]) / (4 * x),
          (h[1] + h[3] - h[0] - h[2]) / (4 * y), 0.5 * std::fabs(h[1] - h[0] - h[3] + h[2])};
}

double FastPlant::height_m(TimeNs now) const {
  const double s =
      std::clamp((now.seconds() - kRiseFrom_s) / (kRiseUntil_s - kRiseFrom_s), 0.0, 1.0);
  return folded_m_ + smooth(s) * (standing_m_ - folded_m_);
}

// The gait's own velocities after what is commanded.
void FastPlant::drive(TimeNs now) {
  const hal::GaitCommand command = port_.command(now);
  const bool walks = command.walk && now.seconds() >= kRiseUntil_s;
  const double slowed = 1 - kStumbleSlows * stumble_;
  const auto toward = [&](double target, double most, double& value) {
    value += limited((target - value) / kLag_s, most) * step_s_;
  };
  const double forward = walks ? limited(command.forward_m_s, fastest_m_s_) : 0.0;
  const double left = walks ? limited(command.left_m_s, kLeftShare * fastest_m_s_) : 0.0;
  const double turn = walks ? limited(command.yaw_rate_rad_s, kFastestTurn_rad_s) : 0.0;
  toward(slowed * errors_.forward * forward, kMost_m_s2, forward_m_s_);
  toward(slowed * errors_.left * left, kMost_m_s2, left_m_s_);
  toward(errors_.turn * turn + errors_.drift * forward, kMost_rad_s2, yaw_rate_rad_s_);
  activity_ += ((walks ? 1.0 : 0.0) - activity_) / kStart_s * step_s_;
  phase_rad_ += 2 * kPi * kTrot_Hz * step_s_;
  if (phase_rad_ > 2 * kPi) phase_rad_ -= 2 * kPi;
  const Vector3 left_W(-std::sin(yaw_rad_), std::cos(yaw_rad_), 0);
  const Vector3 push =
      (force_W_N_ + pushes_.force_W_N(now, left_W)) * (step_s_ / robot_.total_mass_kg());
  forward_m_s_ += push.x() * std::cos(yaw_rad_) + push.y() * std::sin(yaw_rad_);
  left_m_s_ += push.dot(left_W);
}

// A random walk that is pulled back, and gusts.
void FastPlant::blow() {
  const Vector3 sigma(kWindForward_m_s, kWindLeft_m_s, kWindTurn_rad_s);
  const double root = std::sqrt(2 * step_s_ / kWind_s);
  for (Eigen::Index i = 0; i < 3; ++i) {
    wind_[i] += -wind_[i] / kWind_s * step_s_ + sigma[i] * root * random_.normal();
  }
  if (random_.uniform() < step_s_ / kGustInterval_s) {
    const Eigen::Index i = random_.below(3);
    wind_[i] += (random_.below(2) == 0 ? -1.0 : 1.0) * kGust * sigma[i];
  }
  swing_ += (activity_ * wind_ - swing_) / kWindLag_s * step_s_;
}

void FastPlant::stumble(const Ground& ground) {
  stumble_ -= stumble_ / kStumble_s * step_s_;
  if (steps_ % kLook != 0) return;
  over_step_ = over_step();
  const double way_m = std::hypot(forward_m_s_, left_m_s_) * step_s_ * static_cast<double>(kLook);
  const double chance = kStumbles_1_m2 * std::max(0.0, ground.twist_m - kTwistFree_m) * way_m;
  const double draw = random_.uniform();
  const bool to_left = random_.below(2) == 0;
  if (draw >= chance) return;
  stumble_ = 1;
  stumble_side_ = to_left ? 1.0 : -1.0;
}

// Neighbouring points of the ground under the body differ by more than a trot steps over.
bool FastPlant::over_step() const {
  const double x = footprint_.half_length_m;
  const double y = footprint_.half_width_m;
  const int nx = static_cast<int>(std::ceil(2 * x / kStepRaster_m));
  const int ny = static_cast<int>(std::ceil(2 * y / kStepRaster_m));
  const double c = std::cos(yaw_rad_);
  const double s = std::sin(yaw_rad_);
  const auto at = [&](int i, int j) {
    const double along = x * (2.0 * i / nx - 1);
    const double across = y * (2.0 * j / ny - 1);
    return index_.height_m(p_WB_m_.x() + c * along - s * across,
                           p_WB_m_.y() + s * along + c * across);
  };
  for (int j = 0; j <= ny; ++j) {
    double last = at(0, j);
    for (int i = 1; i <= nx; ++i) {
      const double here = at(i, j);
      if (std::fabs(here - last) > kStepHeight_m) return true;
      if (j < ny && std::fabs(at(i, j + 1) - here) > kStepHeight_m) return true;
      last = here;
    }
  }
  return false;
}

FastPlant::Rhythm FastPlant::rhythm(double phase_rad) const {
  return {activity_ * kSway_m * std::sin(phase_rad), activity_ * kBob_m * std::sin(2 * phase_rad),
          activity_ * kRoll_rad * std::sin(phase_rad + 0.6),
          activity_ * kPitch_rad * std::sin(2 * phase_rad + 1.1)};
}

void FastPlant::turn_to(double roll, double pitch, double yaw) {
  R_WB_ = rotation_z(yaw) * rotation_y(pitch) * rotation_x(roll);
}

// Pushed back out of whatever stands there.
Vector2 FastPlant::kept_out(const Vector2& from_m, Vector2 to_m) {
  touching_ = false;
  for (int i = 0; i < 3; ++i) {
    const Vector3 at(to_m.x(), to_m.y(), 0);
    Clearance clearance = footprint_.clearance(at, R_WB_, solids_, walkers_, 0.0);
    if (obstacle_) {
      Vector2 away;
      const Vector3 along = footprint_.half_length_m * R_WB_.col(0);
      const Vector2 reach(along.x(), along.y());
      const double distance =
          plan_distance_m(*obstacle_, to_m - reach, to_m + reach, away) - footprint_.half_width_m;
      if (distance < clearance.distance_m) clearance = {distance, away};
    }
    if (clearance.distance_m >= 0) break;
    touching_ = true;
    to_m -= clearance.distance_m * clearance.away;
  }
  if (touching_) {  // the gait has been stopped there too
    const Vector2 velocity = (to_m - from_m) / step_s_;
    const double c = std::cos(yaw_rad_);
    const double s = std::sin(yaw_rad_);
    const double ahead = c * velocity.x() + s * velocity.y();
    forward_m_s_ = forward_m_s_ > 0 ? std::clamp(ahead, 0.0, forward_m_s_)
                                    : std::clamp(ahead, forward_m_s_, 0.0);
    const double aside = c * velocity.y() - s * velocity.x();
    left_m_s_ =
        left_m_s_ > 0 ? std::clamp(aside, 0.0, left_m_s_) : std::clamp(aside, left_m_s_, 0.0);
  }
  return to_m;
}

// Everything moves from one step's pose to the next one's; velocities are what that takes.
void FastPlant::pose(TimeNs now, const Ground& ground) {
  const Rhythm next = rhythm(phase_rad_);
  const double sway_m_s = (next.left_m - rhythm_.left_m) / step_s_;
  const double forward = forward_m_s_ + swing_.x();
  const double left = left_m_s_ + swing_.y() + sway_m_s;
  const double yaw_rate = yaw_rate_rad_s_ + swing_.z();
  const double c = std::cos(yaw_rad_);
  const double s = std::sin(yaw_rad_);
  const Vector2 from_m(p_WB_m_.x(), p_WB_m_.y());
  const Vector2 to_m =
      kept_out(from_m, from_m + step_s_ * Vector2(c * forward - s * left, s * forward + c * left));

  const double lean = stumble_ * kStumbleLean_rad;
  up_.follow(ground.height_m, kUp_1_s, step_s_);
  roll_.follow(std::atan(ground.across) + stumble_side_ * lean, kLean_1_s, step_s_);
  pitch_.follow(-std::atan(ground.along) + lean, kLean_1_s, step_s_);
  const Vector3 before = p_WB_m_;
  p_WB_m_ = Vector3(to_m.x(), to_m.y(), up_.value + height_m(now + step_) + next.up_m);
  v_WB_m_s_ = (p_WB_m_ - before) / step_s_;

  const double roll = roll_.value + next.roll_rad;
  const double pitch = pitch_.value + next.pitch_rad;
  const double roll_rate = roll_.rate + (next.roll_rad - rhythm_.roll_rad) / step_s_;
  const double pitch_rate = pitch_.rate + (next.pitch_rad - rhythm_.pitch_rad) / step_s_;
  yaw_rad_ += yaw_rate * step_s_;
  turn_to(roll, pitch, yaw_rad_);
  w_WB_rad_s_ = rotation_z(yaw_rad_) *
                    (Vector3(0, pitch_rate, 0) + rotation_y(pitch) * Vector3(roll_rate, 0, 0)) +
                Vector3(0, 0, yaw_rate);
  rhythm_ = next;
}

void FastPlant::step(TimeNs now) {
  const Ground here = ground();
  drive(now);
  blow();
  stumble(here);
  pose(now, here);
  ++steps_;
  const TimeNs after = now + step_;
  port_.advance(after);
  const auto every = static_cast<std::int64_t>(kOdometryEvery_ns);
  if (after.ns / every != now.ns / every) port_.push(odometry(after));
}

hal::GaitSample FastPlant::odometry(TimeNs now) {
  const Vector3 v_B = R_WB_.transpose() * v_WB_m_s_;
  Vector3 noise;
  for (Eigen::Index i = 0; i < 3; ++i) noise[i] = kOdometryNoise_m_s * random_.normal();
  const double height_noise_m = kHeightNoise_m * random_.normal();
  const Vector3 told(errors_.odometry_forward * v_B.x(),
                     errors_.odometry_left * v_B.y() + errors_.odometry_across * v_B.x(), v_B.z());
  hal::GaitSample sample;
  sample.stamp = now;
  sample.velocity_B_m_s = to_array(told + noise);
  sample.height_m = p_WB_m_.z() - ground().height_m + height_noise_m;
  sample.standing = now.seconds() >= kRiseUntil_s;
  return sample;
}

void FastPlant::tell(Truth& truth) const {
  const Eigen::Quaterniond q(R_WB_);
  truth.q_WB_wxyz = {q.w(), q.x(), q.y(), q.z()};
  const double weight_N = robot_.total_mass_kg() * kGravity_m_s2;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const double along = robot::front_sign(leg) * footprint_.half_length_m;
    const double across = robot::left_sign(leg) * (footprint_.half_width_m - robot_.foot_radius_m);
    const double c = std::cos(yaw_rad_);
    const double s = std::sin(yaw_rad_);
    const double x = p_WB_m_.x() + c * along - s * across;
    const double y = p_WB_m_.y() + s * along + c * across;
    FootTruth& foot = truth.feet[leg];
    foot.p_WF_m = {x, y, index_.height_m(x, y) + robot_.foot_radius_m};
    foot.force_W_N = {0, 0, weight_N / robot::kLegs};
    foot.contact = true;
  }
}

void FastPlant::hash(Fnv64& digest) const {
  const auto feed = [&digest](const double* values, int count) {
    for (int i = 0; i < count; ++i) digest.word(std::bit_cast<std::uint64_t>(values[i]), 8);
  };
  feed(p_WB_m_.data(), 3);
  feed(v_WB_m_s_.data(), 3);
  feed(w_WB_rad_s_.data(), 3);
  feed(R_WB_.data(), 9);
}

}  // namespace surefoot::sim
