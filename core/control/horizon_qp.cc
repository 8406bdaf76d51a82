#include "core/control/horizon_qp.h"

#include "core/control/friction_pyramid.h"

namespace surefoot::control {
namespace {

// In units of effort. Small values leave the stiff directions slow, large ones those that only
// effort decides; measured in tests/unit/control.
constexpr double kPenaltyOverEffort = 8.0;
constexpr float kOverRelaxation = 1.8f;

constexpr std::size_t kUnknowns = HorizonQp::kUnknowns;
constexpr std::size_t kRow = HorizonQp::kComponents * HorizonQp::kStride;

// target -= factor * source. Lengths are constants so that the compiler needs no remainder loop.
void subtract(double* __restrict target, const double* __restrict source, double factor) {
  for (std::size_t i = 0; i < kUnknowns; ++i) target[i] -= factor * source[i];
}

void add_columns(float* __restrict y, const float* __restrict columns, const float* x) {
  const float* __restrict a = columns;
  const float* __restrict b = columns + kRow;
  const float x0 = x[0];
  const float x1 = x[1];
  for (std::size_t i = 0; i < kRow; ++i) y[i] += a[i] * x0 + b[i] * x1;
}

float magnitude(float x) { return x < 0.0f ? -x : x; }

}  // namespace

void HorizonQp::reset() {
  for (Lane& lane : split_) lane.fill(0.0f);
  for (Lane& lane : dual_) lane.fill(0.0f);
}

void HorizonQp::shift(std::size_t steps) {
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (std::size_t step = 0; step < kHorizon; ++step) {
      const std::size_t from = step + steps < kHorizon ? step + steps : kHorizon - 1;
      split_[axis][step] = split_[axis][from];
      dual_[axis][step] = dual_[axis][from];
    }
  }
}

// W + c I to its inverse in place: Gauss-Jordan without pivoting, as the matrix is positive
// definite and well conditioned (below 1e4).
void HorizonQp::invert() {
  auto& a = problem_.w;
  for (std::size_t k = 0; k < kUnknowns; ++k) {
    const double scale = 1.0 / a[k][k];
    a[k][k] = 1.0;
    for (double& value : a[k]) value *= scale;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      if (i == k) continue;
      const double factor = a[i][k];
      a[i][k] = 0.0;
      subtract(a[i].data(), a[k].data(), factor);
    }
  }
}

void HorizonQp::prepare(double penalty) {
  const double c = problem_.effort + penalty;
  for (std::size_t i = 0; i < kUnknowns; ++i) problem_.w[i][i] += c;
  invert();
  const double share = penalty / c;
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    const auto& row = problem_.w[i];  // symmetric: the row is the column
    double sum = 0.0;
    map_[i].fill(0.0f);
    for (std::size_t component = 0; component < kComponents; ++component) {
      for (std::size_t step = 0; step < kHorizon; ++step) {
        const std::size_t j = component * kHorizon + step;
        sum += row[j] * problem_.h[j];
        const double identity = i == j ? 1.0 : 0.0;
        map_[i][component * kStride + step] = static_cast<float>(share * (identity - c * row[j]));
      }
    }
    offset_[i / kHorizon][i % kHorizon] = static_cast<float>(sum);
  }
}

// forces = share start - Q' (map Q start + offset)
void HorizonQp::update_forces(float share) {
  Rows seen{};
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (std::size_t step = 0; step < kStride; ++step) {
      start_[axis][step] = split_[axis][step] - dual_[axis][step];
    }
  }
  for (std::size_t row = 0; row < kComponents; ++row) {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      for (std::size_t step = 0; step < kStride; ++step) {
        seen[row][step] += problem_.q[row][axis][step] * start_[axis][step];
      }
    }
  }
  Rows answer = offset_;
  for (std::size_t row = 0; row < kComponents; ++row) {
    for (std::size_t step = 0; step < kHorizon; step += 2) {
      add_columns(answer[0].data(), map_[row * kHorizon + step].data(), &seen[row][step]);
    }
  }
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    Lane sum;
    for (std::size_t step = 0; step < kStride; ++step) sum[step] = share * start_[axis][step];
    for (std::size_t row = 0; row < kComponents; ++row) {
      for (std::size_t step = 0; step < kStride; ++step) {
        sum[step] -= problem_.q[row][axis][step] * answer[row][step];
      }
    }
    forces_[axis] = sum;
  }
}

void HorizonQp::update_split() {
  const FrictionPyramid<float> pyramid(static_cast<float>(problem_.friction));
  for (std::size_t foot = 0; foot < kFeet; ++foot) {
    Forces point;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t axis = 3 * foot + i;
      for (std::size_t step = 0; step < kStride; ++step) {
        point[i][step] = kOverRelaxation * forces_[axis][step] +
                         (1.0f - kOverRelaxation) * split_[axis][step] + dual_[axis][step];
      }
    }
    Lane& x = split_[3 * foot];
    Lane& y = split_[3 * foot + 1];
    Lane& z = split_[3 * foot + 2];
    for (std::size_t step = 0; step < kStride; ++step) {
      float px = point[0][step];
      float py = point[1][step];
      float pz = point[2][step];
      pyramid.project(px, py, pz, problem_.low_N[foot][step], problem_.high_N[foot][step]);
      x[step] = px;
      y[step] = py;
      z[step] = pz;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t axis = 3 * foot + i;
      for (std::size_t step = 0; step < kStride; ++step) {
        dual_[axis][step] = point[i][step] - split_[axis][step];
      }
    }
  }
}

void HorizonQp::solve() {
  const double penalty = kPenaltyOverEffort * problem_.effort;
  prepare(penalty);
  const auto share = static_cast<float>(penalty / (problem_.effort + penalty));
  // What the last solution had for feet that do not stand any more is no start for anything.
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (std::size_t step = 0; step < kStride; ++step) {
      if (problem_.high_N[axis / 3][step] > 0.0f) continue;
      split_[axis][step] = 0.0f;
      dual_[axis][step] = 0.0f;
    }
  }
  Forces before = split_;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (iteration == kIterations - 1) before = split_;
    update_forces(share);
    update_split();
  }
  float largest = 0.0f;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (std::size_t step = 0; step < kHorizon; ++step) {
      const float gap = magnitude(forces_[axis][step] - split_[axis][step]);
      const float move = magnitude(split_[axis][step] - before[axis][step]);
      if (!(gap <= largest)) largest = gap;
      if (!(move <= largest)) largest = move;
    }
  }
  residual_N_ = static_cast<double>(largest);
}

}  // namespace surefoot::control
