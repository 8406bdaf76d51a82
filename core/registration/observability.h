// Which motions two clouds tell about, and which they do not: on a flat floor three of six, in a
// straight corridor five.
#pragma once

#include <array>

#include "core/registration/normal_equations.h"

namespace surefoot::registration {

// Eigenvalues in ascending order and unit eigenvectors (columns) of a symmetric matrix, by cyclic
// Jacobi rotations: at most kJacobiSweeps sweeps of 15.
inline constexpr int kJacobiSweeps = 12;
struct Eigen6 {
  Vector6 values = Vector6::Zero();
  Matrix6 vectors = Matrix6::Identity();
};
Eigen6 eigen_decomposition(const Matrix6& symmetric);

// The observed part of `equations`.
struct Observed {
  Matrix6 information = Matrix6::Zero();  // without the unobserved directions
  Vector6 gradient = Vector6::Zero();
  Matrix6 axes = Matrix6::Identity();  // eigenvectors, the directions, in u of NormalEquations
  std::array<bool, 6> open{};          // not observed
  int directions = 0;                  // observed ones, 0 to 6
};
Observed observed_part(const NormalEquations& equations, double min_information_ratio);

// What `covariance` tells about the open axes when nothing is known of the others: its marginal
// there, inverted; zero along the observed axes. `covariance` is positive definite.
Matrix6 open_information(const Matrix6& covariance, const Observed& observed);

// The inverse of a positive definite matrix. False: it is not.
bool invert(const Matrix6& matrix, Matrix6& out);

}  // namespace surefoot::registration
