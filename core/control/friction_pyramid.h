// The set of forces that a foot can take without slipping, and the nearest point of it.
#pragma once

#include "core/math/elementary.h"

namespace surefoot::control {

// { |x| <= mu z, |y| <= mu z }: inside the friction cone of mu sqrt(2), touching that of mu.
template <class T>
struct FrictionPyramid {
  explicit constexpr FrictionPyramid(T friction)
      : mu(friction),
        one_side(T(1) / (T(1) + friction * friction)),
        two_sides(T(1) / (T(1) + T(2) * friction * friction)) {}

  // Moves (x, y, z) to the nearest point of the pyramid with low <= z <= high; exact, 0 <= low.
  //
  // For a given z the nearest x and y are clamped to +-mu z. What is left is convex in z, and its
  // derivative is the least of three increasing lines: no side active, the larger one, both. The
  // root of the least is the largest root. No branches: arrays of feet vectorise.
  constexpr void project(T& x, T& y, T& z, T low, T high) const {
    const T ax = x < T(0) ? -x : x;
    const T ay = y < T(0) ? -y : y;
    const T one = (z + mu * larger(ax, ay)) * one_side;
    const T two = (z + mu * (ax + ay)) * two_sides;
    z = math::clamp(larger(z, larger(one, two)), low, high);
    const T side = mu * z;
    x = math::clamp(x, -side, side);
    y = math::clamp(y, -side, side);
  }

  T mu;
  T one_side;
  T two_sides;

 private:
  static constexpr T larger(T a, T b) { return a > b ? a : b; }
};

}  // namespace surefoot::control
