#include "core/autonomy/stereo_task.h"

#include <algorithm>

#include "core/math/elementary.h"
#include "core/stereo/point_cloud.h"

namespace surefoot::autonomy {
namespace {

// Half of the window that census and smoothing look at: it must be seen by both cameras.
constexpr std::uint16_t kWindow_px = 3;
constexpr double kDepthSteps = 65000.0;  // from 0 to the maximum range

}  // namespace

Status plan_stereo(const robot::StereoCameraSpecification& camera, const StereoConfig& config,
                   StereoPlan& out) {
  RangeCheck check;
  StereoConfig::describe(config, check);
  robot::StereoCameraSpecification::describe(camera, check);
  const bool valid = camera.present && config.present && check.good &&
                     config.matcher.min_disparity_px >= 0 && ok(validate(config.matcher)) &&
                     camera.min_range_m < camera.max_range_m;
  if (!valid) return Status::kInvalid;
  StereoPlan plan;
  plan.calibration = stereo::stereo_calibration(camera.calibration);
  const int width_px = camera.calibration.width_px / config.shrink;
  const int height_px = camera.calibration.height_px / config.shrink;
  const int margin_px = config.matcher.min_disparity_px + config.matcher.disparities;
  if (width_px > static_cast<int>(hal::kMaxDepthWidth_px) ||
      height_px > static_cast<int>(hal::kMaxDepthHeight_px) ||
      width_px + margin_px > static_cast<int>(stereo::kMaxWidth_px)) {
    return Status::kExhausted;
  }
  const Status status = stereo::rectify(plan.calibration, static_cast<std::uint16_t>(width_px),
                                        static_cast<std::uint16_t>(height_px), 0.0, plan.pair);
  if (!ok(status)) return status;
  plan.margin_px = static_cast<std::uint16_t>(margin_px);
  plan.pair.width_px = static_cast<std::uint16_t>(width_px + margin_px);
  plan.pair.cx_px += margin_px;
  out = plan;
  return Status::kOk;
}

void StereoTrigger::reset(const StereoConfig& config) {
  config_ = config;
  due_ = true;
  since_s_ = config.period_s;
}

bool StereoTrigger::update(const StereoMoment& moment, double step_s) {
  since_s_ += step_s;
  if (!config_.present || !moment.standing) return false;
  due_ = due_ || moment.shifted || since_s_ >= config_.period_s;
  const bool steady = moment.turn_rate_rad_s <= config_.steady_rate_rad_s &&
                      moment.speed_m_s <= config_.steady_speed_m_s;
  if (!due_ || !steady || since_s_ < config_.least_interval_s) return false;
  due_ = false;
  since_s_ = 0;
  return true;
}

Status StereoTask::reset(const robot::StereoCameraSpecification& camera, const StereoConfig& config,
                         const CameraMotionConfig& motion, bool maps) {
  enabled_ = false;
  maps_ = false;
  counters_ = StereoCounters{};
  valid_share_ = 0;
  valid_share_sum_ = 0;
  fresh_ = false;
  working_ = 0;
  if (!camera.present) return motion.present ? Status::kInvalid : Status::kOk;
  const Status planned = plan_stereo(camera, config, plan_);
  if (!ok(planned)) return planned;
  config_ = config;
  if (!ok(rectifier_.configure(plan_.calibration, plan_.pair))) return Status::kInvalid;
  if (!ok(matcher_.configure(config.matcher))) return Status::kInvalid;
  camera_.X_BC = optical_pose(camera.mount);
  camera_.X_BC.rotation.matrix *= plan_.pair.R_NV.transpose();
  camera_.sensor.inverse_depth_sigma_per_m =
      config.noise.disparity_floor_px / (plan_.pair.focal_px * plan_.pair.baseline_m);
  camera_.sensor.min_range_m = camera.min_range_m;
  camera_.sensor.max_range_m = camera.max_range_m;
  depth_unit_m_ = camera.max_range_m / kDepthSteps;
  const Status moves = motion_.reset(motion, plan_.pair, camera_.X_BC);
  if (!ok(moves)) return moves;
  enabled_ = true;
  maps_ = maps;
  warm_up();
  return Status::kOk;
}

void StereoTask::warm_up() {
  pair_ = hal::StereoFrame{};
  pair_.width_px = plan_.calibration.left.width_px;
  pair_.height_px = plan_.calibration.left.height_px;
  for (StereoPicture& picture : pictures_) {
    picture.depth.depth.fill(0);
    picture.noise.factors.fill(0);
  }
  run();
  working_ = 0;
  working_share_ = 0;
}

bool StereoTask::release(const hal::StereoFrame& pair, const PoseHistory& history) {
  if (!enabled_) return false;
  if (pair.width_px != plan_.calibration.left.width_px ||
      pair.height_px != plan_.calibration.left.height_px) {
    ++counters_.pairs_refused;
    return false;
  }
  pair_.assign(pair);
  motion_.release(pair.stamp, history);
  return true;
}

void StereoTask::run() {
  const stereo::GreyView left{pair_.left.data(), pair_.width_px, pair_.height_px};
  const stereo::GreyView right{pair_.right.data(), pair_.width_px, pair_.height_px};
  SUREFOOT_ASSERT(ok(rectifier_.run(left, right, left_, right_)));
  if (maps_) {
    SUREFOOT_ASSERT(ok(matcher_.match(left_.view(), right_.view(), disparities_)));
    rectifier_.clear_unseen(kWindow_px, disparities_);
    fill(pictures_[working_]);
  }
  motion_.run(left_.view(), right_.view(), maps_ ? &disparities_ : nullptr);
}

// The disparities without the margin, as depth along the axis of N.
void StereoTask::fill(StereoPicture& picture) {
  const stereo::RectifiedPair& pair = plan_.pair;
  const std::uint16_t width = static_cast<std::uint16_t>(pair.width_px - plan_.margin_px);
  picture.depth.stamp = pair_.stamp;
  picture.depth.sequence = pair_.sequence;
  picture.depth.intrinsics = {
      width,     pair.height_px, pair.focal_px, pair.focal_px, pair.cx_px - plan_.margin_px,
      pair.cy_px};
  picture.depth.depth_unit_m = static_cast<float>(depth_unit_m_);
  const double unit_m = static_cast<double>(picture.depth.depth_unit_m);
  const double numerator = pair.focal_px * pair.baseline_m * stereo::kSubpixels;
  const double per_sigma = mapping::DepthNoise::kUnit / config_.noise.disparity_floor_px;
  std::uint32_t valid = 0;
  std::size_t i = 0;
  for (std::size_t v = 0; v < pair.height_px; ++v) {
    const std::int16_t* row = disparities_.row(v);
    for (std::size_t u = plan_.margin_px; u < pair.width_px; ++u, ++i) {
      picture.depth.depth[i] = 0;
      if (row[u] == stereo::kNoDisparity || row[u] <= 0) continue;
      const double z_m = numerator / row[u];
      if (z_m < camera_.sensor.min_range_m || z_m > camera_.sensor.max_range_m) continue;
      if (is_foreground_rim(disparities_, u, v, config_.rim_px, config_.rim_step_px)) continue;
      const double sigma_px = math::sqrt(disparity_variance_px2(disparities_, u, v, config_.noise));
      picture.depth.depth[i] = static_cast<std::uint16_t>(math::floor_of(z_m / unit_m + 0.5));
      picture.noise.factors[i] =
          static_cast<std::uint16_t>(std::min(sigma_px * per_sigma + 0.5, 65535.0));
      ++valid;
    }
  }
  working_share_ = static_cast<double>(valid) / static_cast<double>(i);
  picture.usable = valid > 0 && working_share_ >= config_.least_valid_share;
}

void StereoTask::publish() {
  ++counters_.pairs_matched;
  if (!maps_) return;
  valid_share_ = working_share_;
  valid_share_sum_ += working_share_;
  fresh_ = pictures_[working_].usable;
  if (!fresh_) ++counters_.pairs_unusable;
  working_ = 1 - working_;
}

double StereoTask::mean_valid_share() const {
  const auto pairs = static_cast<double>(counters_.pairs_matched);
  return pairs > 0 ? valid_share_sum_ / pairs : 0.0;
}

const StereoPicture* StereoTask::take() {
  if (!fresh_) return nullptr;
  fresh_ = false;
  return &pictures_[1 - working_];
}

}  // namespace surefoot::autonomy
