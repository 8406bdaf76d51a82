#include "core/mapping/scan_points.h"

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

// Added and taken away, this leaves the nearest whole number: from 2^52 on a double has no smaller
// digits.
constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52

// cell_coordinate() of both lanes. The nearest whole number to x / size is the cell's or the next
// one's, even where the quotient is a little off.
DoubleLanes coordinates(DoubleLanes x_m, double size_m, double inverse_size_1_m) {
  const DoubleLanes nearest = (x_m * inverse_size_1_m + kRounder) - kRounder;
  return nearest + __builtin_convertvector(nearest * size_m > x_m, DoubleLanes);
}

}  // namespace

PointMaker::PointMaker(const DepthImage& image, const CameraPose& X_OC, const MappingConfig& config,
                       const DepthSensorModel& sensor, CellIndex first)
    : image_(image),
      X_OC_(X_OC),
      size_m_(config.cell_size_m),
      inverse_size_1_m_(1.0 / config.cell_size_m),
      first_x_(first.ix),
      first_y_(first.iy),
      max_range_m_(sensor.max_range_m),
      inverse_depth_sigma_per_m_(sensor.inverse_depth_sigma_per_m),
      floor_variance_m2_(math::square(config.depth_noise_floor_m)),
      attitude_variance_rad2_(math::square(config.attitude_noise_rad)),
      least_variance_m2_(math::square(config.min_sigma_m)) {}

DoubleLanes PointMaker::place(DoubleLanes x_O_m, DoubleLanes y_O_m) const {
  const DoubleLanes column = coordinates(x_O_m, size_m_, inverse_size_1_m_) - first_x_;
  const DoubleLanes row = coordinates(y_O_m, size_m_, inverse_size_1_m_) - first_y_;
  const DoubleMask inside =
      (column >= 0.0) & (column < 1.0 * kMapSide) & (row >= 0.0) & (row < 1.0 * kMapSide);
  return inside ? column + row * (1.0 * kMapSide) : all_lanes(-1.0);
}

void PointMaker::make(std::int32_t u, std::int32_t v, std::int32_t count, ScanPoints& out) const {
  const Matrix3& R_OC = X_OC_.rotation.matrix;
  const Vector3& camera = X_OC_.origin.m;
  const Vector3 row = R_OC.col(1) * image_.down[static_cast<std::size_t>(v)] + R_OC.col(2);
  const double* across_from = image_.across.data() + u;
  const float* depth_from = image_.z_m.data() + image_.at(u, v);
  const float* noise_from = image_.has_noise ? image_.noise.data() + image_.at(u, v) : nullptr;
  for (std::int32_t i = 0; i < count; i += kDoubleLanes) {
    const DoubleLanes across = load_lanes(across_from + i);
    const DoubleLanes measured = load_widened(depth_from + i);
    // Too far is as good as nothing: the numbers below stay small.
    const DoubleLanes depth = from_bits(bits(measured) & (measured <= max_range_m_));
    const DoubleLanes offset_x = (R_OC(0, 0) * across + row.x()) * depth;
    const DoubleLanes offset_y = (R_OC(1, 0) * across + row.y()) * depth;
    const DoubleLanes direction_z = R_OC(2, 0) * across + row.z();
    const DoubleLanes x = camera.x() + offset_x;
    const DoubleLanes y = camera.y() + offset_y;
    DoubleLanes depth_sigma = depth * depth * inverse_depth_sigma_per_m_;
    if (noise_from != nullptr) depth_sigma = depth_sigma * load_widened(noise_from + i);
    const DoubleLanes depth_variance = depth_sigma * depth_sigma + floor_variance_m2_;
    const DoubleLanes variance = depth_variance * (direction_z * direction_z) + 1e-8;
    const DoubleLanes range2 = offset_x * offset_x + offset_y * offset_y;
    const auto k = static_cast<std::size_t>(i);
    store_lanes(x, &out.x_O_m[k]);
    store_lanes(y, &out.y_O_m[k]);
    store_lanes(camera.z() + direction_z * depth, &out.z_O_m[k]);
    store_lanes(variance, &out.variance_m2[k]);
    store_lanes(1.0 / variance, &out.weight[k]);
    store_lanes(attitude_variance_rad2_ * range2 + least_variance_m2_, &out.shared_variance_m2[k]);
    store_lanes(place(x, y), &out.place[k]);
  }
}

}  // namespace surefoot::mapping
