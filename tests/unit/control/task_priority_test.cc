#include "core/control/task_priority.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include <Eigen/Dense>

#include "core/base/random.h"
#include "tests/support/samples.h"

namespace surefoot::control {
namespace {

Eigen::MatrixXd full_rows(const TaskRows& task) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3, 18);
  j.leftCols<6>() = task.trunk;
  if (task.leg != TaskRows::kNoLeg) {
    j.middleCols<3>(robot::velocity_row(task.leg)) = task.joints;
  }
  return j;
}

// Weighted pseudo-inverse by singular values: W^1/2 (J W^1/2)^+.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& j, const Eigen::MatrixXd& root) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(j * root, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-7);
  return root * svd.solve(Eigen::MatrixXd::Identity(j.rows(), j.rows()));
}

robot::MassMatrix random_metric(Random& random) {
  robot::MassMatrix a;
  for (int i = 0; i < 18; ++i) {
    for (int j = 0; j < 18; ++j) a(i, j) = random.normal();
  }
  return a * a.transpose() + robot::MassMatrix::Identity();
}

// The recursion of the paper, literally, with as many tasks as there are dimensions and a conflict
// among them: four feet, two trunk tasks, and two feet again with other targets, which must lose.
TEST(TaskPriority, IsTheRecursionOfThePaper) {
  Random random(1);
  double worst = 0;
  int compared = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const robot::MassMatrix metric =
        trial % 2 == 0 ? robot::MassMatrix(robot::MassMatrix::Identity()) : random_metric(random);
    const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(metric).matrixL();
    TaskPriority priority;
    priority.reset(metric, 1e-6);
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(18, 2);
    Eigen::MatrixXd n = Eigen::MatrixXd::Identity(18, 18);
    std::array<TaskRows, 8> tasks;
    const std::size_t count = 3 + random.below(6);
    for (std::size_t k = 0; k < count; ++k) {
      TaskRows& task = tasks[k];
      if (k < 4 || k >= 6) task.leg = k % 4;
      if (k >= 6) {
        task = tasks[k - 6];
      } else {
        for (int i = 0; i < 18; ++i) task.trunk(i / 6, i % 6) = random.normal();
        for (int i = 0; i < 9; ++i) task.joints(i / 3, i % 3) = random.normal();
      }
      TaskPriority::Targets targets;
      for (int i = 0; i < 6; ++i) targets(i / 2, i % 2) = random.normal();
      priority.add(task, targets);
      if (k >= 6) continue;  // nothing is left of its directions: the paper's x stays
      const Eigen::MatrixXd j = full_rows(task);
      const Eigen::MatrixXd inverse = pseudo_inverse(j * n, root);
      x += inverse * (targets - j * x);
      n = n * (Eigen::MatrixXd::Identity(18, 18) - inverse * j * n);
    }
    if (priority.damped_rows() > 0) continue;  // the draw is nearly singular
    ++compared;
    worst = std::max(worst, (priority.solution() - x).norm() / (1.0 + x.norm()));
  }
  std::printf("worst relative difference %.1e in %d draws\n", worst, compared);
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(compared, 280);
}

// Towards a singular direction the answer is damped: at most about 1 / (2 sqrt(damping)) = 100.
TEST(TaskPriority, SingularDirectionsAreDampedAndClosed) {
  robot::MassMatrix metric;
  metric.setIdentity();
  for (const double sigma : {1e-1, 1e-2, 3e-3, 1e-4, 1e-9, 0.0}) {
    TaskPriority priority;
    priority.reset(metric, 1e-4);
    TaskRows task;
    task.leg = 1;
    task.joints = Vector3(0.3, 0.2, sigma).asDiagonal();
    TaskPriority::Targets targets = TaskPriority::Targets::Constant(0.01);
    priority.add(task, targets);
    const double step = priority.solution()(robot::velocity_row(1) + 2, 0);
    EXPECT_LE(step, 0.01 * 110) << sigma;
    if (sigma >= 1e-2) {
      EXPECT_NEAR(step * sigma, 0.01, 1e-12);
    }
    EXPECT_EQ(priority.damped_rows() > 0, sigma < 1e-2 && sigma > 1e-5);
  }
}

}  // namespace
}  // namespace surefoot::control
