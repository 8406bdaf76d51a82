#include "core/navigation/smoothing_spline.h"

namespace surefoot::navigation {

void SmoothingSpline::resize(std::size_t size) {
  SUREFOOT_ASSERT(size > 0 && size <= kMaxRawPoints);
  size_ = size;
}

void SmoothingSpline::set(std::size_t i, double x, const Vector2& value, double weight) {
  SUREFOOT_ASSERT(i < size_);
  x_[i] = x;
  values_[i] = value;
  weights_[i] = weight;
}

// Row i belongs to the inner knot i, 1 <= i <= size - 2. Q has three entries per column:
// 1 / h_i-1, -1 / h_i-1 - 1 / h_i, 1 / h_i.
void SmoothingSpline::assemble(double p) {
  const double bend = 6.0 * (1.0 - p);
  const auto h = [this](std::size_t i) { return x_[i + 1] - x_[i]; };
  for (std::size_t i = 1; i + 1 < size_; ++i) {
    const double before = 1.0 / h(i - 1);
    const double after = 1.0 / h(i);
    const double middle = -before - after;
    diagonal_[i] = bend * (before * before / weights_[i - 1] + middle * middle / weights_[i] +
                           after * after / weights_[i + 1]) +
                   p * 2.0 * (h(i - 1) + h(i));
    beside_[i] = 0;
    second_[i] = 0;
    if (i + 2 < size_) {
      const double next_after = 1.0 / h(i + 1);
      const double next_middle = -after - next_after;
      beside_[i] =
          bend * (middle * after / weights_[i] + after * next_middle / weights_[i + 1]) + p * h(i);
      if (i + 3 < size_) second_[i] = bend * after * next_after / weights_[i + 1];
    }
    bends_[i] = (values_[i + 1] - values_[i]) * after - (values_[i] - values_[i - 1]) * before;
  }
}

// L D L^T in place: diagonal_ becomes D, beside_ and second_ become L's columns.
void SmoothingSpline::solve() {
  const std::size_t last = size_ - 2;
  for (std::size_t i = 1; i <= last; ++i) {
    const double one = beside_[i] / diagonal_[i];
    const double two = second_[i] / diagonal_[i];
    if (i + 1 <= last) {
      diagonal_[i + 1] -= one * beside_[i];
      beside_[i + 1] -= one * second_[i];
      bends_[i + 1] -= bends_[i] * one;
    }
    if (i + 2 <= last) {
      diagonal_[i + 2] -= two * second_[i];
      bends_[i + 2] -= bends_[i] * two;
    }
    beside_[i] = one;
    second_[i] = two;
  }
  for (std::size_t i = last; i >= 1; --i) {
    bends_[i] /= diagonal_[i];
    if (i + 1 <= last) bends_[i] -= bends_[i + 1] * beside_[i];
    if (i + 2 <= last) bends_[i] -= bends_[i + 2] * second_[i];
  }
}

void SmoothingSpline::fit(double p) {
  bends_[0] = Vector2::Zero();
  bends_[size_ - 1] = Vector2::Zero();
  if (size_ < 3) {
    for (std::size_t i = 0; i < size_; ++i) fitted_[i] = values_[i];
    return;
  }
  assemble(p);
  solve();
  for (std::size_t i = 0; i < size_; ++i) {
    Vector2 jump = Vector2::Zero();  // (Q u)_i: change of u's slope at the knot
    if (i + 1 < size_) jump += (bends_[i + 1] - bends_[i]) / (x_[i + 1] - x_[i]);
    if (i > 0) jump -= (bends_[i] - bends_[i - 1]) / (x_[i] - x_[i - 1]);
    fitted_[i] = values_[i] - jump * (6.0 * (1.0 - p) / weights_[i]);
  }
  for (std::size_t i = 0; i < size_; ++i) bends_[i] *= 6.0 * p;
}

SmoothingSpline::Sample SmoothingSpline::at(double x, std::size_t& interval) const {
  if (size_ == 1) return {fitted_[0], Vector2::Zero(), Vector2::Zero()};
  while (interval + 2 < size_ && x > x_[interval + 1]) ++interval;
  const std::size_t i = interval;
  const double h = x_[i + 1] - x_[i];
  const double b = (x - x_[i]) / h;
  const double a = 1.0 - b;
  Sample sample;
  sample.value = fitted_[i] * a + fitted_[i + 1] * b +
                 (bends_[i] * (a * a * a - a) + bends_[i + 1] * (b * b * b - b)) * (h * h / 6.0);
  sample.slope =
      (fitted_[i + 1] - fitted_[i]) / h +
      (bends_[i + 1] * (3.0 * b * b - 1.0) - bends_[i] * (3.0 * a * a - 1.0)) * (h / 6.0);
  sample.bend = bends_[i] * a + bends_[i + 1] * b;
  return sample;
}

}  // namespace surefoot::navigation
