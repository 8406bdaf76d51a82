#include "core/mapping/mapper.h"

#include <algorithm>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

constexpr double kRotationTolerance = 1e-3;

bool is_mappable(const Vector3& p_O_m) {
  return mapping::is_mappable(p_O_m.x()) && mapping::is_mappable(p_O_m.y()) &&
         mapping::is_mappable(p_O_m.z());
}

Status check_header(const hal::DepthFrame& frame) {
  const hal::PinholeIntrinsics& k = frame.intrinsics;
  const bool size = k.width_px > 0 && k.width_px <= hal::kMaxDepthWidth_px && k.height_px > 0 &&
                    k.height_px <= hal::kMaxDepthHeight_px;
  const bool lens = k.fx_px >= 1 && k.fx_px <= 1e5 && k.fy_px >= 1 && k.fy_px <= 1e5 &&
                    k.cx_px >= -1e4 && k.cx_px <= 1e4 && k.cy_px >= -1e4 && k.cy_px <= 1e4;
  const bool unit = frame.depth_unit_m >= 1e-6F && frame.depth_unit_m <= 1.0F;
  return size && lens && unit ? Status::kOk : Status::kInvalid;
}

// Stamps of cells count from 1, so that 0 can say "never"; they wrap after 49 days.
std::uint32_t to_ms(TimeNs stamp) { return static_cast<std::uint32_t>(stamp.ns / 1'000'000) + 1u; }

std::int16_t to_mm(double metres) {
  const double mm = math::clamp(metres * 1000.0, -32000.0, 32000.0);
  return static_cast<std::int16_t>(mm < 0 ? mm - 0.5 : mm + 0.5);
}

}  // namespace

Status Mapper::configure(const MappingConfig& config, const DepthSensorModel& sensor,
                         const TraversabilityLimits& limits) {
  if (!ok(validate(config)) || !ok(validate(sensor)) || !ok(validate(limits))) {
    return Status::kInvalid;
  }
  config_ = config;
  sensor_ = sensor;
  configured_ = true;
  stamp_ = TimeNs{};
  frames_ = 0;
  turn_ = SightTurn{};
  map_.reset({0, 0});
  classifier_.reset(config, limits);
  return Status::kOk;
}

Status Mapper::assume(const AssumedPad& pad) {
  if (!configured_) return Status::kUnavailable;
  const auto within = [](double value, double limit) { return value >= -limit && value <= limit; };
  const bool valid = math::is_finite(pad.x_O_m) && math::is_finite(pad.y_O_m) &&
                     math::is_finite(pad.z_O_m) && within(pad.yaw_rad, 1e3) &&
                     within(pad.slope_x, 1) && within(pad.slope_y, 1) && pad.half_length_m >= 0 &&
                     pad.half_length_m <= 5 && pad.half_width_m >= 0 && pad.half_width_m <= 5 &&
                     pad.sigma_m >= config_.min_sigma_m && pad.sigma_m <= config_.max_sigma_m;
  if (!valid) return Status::kInvalid;
  if (!is_mappable(Vector3(pad.x_O_m, pad.y_O_m, pad.z_O_m))) return Status::kOutOfRange;
  const double size = config_.cell_size_m;
  if (frames_ == 0) map_.recentre(cell_index(pad.x_O_m, pad.y_O_m, size));
  const math::SinCos yaw = math::sin_cos(pad.yaw_rad);
  const double reach = pad.half_length_m + pad.half_width_m;  // of any corner
  const CellIndex low = cell_index(pad.x_O_m - reach, pad.y_O_m - reach, size);
  const CellIndex high = cell_index(pad.x_O_m + reach, pad.y_O_m + reach, size);
  for (std::int32_t iy = low.iy; iy <= high.iy; ++iy) {
    for (std::int32_t ix = low.ix; ix <= high.ix; ++ix) {
      MapCell* cell = map_.find({ix, iy});
      if (cell == nullptr || cell->state == CellState::kMeasured) continue;
      const double dx = cell_centre(ix, size) - pad.x_O_m;
      const double dy = cell_centre(iy, size) - pad.y_O_m;
      if (!within(yaw.cos * dx + yaw.sin * dy, pad.half_length_m)) continue;
      if (!within(yaw.cos * dy - yaw.sin * dx, pad.half_width_m)) continue;
      *cell = MapCell{};
      cell->height_m = static_cast<float>(pad.z_O_m + pad.slope_x * dx + pad.slope_y * dy);
      cell->variance_m2 = static_cast<float>(pad.sigma_m * pad.sigma_m);
      cell->state = CellState::kAssumed;
    }
  }
  return Status::kOk;
}

