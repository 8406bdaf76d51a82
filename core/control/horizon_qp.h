// The quadratic program of the predictive controller: forces of all feet over the horizon.
//
//   minimise  1/2 f' (Q' W Q + effort I) f + (Q' h)' f
//   subject to, per step and foot:  |fx| <= mu fz, |fy| <= mu fz, low <= fz <= high
//
// Q holds, for every step, six orthonormal (or zero) rows: the directions in force space that move
// the body. However many feet stand, only 6 of a step's 12 directions cost more than effort, so the
// linear system to solve has 60 unknowns, not 120.
//
// ADMM with the split on a copy of the forces that is projected exactly onto the pyramids (Boyd et
// al. 2011, section 5.2), over-relaxed (section 3.4.3), with c = effort + penalty:
//
//   (Q' W Q + c I)^-1 = (I - Q'Q) / c + Q' N Q,   N = (W + c I)^-1
//
// N is formed once per call in double; the iterations run in float. The number of operations does
// not depend on the data. A foot that does not stand has low = high = 0 and zero columns in Q, and
// its force stays exactly zero. The copy that is returned is feasible after any iteration.
//
// Memory: 60 kB, all in members. Layout: index 0..59 = component * kHorizon + step; arrays over
// steps are padded to kStride, and the padding is zero.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::control {

class HorizonQp {
 public:
  static constexpr std::size_t kHorizon = 10;
  static constexpr std::size_t kStride = 12;  // steps padded to whole vectors of four floats
  static constexpr std::size_t kComponents = 6;
  static constexpr std::size_t kFeet = 4;
  static constexpr std::size_t kAxes = 3 * kFeet;  // fx, fy, fz of foot 0, of foot 1, ...
  static constexpr std::size_t kUnknowns = kComponents * kHorizon;
  static constexpr int kIterations = 100;

  using Lane = std::array<float, kStride>;  // one number per step
  using Forces = std::array<Lane, kAxes>;

  struct Problem {
    std::array<std::array<double, kUnknowns>, kUnknowns> w;  // symmetric, positive semidefinite
    std::array<double, kUnknowns> h;
    std::array<Forces, kComponents> q;
    std::array<Lane, kFeet> low_N;
    std::array<Lane, kFeet> high_N;
    double effort = 0;
    double friction = 0;
  };

  // Filled by the caller before solve(), which overwrites w.
  Problem& problem() { return problem_; }

  // Forgets the last solution.
  void reset();
  // Moves the last solution `steps` towards the present; its last step is repeated.
  void shift(std::size_t steps);
  void solve();

  const Forces& forces_N() const { return split_; }
  // Largest difference of the two copies, or of the last two iterates: 0 at the solution.
  double residual_N() const { return residual_N_; }

 private:
  using Rows = std::array<Lane, kComponents>;

  void invert();
  void prepare(double penalty);
  void update_forces(float share);
  void update_split();

  Problem problem_{};
  std::array<std::array<float, kComponents * kStride>, kUnknowns>
      map_{};       // share (I - c N), columns
  Rows offset_{};   // N h
  Forces split_{};  // feasible copy, kept as warm start
  Forces dual_{};
  Forces start_{};   // split - dual
  Forces forces_{};  // the copy that minimises
  double residual_N_ = 0;
};

}  // namespace surefoot::control
