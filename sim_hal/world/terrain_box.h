// An upright box. World frame W, metres.
#pragma once

namespace surefoot::sim {

struct TerrainBox {
  double x_m = 0;  // centre
  double y_m = 0;
  double half_length_m = 0;  // along the box's own x
  double half_width_m = 0;
  double bottom_m = 0;
  double top_m = 0;
  double cos_yaw = 1;
  double sin_yaw = 0;

  bool covers(double x, double y) const {
    const double dx = x - x_m;
    const double dy = y - y_m;
    const double along = cos_yaw * dx + sin_yaw * dy;
    const double across = cos_yaw * dy - sin_yaw * dx;
    return along <= half_length_m && along >= -half_length_m && across <= half_width_m &&
           across >= -half_width_m;
  }
};

}  // namespace surefoot::sim
