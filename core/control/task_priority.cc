#include "core/control/task_priority.h"

namespace surefoot::control {
namespace {

// Pivots below this share of `singular` are rounding: nothing is left in that direction.
constexpr double kNothingLeft = 1e-6;
constexpr double kDamping = 0.25;  // of `singular`, at pivot 0

}  // namespace

void TaskPriority::reset(const robot::MassMatrix& metric, double singular) {
  room_ = metric;
  x_.setZero();
  singular_ = singular;
  damped_rows_ = 0;
}

double TaskPriority::gain(double pivot) {
  if (pivot >= singular_) return 1.0 / pivot;
  ++damped_rows_;
  const double share = 1.0 - pivot / singular_;
  return 1.0 / (pivot + kDamping * singular_ * share * share);
}

void TaskPriority::add(const TaskRows& task, const Targets& targets) {
  using Columns = Eigen::Matrix<double, robot::kVelocities, 3>;
  const bool has_leg = task.leg != TaskRows::kNoLeg;
  const Eigen::Index row = has_leg ? robot::velocity_row(task.leg) : 6;
  Columns g = room_.leftCols<6>() * task.trunk.transpose();  // P J'
  if (has_leg) g += room_.middleCols<3>(row) * task.joints.transpose();
  Matrix3 d = task.trunk * g.topRows<6>();  // J P J'
  Targets error = targets - task.trunk * x_.topRows<6>();
  if (has_leg) {
    d += task.joints * g.middleRows<3>(row);
    error -= task.joints * x_.middleRows<3>(row);
  }
  bool open[3] = {true, true, true};
  for (int pass = 0; pass < 3; ++pass) {
    int p = -1;
    for (int i = 0; i < 3; ++i) {
      if (open[i] && (p < 0 || d(i, i) > d(p, p))) p = i;
    }
    open[p] = false;
    const double pivot = d(p, p);
    if (!(pivot > kNothingLeft * singular_)) break;
    const Eigen::Matrix<double, 1, kTargets> step = error.row(p) * gain(pivot);
    const Eigen::Matrix<double, robot::kVelocities, 1> column = g.col(p);
    x_ += column * step;
    for (int i = 0; i < 3; ++i) {
      if (!open[i]) continue;
      const double factor = d(i, p) / pivot;
      error.row(i) -= d(i, p) * step;
      g.col(i) -= factor * column;
      for (int j = 0; j < 3; ++j) {
        if (open[j]) d(i, j) -= factor * d(p, j);
      }
    }
    const Eigen::Matrix<double, robot::kVelocities, 1> scaled = column * (1.0 / pivot);
    for (int j = 0; j < robot::kVelocities; ++j) room_.col(j) -= column * scaled[j];
  }
}

}  // namespace surefoot::control