Status Mapper::check(const hal::DepthFrame& frame, const CameraPose& X_OC,
                     const SelfModel& self) const {
  if (!configured_ || !config_.enabled) return Status::kUnavailable;
  if (!ok(check_header(frame)) || !ok(validate(self))) return Status::kInvalid;
  if (frame.stamp.ns < 0 || (frames_ > 0 && frame.stamp <= stamp_)) return Status::kInvalid;
  const Vector3& camera = X_OC.origin.m;
  const bool finite =
      math::is_finite(camera.x()) && math::is_finite(camera.y()) && math::is_finite(camera.z());
  if (!finite || !geometry::is_rotation(X_OC.rotation.matrix, kRotationTolerance))
    return Status::kInvalid;
  if (!is_mappable(camera) || !is_mappable(self.X_OB.origin.m)) return Status::kOutOfRange;
  return Status::kOk;
}

Status Mapper::integrate(const hal::DepthFrame& frame, const CameraPose& X_OC,
                         const SelfModel& self, IntegrationReport* report,
                         const DepthNoise* noise) {
  const Status status = check(frame, X_OC, self);
  if (!ok(status)) return status;
  IntegrationReport counts;
  prepare(frame, config_, sensor_, image_, noise);
  gather(X_OC, self, counts);
  if (scan_.size() > 0) {
    const Vector3& body = self.X_OB.origin.m;
    map_.recentre(cell_index(body.x(), body.y(), config_.cell_size_m));
    const std::uint32_t now_ms = to_ms(frame.stamp);
    fuse(now_ms, counts);
    const Sight sight{image_, X_OC, config_, sensor_, now_ms};
    clear_seen_through(sight, turn_, map_, counts);
    lower_ceilings(sight, turn_, map_, counts);
    stamp_ = frame.stamp;
    ++frames_;
  }
  if (report != nullptr) *report = counts;
  return scan_.size() > 0 ? Status::kOk : Status::kNotFound;
}

void Mapper::gather(const CameraPose& X_OC, const SelfModel& self, IntegrationReport& report) {
  scan_.clear();
  const SelfFilter self_filter(self, config_.self_inflation_m);
  const Vector3& body = self.X_OB.origin.m;
  const CellIndex centre = cell_index(body.x(), body.y(), config_.cell_size_m);
  const PointMaker maker(image_, X_OC, config_, sensor_, ControlMap::corner(centre));
  const double max_z_O_m = body.z() + config_.max_height_above_body_m;
  ScanPoints points;
  for (std::int32_t v = 0; v < image_.height; ++v) {
    for (std::int32_t u = 0; u < image_.width; u += ScanPoints::kCount) {
      const std::int32_t count = std::min(image_.width - u, ScanPoints::kCount);
      maker.make(u, v, count, points);
      for (std::int32_t i = 0; i < count; ++i) {
        sort_in(points, static_cast<std::size_t>(i), image_.at(u + i, v), max_z_O_m, self_filter,
                report);
      }
    }
  }
}

void Mapper::sort_in(const ScanPoints& points, std::size_t i, std::size_t pixel, double max_z_O_m,
                     const SelfFilter& self_filter, IntegrationReport& report) {
  const auto depth = static_cast<double>(image_.z_m[pixel]);
  ++report.pixels;
  if (!(depth > 0) || depth > sensor_.max_range_m) {
    ++report.no_depth;
  } else if (image_.mixed[pixel] != 0) {
    ++report.mixed;
  } else if (points.z_O_m[i] > max_z_O_m) {
    ++report.too_high;
  } else if (self_filter.covers(Vector3(points.x_O_m[i], points.y_O_m[i], points.z_O_m[i]))) {
    ++report.self;
  } else if (points.place[i] < 0) {
    ++report.outside;
  } else {
    const CellPoint point{points.z_O_m[i], points.variance_m2[i], points.weight[i],
                          points.shared_variance_m2[i]};
    const double gate2 = math::square(config_.gate_sigma);
    if (ok(scan_.add(static_cast<std::uint32_t>(points.place[i]), point, gate2))) ++report.points;
  }
}

