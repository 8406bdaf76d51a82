#include "core/mapping/mapping_config.h"

#include "core/math/elementary.h"

namespace surefoot::mapping {

DepthSensorModel sensor_model(const robot::DepthCameraSpecification& camera) {
  const double focal_px =
      0.5 * camera.native_width_px / math::tan(0.5 * camera.horizontal_view_rad);
  return {.inverse_depth_sigma_per_m = camera.disparity_noise_px / (focal_px * camera.baseline_m),
          .min_range_m = camera.min_range_m,
          .max_range_m = camera.max_range_m};
}

Status validate(const MappingConfig& config) {
  RangeCheck check;
  MappingConfig::describe(config, check);
  if (!check.good || config.max_sigma_m < config.min_sigma_m) return Status::kInvalid;
  return Status::kOk;
}

Status validate(const DepthSensorModel& sensor) {
  const bool noise = sensor.inverse_depth_sigma_per_m >= 0 && sensor.inverse_depth_sigma_per_m <= 1;
  const bool ranges = sensor.min_range_m >= 0.01 && sensor.max_range_m <= 100 &&
                      sensor.min_range_m < sensor.max_range_m;
  return noise && ranges ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::mapping
