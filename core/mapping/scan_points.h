// The points of a depth image in O with their noise and their cells, two pixels at a time.
#pragma once

#include <array>
#include <cstdint>

#include "core/mapping/depth_image.h"
#include "core/mapping/integration.h"
#include "core/mapping/mapping_config.h"
#include "core/math/lanes.h"

namespace surefoot::mapping {

// Neighbours in a row. Entries of pixels without a usable depth are finite and mean nothing.
struct ScanPoints {
  static constexpr std::int32_t kCount = 16;
  static_assert(kCount % kDoubleLanes == 0);
  using Numbers = std::array<double, kCount>;

  alignas(16) Numbers x_O_m;
  alignas(16) Numbers y_O_m;
  alignas(16) Numbers z_O_m;
  alignas(16) Numbers variance_m2;         // of the height, independent of other points
  alignas(16) Numbers weight;              // 1 / variance
  alignas(16) Numbers shared_variance_m2;  // of the height, common to points of a cell
  alignas(16) Numbers place;               // column + row * kMapSide; -1: beyond the map
};

class PointMaker {
 public:
  // first: the map's cell with the smallest indices. All references must outlive this.
  PointMaker(const DepthImage& image, const CameraPose& X_OC, const MappingConfig& config,
             const DepthSensorModel& sensor, CellIndex first);
  // Pixels u to u + count - 1 of row v, count <= ScanPoints::kCount.
  void make(std::int32_t u, std::int32_t v, std::int32_t count, ScanPoints& out) const;

 private:
  DoubleLanes place(DoubleLanes x_O_m, DoubleLanes y_O_m) const;

  const DepthImage& image_;
  const CameraPose& X_OC_;
  double size_m_;
  double inverse_size_1_m_;
  double first_x_;
  double first_y_;
  double max_range_m_;
  double inverse_depth_sigma_per_m_;
  double floor_variance_m2_;
  double attitude_variance_rad2_;
  double least_variance_m2_;
};

}  // namespace surefoot::mapping
