// Cubic smoothing spline after C. de Boor, A Practical Guide to Splines, chapter XIV (Reinsch): the
// f that minimises
//   p sum_i w_i (y_i - f(x_i))^2 + (1 - p) int f''(x)^2 dx
// is a natural cubic spline. With h_i = x_i+1 - x_i, Q^T the second divided differences, R the
// tridiagonal matrix of 2 (h_i-1 + h_i) and h_i, D^2 = diag(1 / w_i):
//   (6 (1 - p) Q^T D^2 Q + p R) u = Q^T y,   f(x_i) = y_i - 6 (1 - p) (D^2 Q u)_i,
//   f''(x_i) = 6 p u_i
// One matrix with two bands beside its diagonal, factored once (L D L^T) for both coordinates.
//
// In: knots x rising strictly, values, weights > 0, 0 < p < 1. Bounds: kMaxRawPoints knots, about
// 40 operations each. Fewer than three knots: the values themselves. No errors.
#pragma once

#include <array>
#include <cstddef>

#include "core/navigation/types.h"

namespace surefoot::navigation {

class SmoothingSpline {
 public:
  struct Sample {
    Vector2 value = Vector2::Zero();
    Vector2 slope = Vector2::Zero();
    Vector2 bend = Vector2::Zero();  // second derivative
  };

  // Knots, values and weights are set before fit().
  void resize(std::size_t size);
  void set(std::size_t i, double x, const Vector2& value, double weight);
  void fit(double p);

  std::size_t size() const { return size_; }
  double first_x() const { return x_[0]; }
  double last_x() const { return x_[size_ - 1]; }
  const Vector2& knot_value(std::size_t i) const { return fitted_[i]; }
  // `interval` is a hint that is moved along while x does not fall; start at 0.
  Sample at(double x, std::size_t& interval) const;

 private:
  void assemble(double p);
  void solve();

  std::size_t size_ = 0;
  std::array<double, kMaxRawPoints> x_{};
  std::array<Vector2, kMaxRawPoints> values_;
  std::array<double, kMaxRawPoints> weights_{};
  std::array<Vector2, kMaxRawPoints> fitted_;
  std::array<Vector2, kMaxRawPoints> bends_;  // u, then f''
  std::array<double, kMaxRawPoints> diagonal_{};
  std::array<double, kMaxRawPoints> beside_{};
  std::array<double, kMaxRawPoints> second_{};
};

}  // namespace surefoot::navigation
