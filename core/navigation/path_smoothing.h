// From the searched polyline to the path that is walked, and to the over-smoothed one (paper 003,
// III-B.4).
//
// Both coordinates are smoothed over the polyline's arc length (smoothing_spline.h). p follows from
// the wavelength that is halved: (1 - p) / p = (wavelength / 2 pi)^4 / spacing. Start and end are
// held by weights. Where the result touches a lethal cell that the polyline does not, the
// weights nearby grow 16-fold, at most kTries times; then the polyline itself is kept.
//
// Frame: O, m. Bounds: kMaxRawPoints points in, kMaxPathPoints samples out (the far end is left
// out). Errors: none; an empty polyline gives an empty path.
#pragma once

#include "core/navigation/config.h"
#include "core/navigation/cost_map.h"
#include "core/navigation/smoothing_spline.h"

namespace surefoot::navigation {

struct SmoothingResult {
  std::uint32_t tries = 0;  // fits
  bool raw = false;         // the polyline was kept
};

class PathSmoothing {
 public:
  void reset(const ShapeConfig& config) { config_ = config; }

  SmoothingResult smooth(const CostMap& map, const RawPath& raw_O_m, Path& path);
  // After smooth(). Not checked for collisions: it only discounts cells.
  void over_smooth(const RawPath& raw_O_m, RawPath& path_O_m);

 private:
  static constexpr std::uint32_t kTries = 4;

  void load(const RawPath& raw_O_m);
  void fit(double wavelength_m);
  void sample(Path& path) const;
  bool hold_where_touching(const CostMap& map, const Path& path);

  ShapeConfig config_;
  SmoothingSpline spline_;
  std::array<double, kMaxRawPoints> weights_{};
  std::array<double, kMaxRawPoints> along_m_{};
  RawPath points_O_m_;
};

}  // namespace surefoot::navigation
