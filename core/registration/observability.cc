#include "core/registration/observability.h"

#include <cstddef>

#include <Eigen/Cholesky>

#include "core/math/elementary.h"

namespace surefoot::registration {
namespace {

// Eigenvalues below this share of the largest are rounding.
constexpr double kRounding = 1e-10;

// Makes a(p, q) zero.
void rotate(Matrix6& a, Matrix6& vectors, int p, int q) {
  const double off = a(p, q);
  if (off == 0) return;
  const double theta = (a(q, q) - a(p, p)) / (2.0 * off);
  const double root = math::sqrt(theta * theta + 1.0);
  const double tangent = theta >= 0 ? 1.0 / (theta + root) : 1.0 / (theta - root);
  const double cosine = 1.0 / math::sqrt(tangent * tangent + 1.0);
  const double sine = tangent * cosine;
  for (int k = 0; k < 6; ++k) {
    const double left = a(k, p);
    const double right = a(k, q);
    a(k, p) = cosine * left - sine * right;
    a(k, q) = sine * left + cosine * right;
  }
  for (int k = 0; k < 6; ++k) {
    const double upper = a(p, k);
    const double lower = a(q, k);
    a(p, k) = cosine * upper - sine * lower;
    a(q, k) = sine * upper + cosine * lower;
    const double left = vectors(k, p);
    const double right = vectors(k, q);
    vectors(k, p) = cosine * left - sine * right;
    vectors(k, q) = sine * left + cosine * right;
  }
}

double off_diagonal(const Matrix6& a) {
  double sum = 0;
  for (int p = 0; p < 6; ++p) {
    for (int q = p + 1; q < 6; ++q) sum += a(p, q) * a(p, q);
  }
  return sum;
}

}  // namespace

Eigen6 eigen_decomposition(const Matrix6& symmetric) {
  Matrix6 a = symmetric;
  Eigen6 out;
  const double enough = 1e-30 * a.diagonal().squaredNorm();
  for (int sweep = 0; sweep < kJacobiSweeps && off_diagonal(a) > enough; ++sweep) {
    for (int p = 0; p < 6; ++p) {
      for (int q = p + 1; q < 6; ++q) rotate(a, out.vectors, p, q);
    }
  }
  out.values = a.diagonal();
  for (int i = 0; i < 6; ++i) {  // selection sort: the first of equals stays first
    int least = i;
    for (int k = i + 1; k < 6; ++k) {
      if (out.values[k] < out.values[least]) least = k;
    }
    if (least == i) continue;
    const double value = out.values[i];
    out.values[i] = out.values[least];
    out.values[least] = value;
    const Vector6 vector = out.vectors.col(i);
    out.vectors.col(i) = out.vectors.col(least);
    out.vectors.col(least) = vector;
  }
  return out;
}

Observed observed_part(const NormalEquations& equations, double min_information_ratio) {
  const Eigen6 eigen = eigen_decomposition(equations.information);
  const double rounding = kRounding * eigen.values[5];
  Observed out;
  out.axes = eigen.vectors;
  for (int i = 0; i < 6; ++i) {
    const Vector6 axis = eigen.vectors.col(i);
    const double feigned = axis.dot(Vector6(equations.feigned * axis));
    const double value = eigen.values[i];
    if (value > rounding && value > min_information_ratio * feigned) {
      ++out.directions;
      out.information += value * axis * axis.transpose();
      out.gradient += axis.dot(equations.gradient) * axis;
    } else {
      out.open[static_cast<std::size_t>(i)] = true;
    }
  }
  return out;
}

bool invert(const Matrix6& matrix, Matrix6& out) {
  const Eigen::LLT<Matrix6> cholesky(matrix);
  if (cholesky.info() != Eigen::Success) return false;
  // Column by column: Eigen's solver for many right-hand sides would allocate.
  for (int k = 0; k < 6; ++k) out.col(k) = cholesky.solve(Vector6(Vector6::Unit(k)));
  return true;
}

Matrix6 open_information(const Matrix6& covariance, const Observed& observed) {
  Matrix6 marginal = observed.axes.transpose() * Matrix6(covariance * observed.axes);
  const auto is_open = [&observed](int i) { return observed.open[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) {
      if (!is_open(i) || !is_open(k)) marginal(i, k) = i == k ? 1.0 : 0.0;
    }
  }
  Matrix6 inverse = Matrix6::Zero();
  if (!invert(marginal, inverse)) return Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    if (!is_open(i)) inverse(i, i) = 0.0;
  }
  return observed.axes * Matrix6(inverse * observed.axes.transpose());
}

}  // namespace surefoot::registration
