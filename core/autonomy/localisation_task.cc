#include "core/autonomy/localisation_task.h"

#include <algorithm>

#include "core/mapping/self_filter.h"
#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

registration::SourcePose source_pose(const PastPose& pose) {
  registration::SourcePose X_OB;
  X_OB.rotation.matrix = geometry::to_matrix(pose.q_OB);
  X_OB.origin.m = pose.p_OB_m;
  return X_OB;
}

}  // namespace

Status LocalisationTask::reset(const LocalisationConfig& config,
                               const mapping::MappingConfig& mapping,
                               const robot::RobotModel& model, const MapCamera& camera) {
  enabled_ = false;
  counters_ = LocalisationCounters{};
  if (!config.present || !mapping.enabled) return Status::kOk;
  RangeCheck check;
  LocalisationConfig::describe(config, check);
  if (!check.good) return Status::kInvalid;
  const Status configured = aligner_.configure(config.registration);
  if (!ok(configured)) return configured;
  config_ = config;
  mapping_ = mapping;
  model_ = model;
  camera_ = camera;
  enabled_ = true;
  touch();
  forget();
  return Status::kOk;
}

// No page fault may happen in a tick.
void LocalisationTask::touch() {
  picture_.touch();
  image_.z_m.fill(0);
  image_.nearest_m.fill(0);
  image_.mixed.fill(0);
  image_.noise.fill(0);
  SUREFOOT_ASSERT(ok(points_.resize(points_.capacity())));
  points_.clear();
  for (Scan& scan : scans_) {
    SUREFOOT_ASSERT(ok(scan.points.resize(scan.points.capacity())));
    scan.points.clear();
  }
  source_.touch();
  target_.touch();
  aligner_.touch();
}

void LocalisationTask::forget() {
  scan_count_ = 0;
  next_scan_ = 0;
  fresh_ = false;
  shift_ = OdometryShift{};
  registration_ = registration::Registration{};
}

bool LocalisationTask::release(const hal::DepthFrame& frame, const mapping::DepthNoise* noise,
                               const Result<PastPose>& pose) {
  if (!enabled_) return false;
  if (!pose.ok()) {
    ++counters_.without_pose;
    return false;
  }
  picture_.assign(frame, noise, pose.value());
  return true;
}

void LocalisationTask::run() {
  gather();
  add_to_source();
  working_ = registration::Registration{};
  working_.X_TS = source_pose(picture_.pose);
  working_status_ = Status::kOk;
  if (scan_count_ > 0) {
    build_target();
    align();
  }
  keep_scan(working_.X_TS);
}

// The picture's points in B: no mixed pixels, none on the robot itself, none that are too noisy.
void LocalisationTask::gather() {
  mapping::prepare(picture_.frame, mapping_, camera_.sensor, image_, picture_.noise());
  const mapping::SelfModel self = self_model(model_, picture_.pose);
  const mapping::SelfFilter self_filter(self, mapping_.self_inflation_m);
  points_.clear();
  for (std::int32_t v = 0; v < image_.height; ++v) {
    for (std::int32_t u = 0; u < image_.width; ++u) {
      const std::size_t at = image_.at(u, v);
      const double z_m = static_cast<double>(image_.z_m[at]);
      if (!(z_m > 0) || image_.mixed[at] != 0) continue;
      const double factor = image_.has_noise ? static_cast<double>(image_.noise[at]) : 1.0;
      const double sigma_m = math::square(z_m) * camera_.sensor.inverse_depth_sigma_per_m * factor;
      if (sigma_m > config_.max_sigma_m) continue;
      const geometry::Point<geometry::DepthCamera> p_C{
          Vector3(image_.across[static_cast<std::size_t>(u)] * z_m,
                  image_.down[static_cast<std::size_t>(v)] * z_m, z_m)};
      const geometry::Point<geometry::Body> p_B = camera_.X_BC * p_C;
      if (self_filter.covers((self.X_OB * p_B).m)) continue;
      const Point point{static_cast<float>(p_B.m[0]), static_cast<float>(p_B.m[1]),
                        static_cast<float>(p_B.m[2])};
      SUREFOOT_ASSERT(ok(points_.push_back(point)));
    }
  }
}

void LocalisationTask::add_to_source() {
  SUREFOOT_ASSERT(ok(source_.reset(config_.registration.cell_m)));
  for (const Point& p : points_) {
    // A full cloud counts what it refuses; the cells it knows still take points.
    static_cast<void>(source_.add(p.p_B_m()));
  }
  static_cast<void>(source_.finish());
}

void LocalisationTask::build_target() {
  SUREFOOT_ASSERT(ok(target_.reset(config_.registration.cell_m)));
  for (std::size_t i = 0; i < scan_count_; ++i) {
    const Scan& scan = scans_[i];
    for (const Point& p : scan.points) {
      static_cast<void>(target_.add(scan.X_OB.rotation.matrix * p.p_B_m() + scan.X_OB.origin.m));
    }
  }
  static_cast<void>(target_.finish());
}

void LocalisationTask::align() {
  registration::Prior prior;
  prior.X_TS = working_.X_TS;
  prior.sigma_m = config_.drift_m;
  prior.sigma_rad = config_.drift_rad;
  working_status_ = aligner_.align(source_, target_, prior, working_);
  if (!ok(working_status_)) working_.X_TS = prior.X_TS;
}

// Where the trunk has gone far enough since the last one.
void LocalisationTask::keep_scan(const registration::SourcePose& X_OB) {
  if (points_.empty()) return;
  if (scan_count_ > 0) {
    const Scan& last = scans_[(next_scan_ + config_.scans - 1) % config_.scans];
    const double way_m2 = (X_OB.origin.m - last.X_OB.origin.m).squaredNorm();
    if (way_m2 < math::square(config_.scan_distance_m)) return;
  }
  Scan& scan = scans_[next_scan_];
  next_scan_ = (next_scan_ + 1) % config_.scans;
  scan_count_ = std::min<std::size_t>(scan_count_ + 1, config_.scans);
  scan.X_OB = X_OB;
  scan.points.clear();
  const std::size_t stride = (points_.size() + kScanPoints - 1) / kScanPoints;
  for (std::size_t i = 0; i < points_.size(); i += stride) {
    SUREFOOT_ASSERT(ok(scan.points.push_back(points_[i])));
  }
}

void LocalisationTask::publish() {
  const registration::SourcePose prior = source_pose(picture_.pose);
  switch (working_status_) {
    case Status::kOk: ++(working_.pairs > 0 ? counters_.registered : counters_.first); break;
    case Status::kUnavailable: ++counters_.thin; break;
    case Status::kOutOfRange: ++counters_.implausible; break;
    default: ++counters_.unmatched; break;
  }
  registration_ = working_;
  PastPose& pose = picture_.pose;
  shift_.pivot_O_m = pose.p_OB_m;
  shift_.shift_O_m = working_.X_TS.origin.m - pose.p_OB_m;
  shift_.yaw_rad = geometry::turn_about_z_rad(prior.rotation.matrix, working_.X_TS.rotation.matrix);
  pose.p_OB_m = working_.X_TS.origin.m;
  pose.q_OB = geometry::to_quaternion(working_.X_TS.rotation.matrix);
  fresh_ = true;
}

const PosedPicture* LocalisationTask::take() {
  if (!fresh_) return nullptr;
  fresh_ = false;
  return &picture_;
}

}  // namespace surefoot::autonomy
