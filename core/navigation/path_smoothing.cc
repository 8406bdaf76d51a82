#include "core/navigation/path_smoothing.h"

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr double kEndWeight = 1000.0;
constexpr double kHold = 16.0;
constexpr double kHoldReach_m = 0.6;

}  // namespace

void PathSmoothing::load(const RawPath& raw_O_m) {
  points_O_m_.clear();
  for (const Vector2& p_O_m : raw_O_m) {
    if (!points_O_m_.empty() && (p_O_m - points_O_m_.back()).squaredNorm() < 1e-8) continue;
    static_cast<void>(points_O_m_.push_back(p_O_m));
  }
  for (std::size_t i = 0; i < points_O_m_.size(); ++i) {
    weights_[i] = i == 0 || i + 1 == points_O_m_.size() ? kEndWeight : 1.0;
    along_m_[i] =
        i == 0 ? 0.0
               : along_m_[i - 1] + math::sqrt((points_O_m_[i] - points_O_m_[i - 1]).squaredNorm());
  }
}

void PathSmoothing::fit(double wavelength_m) {
  const std::size_t size = points_O_m_.size();
  spline_.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    spline_.set(i, along_m_[i], points_O_m_[i], weights_[i]);
  }
  const double spacing_m = size > 1 ? along_m_[size - 1] / static_cast<double>(size - 1) : 1.0;
  const double ratio = math::square(math::square(wavelength_m / math::kTwoPi)) / spacing_m;
  spline_.fit(1.0 / (1.0 + ratio));
}

void PathSmoothing::sample(Path& path) const {
  path.clear();
  const double length_m = spline_.last_x();
  const std::int32_t steps = math::floor_of(length_m / config_.sample_m) + 1;
  std::size_t interval = 0;
  double along_m = 0;
  for (std::int32_t i = 0; i <= steps; ++i) {
    const SmoothingSpline::Sample sample = spline_.at(length_m * i / steps, interval);
    PathPoint point;
    point.p_O_m = sample.value;
    if (i > 0) along_m += math::sqrt((sample.value - path.back().p_O_m).squaredNorm());
    point.along_m = along_m;
    const double slope = math::sqrt(sample.slope.squaredNorm());
    if (slope > 1e-6) {
      point.tangent_O = sample.slope / slope;
      point.curvature_1_m = math::cross(sample.slope, sample.bend) / (slope * slope * slope);
    } else if (i > 0) {
      point.tangent_O = path.back().tangent_O;
    }
    if (!ok(path.push_back(point))) return;
  }
}

// true: it touched something, and the weights there have grown. A sample's knot is found by the
// parameter, not by the distance: paths come close to themselves.
bool PathSmoothing::hold_where_touching(const CostMap& map, const Path& path) {
  const double length_m = along_m_[points_O_m_.size() - 1];
  bool touches = false;
  double held_to_m = -1;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!map.lethal_at(path[i].p_O_m)) continue;
    const double at_m = length_m * static_cast<double>(i) / static_cast<double>(path.size() - 1);
    for (std::size_t k = 1; k + 1 < points_O_m_.size(); ++k) {
      if (along_m_[k] <= held_to_m || along_m_[k] < at_m - kHoldReach_m) continue;
      if (along_m_[k] > at_m + kHoldReach_m) break;
      if (map.lethal_at(points_O_m_[k])) continue;  // the polyline touches as well
      weights_[k] *= kHold;
      held_to_m = along_m_[k];
      touches = true;
    }
  }
  return touches;
}

SmoothingResult PathSmoothing::smooth(const CostMap& map, const RawPath& raw_O_m, Path& path) {
  SmoothingResult result;
  path.clear();
  load(raw_O_m);
  if (points_O_m_.empty()) return result;
  for (result.tries = 1; result.tries <= kTries; ++result.tries) {
    fit(config_.smoothing_m);
    sample(path);
    if (!hold_where_touching(map, path)) return result;
  }
  result.raw = true;
  for (std::size_t i = 1; i + 1 < points_O_m_.size(); ++i) weights_[i] = 1.0;
  fit(1e-3);  // the polyline itself, with its corners rounded within a cell
  sample(path);
  return result;
}

void PathSmoothing::over_smooth(const RawPath& raw_O_m, RawPath& path_O_m) {
  path_O_m.clear();
  load(raw_O_m);
  if (points_O_m_.empty()) return;
  fit(config_.over_smoothing_m);
  for (std::size_t i = 0; i < spline_.size(); ++i) {
    static_cast<void>(path_O_m.push_back(spline_.knot_value(i)));
  }
}

}  // namespace surefoot::navigation