void Mapper::fuse(std::uint32_t now_ms, IntegrationReport& report) {
  const double gate2 = math::square(config_.gate_sigma);
  const double least = math::square(config_.min_sigma_m);
  const double most = math::square(config_.max_sigma_m);
  report.cells_hit = static_cast<std::uint32_t>(scan_.size());
  const ControlMap::Places places(map_);
  for (std::size_t i = 0; i < scan_.size(); ++i) {
    const ScanCell& hit = scan_[i];
    MapCell& cell = places.at(hit.place);
    const double height = hit.height_m();
    const double variance = std::min(hit.variance_m2(), most);
    const MapCell fresh{.height_m = static_cast<float>(height),
                        .variance_m2 = static_cast<float>(std::max(variance, least)),
                        .stamp_ms = now_ms,
                        .state = CellState::kMeasured};
    if (cell.state != CellState::kMeasured) {
      cell = fresh;
      ++report.cells_new;
      continue;
    }
    const double age_s = 1e-3 * static_cast<double>(now_ms - cell.stamp_ms);
    const double prior =
        std::min(static_cast<double>(cell.variance_m2) + config_.process_noise_m2_s * age_s, most);
    const double innovation = height - static_cast<double>(cell.height_m);
    if (innovation * innovation <= gate2 * (prior + variance)) {
      const double gain = prior / (prior + variance);
      cell.height_m = static_cast<float>(static_cast<double>(cell.height_m) + gain * innovation);
      cell.variance_m2 = static_cast<float>(std::max((1.0 - gain) * prior, least));
      cell.stamp_ms = now_ms;
      cell.candidate_mm = 0;
      cell.confirmations = 0;
      cell.misses = 0;
      ++report.cells_fused;
      continue;
    }
    const double agreement = innovation - 1e-3 * cell.candidate_mm;
    const bool agrees = cell.confirmations > 0 && agreement * agreement <= 2.0 * gate2 * variance;
    cell.confirmations = static_cast<std::uint8_t>((agrees ? cell.confirmations + 1 : 1) & 0xF);
    cell.candidate_mm = to_mm(innovation);
    if (cell.confirmations <
        (innovation > 0 ? config_.confirmations_up : config_.confirmations_down)) {
      ++report.cells_pending;
    } else {
      cell = fresh;
      ++report.cells_replaced;
    }
  }
}

Status Mapper::forget(double x_O_m, double y_O_m, double half_side_m) {
  if (!configured_) return Status::kUnavailable;
  if (!math::is_finite(x_O_m) || !math::is_finite(y_O_m)) return Status::kInvalid;
  if (!(half_side_m >= 0 && half_side_m <= 5)) return Status::kInvalid;
  if (!mapping::is_mappable(x_O_m) || !mapping::is_mappable(y_O_m)) return Status::kOutOfRange;
  const double size = config_.cell_size_m;
  const CellIndex low = cell_index(x_O_m - half_side_m, y_O_m - half_side_m, size);
  const CellIndex high = cell_index(x_O_m + half_side_m, y_O_m + half_side_m, size);
  for (std::int32_t iy = low.iy; iy <= high.iy; ++iy) {
    for (std::int32_t ix = low.ix; ix <= high.ix; ++ix) {
      MapCell* cell = map_.find({ix, iy});
      if (cell != nullptr) *cell = MapCell{};
    }
  }
  return Status::kOk;
}

Status Mapper::publish(double x_O_m, double y_O_m, MapWindow& out) {
  if (!configured_) return Status::kUnavailable;
  if (!math::is_finite(x_O_m) || !math::is_finite(y_O_m)) return Status::kInvalid;
  if (!mapping::is_mappable(x_O_m) || !mapping::is_mappable(y_O_m)) return Status::kOutOfRange;
  classifier_.run(map_, cell_index(x_O_m, y_O_m, config_.cell_size_m), out);
  out.stamp = stamp_;
  out.frames = frames_;
  out.cell_size_m = config_.cell_size_m;
  return Status::kOk;
}

std::uint64_t Mapper::digest() const {
  Fnv64 hash;
  map_.add_to(hash);
  hash.word(static_cast<std::uint64_t>(stamp_.ns), 8);
  hash.word(frames_, 8);
  return hash.value();
}

}  // namespace surefoot::mapping
