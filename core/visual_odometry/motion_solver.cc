#include "core/visual_odometry/motion_solver.h"

#include <Eigen/Cholesky>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::visual_odometry {
namespace {

constexpr int kCleanSteps = 3;
constexpr double kHuber = 1.5;       // sigma
constexpr double kNearest_m = 0.02;  // a point nearer than this, or behind, is not seen
constexpr double kMinPivot = 1e-9;   // of the scaled information

struct Residual {
  Vector2 error_px = Vector2::Zero();
  Eigen::Matrix<double, 2, 6> jacobian = Eigen::Matrix<double, 2, 6>::Zero();
  Eigen::Matrix<double, 2, 2> information = Eigen::Matrix<double, 2, 2>::Zero();
  double chi2 = 0;
};

// False: behind the camera.
bool make_residual(const stereo::RectifiedPair& pair, const KeyframeView& view,
                   const Observation& observation, Residual& out) {
  const Vector3 turned = view.R_NK * observation.p_K_m;
  const Vector3 p = turned + view.t_NK_m;
  if (!(p.z() > kNearest_m)) return false;
  Eigen::Matrix<double, 2, 3> by_point;
  const double scale = pair.focal_px / p.z();
  by_point << scale, 0, -scale * p.x() / p.z(), 0, scale, -scale * p.y() / p.z();
  out.error_px = observation.seen_px - project(pair, p);
  out.jacobian.leftCols<3>() = by_point;
  out.jacobian.rightCols<3>() = -by_point * geometry::cross_matrix(p);
  // A disparity that is larger by one pixel brings the point nearer, along its ray.
  const Vector2 by_disparity = by_point * turned * (-1.0 / observation.disparity_px);
  Eigen::Matrix<double, 2, 2> covariance =
      by_disparity * observation.disparity_variance_px2 * by_disparity.transpose();
  covariance(0, 0) += observation.seen_variance_px2;
  covariance(1, 1) += observation.seen_variance_px2;
  out.information = covariance.inverse();
  out.chi2 = out.error_px.dot(out.information * out.error_px);
  return true;
}

struct Sums {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  std::size_t count = 0;
  double chi2 = 0;
  double squares_px2 = 0;
};

Sums sum_up(const stereo::RectifiedPair& pair, const KeyframeView& view, double gate_sigma,
            bool clean, Observations& observations) {
  Sums sums;
  for (Observation& observation : observations) {
    Residual residual;
    observation.inlier = make_residual(pair, view, observation, residual) &&
                         residual.chi2 <= math::square(gate_sigma);
    if (residual.chi2 == 0 && !observation.inlier) continue;
    if (clean && !observation.inlier) continue;
    double weight = 1;
    if (!clean && residual.chi2 > math::square(kHuber)) {
      weight = kHuber / math::sqrt(residual.chi2);
    }
    const Eigen::Matrix<double, 6, 2> weighted =
        weight * residual.jacobian.transpose() * residual.information;
    sums.information += weighted * residual.jacobian;
    sums.gradient += weighted * residual.error_px;
    ++sums.count;
    sums.chi2 += residual.chi2;
    sums.squares_px2 += residual.error_px.squaredNorm();
  }
  return sums;
}

bool step(const Sums& sums, KeyframeView& view) {
  if (sums.count < 3) return false;
  const Eigen::LDLT<Matrix6> factors(sums.information);
  const Vector6 pivots = factors.vectorD();
  if (!(pivots.minCoeff() > kMinPivot * pivots.maxCoeff())) return false;
  const Vector6 move = factors.solve(sums.gradient);
  if (!math::is_finite(move.squaredNorm()) || !(move.tail<3>().squaredNorm() < 1)) return false;
  const Matrix3 turn = geometry::to_matrix(geometry::from_rotation_vector(move.tail<3>()));
  view.R_NK = turn * view.R_NK;
  view.t_NK_m = turn * view.t_NK_m + move.head<3>();
  return true;
}

}  // namespace

Vector3 point_of(const stereo::RectifiedPair& pair, double u_px, double v_px, double disparity_px) {
  const double z = pair.focal_px * pair.baseline_m / disparity_px;
  return {(u_px - pair.cx_px) * z / pair.focal_px, (v_px - pair.cy_px) * z / pair.focal_px, z};
}

Vector2 project(const stereo::RectifiedPair& pair, const Vector3& p_N_m) {
  return {pair.cx_px + pair.focal_px * p_N_m.x() / p_N_m.z(),
          pair.cy_px + pair.focal_px * p_N_m.y() / p_N_m.z()};
}

bool solve_motion(const stereo::RectifiedPair& pair, const KeyframeView& start, double gate_sigma,
                  Observations& observations, Solution& out) {
  out.view = start;
  for (int i = 0; i < kSolverSteps; ++i) {
    const bool clean = i + kCleanSteps >= kSolverSteps;
    if (!step(sum_up(pair, out.view, gate_sigma, clean, observations), out.view)) return false;
  }
  // The products leave it a rotation only to rounding.
  out.view.R_NK = geometry::to_matrix(geometry::to_quaternion(out.view.R_NK));
  const Sums last = sum_up(pair, out.view, gate_sigma, true, observations);
  if (last.count < 3) return false;
  out.information = last.information;
  out.inliers = last.count;
  out.chi2 = last.chi2;
  out.residual_px = math::sqrt(last.squares_px2 / (2.0 * static_cast<double>(last.count)));
  return true;
}

}  // namespace surefoot::visual_odometry
