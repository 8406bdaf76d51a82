#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/registration/normal_equations.h"
#include "core/registration/observability.h"
#include "tests/support/registration_parts.h"

namespace surefoot::registration {
namespace {

Pair random_pair(Random& random) {
  Pair pair;
  for (int axis = 0; axis < 3; ++axis) pair.p_m[axis] = random.normal();
  for (int axis = 0; axis < 3; ++axis) pair.q_m[axis] = random.normal();
  pair.normal = tests::random_direction(random);
  return pair;
}

TEST(Equations, JacobianIsTheFiniteDifferenceOfThePaperResidual) {
  Random random(1);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Pair pair = random_pair(random);
    const Vector3 centre_m = 2.0 * tests::random_direction(random);
    const Vector6 row = jacobian(pair, centre_m);
    for (int k = 0; k < 6; ++k) {
      const auto residual = [&](double step) {
        Vector3 shift_m = Vector3::Zero();
        Vector3 turn_rad = Vector3::Zero();
        (k < 3 ? shift_m : turn_rad)[k % 3] = step;
        const Matrix3 R = geometry::to_matrix(geometry::from_rotation_vector(turn_rad));
        const Vector3 p_m = R * (pair.p_m - centre_m) + centre_m + shift_m;
        return (p_m - pair.q_m).dot(pair.normal);
      };
      EXPECT_NEAR(row[k], (residual(kStep) - residual(-kStep)) / (2 * kStep), 1e-8);
    }
    EXPECT_DOUBLE_EQ(residual_m(pair), (pair.p_m - pair.q_m).dot(pair.normal));
  }
}

TEST(Equations, SumsAreThoseOfTheScaledRows) {
  Random random(2);
  std::vector<Pair> pairs(50);
  std::vector<double> weights(50);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = random_pair(random);
    pairs[i].tilt_variance_rad2 = random.uniform(0, 0.1);
    weights[i] = i % 7 == 0 ? 0.0 : random.uniform(0.1, 2.0);
  }
  const NormalEquations sums = sum_up(pairs.data(), weights.data(), pairs.size());
  Matrix6 information = Matrix6::Zero();
  Matrix6 feigned = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Vector6 row = jacobian(pairs[i], sums.centre_m);
    row.tail<3>() /= sums.lever_m;
    information += weights[i] * row * row.transpose();
    gradient -= weights[i] * residual_m(pairs[i]) * row;
    // A tilt e of the normal changes the row by J(e); the sum over three unit tilts bounds it.
    for (int axis = 0; axis < 3; ++axis) {
      Pair tilted = pairs[i];
      tilted.normal = Vector3::Unit(axis);
      Vector6 change = jacobian(tilted, sums.centre_m);
      change.tail<3>() /= sums.lever_m;
      feigned += weights[i] * pairs[i].tilt_variance_rad2 * change * change.transpose();
    }
  }
  EXPECT_LT((sums.information - information).norm(), 1e-10);
  EXPECT_LT((sums.feigned - feigned).norm(), 1e-10);
  EXPECT_LT((sums.gradient - gradient).norm(), 1e-10);
}

TEST(Equations, OfNothingAreZero) {
  const NormalEquations none = sum_up(nullptr, nullptr, 0);
  EXPECT_EQ(none.information.norm(), 0.0);
  const Pair pair;
  const double weight = 0;
  EXPECT_EQ(sum_up(&pair, &weight, 1).information.norm(), 0.0);
}

TEST(Observability, EigenvaluesAreThoseOfEigen) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    Matrix6 root;
    for (int k = 0; k < 36; ++k) root(k / 6, k % 6) = random.normal();
    if (i % 3 == 0) root.col(i % 6).setZero();
    const Matrix6 a = root * root.transpose();
    const Eigen6 ours = eigen_decomposition(a);
    const Eigen::SelfAdjointEigenSolver<Matrix6> oracle(a);
    EXPECT_LT((ours.values - oracle.eigenvalues()).norm(), 1e-11 * a.norm());
    EXPECT_LT((ours.vectors * ours.values.asDiagonal() * ours.vectors.transpose() - a).norm(),
              1e-11 * a.norm());
    EXPECT_LT((ours.vectors.transpose() * ours.vectors - Matrix6::Identity()).norm(), 1e-12);
  }
}

TEST(Observability, EigenvaluesOfADiagonalAndOfZero) {
  Matrix6 a = Matrix6::Zero();
  EXPECT_EQ(eigen_decomposition(a).values.norm(), 0.0);
  a.diagonal() << 3, 1, 2, 1, 5, 4;
  const Eigen6 eigen = eigen_decomposition(a);
  for (int i = 0; i + 1 < 6; ++i) EXPECT_LE(eigen.values[i], eigen.values[i + 1]);
}

TEST(Observability, SplitsWhatNoiseCouldFeign) {
  NormalEquations equations;
  equations.information.diagonal() << 100, 90, 1.2, 80, 70, 0;
  equations.feigned = Matrix6::Identity();
  equations.gradient << 1, 2, 3, 4, 5, 6;
  const Observed observed = observed_part(equations, 1.3);
  EXPECT_EQ(observed.directions, 4);
  Vector6 kept;
  kept << 1, 2, 0, 4, 5, 0;
  EXPECT_LT((observed.gradient - kept).norm(), 1e-12);
  int open = 0;
  for (std::size_t k = 0; k < 6; ++k) open += observed.open[k] ? 1 : 0;
  EXPECT_EQ(open, 2);
  EXPECT_EQ(observed.information(2, 2), 0.0);
}

// What is known of height must not leak into a slightly turned open axis.
TEST(Observability, OpenInformationIsTheMarginal) {
  Matrix6 covariance = Matrix6::Identity();
  covariance(0, 0) = 4.0;
  covariance(2, 2) = 1e-6;
  Observed observed;
  observed.axes = Matrix6::Identity();
  observed.axes.topLeftCorner<3, 3>() = geometry::from_roll_pitch_yaw(0, 0.05, 0);
  observed.open[0] = true;
  observed.directions = 5;
  const Matrix6 information = open_information(covariance, observed);
  const Vector6 axis = observed.axes.col(0);
  EXPECT_NEAR(axis.dot(information * axis), 1.0 / axis.dot(covariance * axis), 1e-9);
  EXPECT_NEAR(information.trace(), axis.dot(information * axis), 1e-9);
  Matrix6 inverse;
  ASSERT_TRUE(invert(covariance, inverse));
  EXPECT_LT((inverse * covariance - Matrix6::Identity()).norm(), 1e-9);
  EXPECT_FALSE(invert(-covariance, inverse));
}

}  // namespace
}  // namespace surefoot::registration
