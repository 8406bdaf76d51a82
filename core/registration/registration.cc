#include "core/registration/registration.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/registration/observability.h"

namespace surefoot::registration {
namespace {

// A level ends when a step moves the points by less than this share of a cell. The coarse levels
// are only to bring the next one near enough.
constexpr double kConverged_cells = 3e-3;
constexpr double kConvergedCoarse_cells = 2e-2;
// Share of the cells that must have a surfel; where fewer have, the points are too few for cells of
// this size and the next wider ones are the finest used.
constexpr double kMinSurfels = 0.4;
// The threshold of observability is higher by this over the root of the number of pairs.
constexpr double kRatioNoise = 4.0;
constexpr double kRotationTolerance = 1e-6;
// How far partners may lie apart, in cells of the level.
constexpr double kReach_cells = 1.0;
// Median of |x| of a normal distribution, inverted.
constexpr double kMedianToSigma = 1.4826;

bool is_pose(const SourcePose& pose) {
  return math::is_finite(pose.origin.m.x()) && math::is_finite(pose.origin.m.y()) &&
         math::is_finite(pose.origin.m.z()) &&
         geometry::is_rotation(pose.rotation.matrix, kRotationTolerance);
}

// (displacement, rotation) that leads from `from` to `to`.
Vector6 motion(const SourcePose& from, const SourcePose& to) {
  Vector6 out;
  out << to.origin.m - from.origin.m,
      geometry::to_rotation_vector(to.rotation.matrix * from.rotation.matrix.transpose());
  return out;
}

SourcePose moved(const SourcePose& pose, const Vector6& u) {
  const geometry::Quaternion turn = geometry::from_rotation_vector(u.tail<3>());
  const geometry::Quaternion turned = turn * geometry::to_quaternion(pose.rotation.matrix);
  return {{geometry::to_matrix(geometry::normalised(turned))}, {pose.origin.m + u.head<3>()}};
}

bool is_prior(const Prior& prior) {
  return math::is_finite(prior.sigma_m) && prior.sigma_m > 0 && math::is_finite(prior.sigma_rad) &&
         prior.sigma_rad > 0 && is_pose(prior.X_TS);
}

Vector6 prior_information(const Prior& prior) {
  Vector6 diagonal;
  diagonal << Vector3::Constant(1.0 / math::square(prior.sigma_m)),
      Vector3::Constant(1.0 / math::square(prior.sigma_rad));
  return diagonal;
}

// The cell of `level` whose points' mean is nearest to p, among those that may have a surface. The
// lowest number of equals wins. kNone: none within reach.
std::uint16_t nearest_cell(const Cloud& target, int level, const Vector3& p_m) {
  double best_m2 = math::square(kReach_cells * target.cell_m(level));
  std::uint16_t best = Cloud::kNone;
  target.for_neighbours(level, target.place_of(level, p_m), [&](std::uint16_t cell) {
    if (target.has_no_surface(cell)) return;
    const double distance_m2 = (target.mean_m(cell) - p_m).squaredNorm();
    if (distance_m2 < best_m2 || (distance_m2 == best_m2 && cell < best)) {
      best_m2 = distance_m2;
      best = cell;
    }
  });
  return best;
}

}  // namespace

Status Aligner::configure(const RegistrationConfig& config) {
  const Status status = validate(config);
  if (!ok(status)) return status;
  config_ = config;
  min_normal_cosine_ = math::cos(config.max_normal_angle_rad);
  return Status::kOk;
}

// At most max_pairs cells, evenly over the level in the order of its points, which have a surfel.
std::size_t Aligner::choose_surfels(Cloud& source, int level) {
  const std::size_t first = source.first_cell(level);
  const std::size_t count = source.first_cell(level + 1) - first;
  const auto wanted = std::min(count, static_cast<std::size_t>(config_.max_pairs));
  chosen_count_ = 0;
  for (std::size_t i = 0; i < wanted; ++i) {
    const std::size_t cell = first + i * count / wanted;
    if (source.surfel(level, cell) == nullptr) continue;
    chosen_[chosen_count_++] = static_cast<std::uint16_t>(cell);
  }
  return chosen_count_;
}

void Aligner::find_pairs(Cloud& source, Cloud& target, int level) {
  const Matrix3& R_TS = X_TS_.rotation.matrix;
  const double floor_m2 = math::square(config_.surface_error * source.cell_m(level));
  pair_count_ = 0;
  double overlap = 0;
  for (std::size_t i = 0; i < chosen_count_; ++i) {
    const Surfel& from = *source.surfel(level, chosen_[i]);
    Pair pair;
    pair.p_m = R_TS * from.position_m + X_TS_.origin.m;
    const std::uint16_t cell = nearest_cell(target, level, pair.p_m);
    if (cell == Cloud::kNone) continue;
    const Surfel* const to = target.surfel(level, cell);
    if (to == nullptr) continue;
    const Vector3 normal = R_TS * from.normal;
    const double cosine = normal.dot(to->normal);
    if (math::magnitude(cosine) < min_normal_cosine_) continue;
    // The mean of both normals: exact for two pieces of one quadric, where the target's alone is
    // wrong by curvature times distance (Rusinkiewicz 2019).
    const Vector3 sum = cosine < 0 ? Vector3(to->normal - normal) : Vector3(to->normal + normal);
    pair.normal = sum / math::sqrt(sum.squaredNorm());
    pair.q_m = to->position_m;
    pair.variance_m2 = from.variance_m2 + to->variance_m2 + floor_m2;
    pair.tilt_variance_rad2 = 0.25 * (from.tilt_variance_rad2 + to->tilt_variance_rad2) +
                              math::square(config_.normal_error_rad);
    overlap += from.overlap;
    pairs_[pair_count_++] = pair;
  }
  overlap_factor_ = pair_count_ > 0 ? std::max(1.0, overlap / static_cast<double>(pair_count_)) : 1;
}

bool Aligner::within_gate(const Prior& prior) const {
  const Vector6 u = motion(prior.X_TS, X_TS_);
  return u.head<3>().squaredNorm() <= math::square(config_.gate_sigma * prior.sigma_m) &&
         u.tail<3>().squaredNorm() <= math::square(config_.gate_sigma * prior.sigma_rad);
}

// Geman and McClure's weight on residuals in units of their own robust deviation.
void Aligner::weigh() {
  for (std::size_t i = 0; i < pair_count_; ++i) {
    const double residual = residual_m(pairs_[i]);
    weights_[i] = residual * residual / pairs_[i].variance_m2;
    sorted_[i] = weights_[i];
  }
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(pair_count_ / 2);
  std::nth_element(sorted_.begin(), middle,
                   sorted_.begin() + static_cast<std::ptrdiff_t>(pair_count_));
  const double scale2 = std::max(1.0, math::square(kMedianToSigma) * *middle);
  const double outlier2 = scale2 * math::square(config_.outlier_sigma);
  double inverse = 0;
  for (std::size_t i = 0; i < pair_count_; ++i) {
    const double decay = 1.0 / (1.0 + weights_[i] / outlier2);
    inverse += 1.0 / pairs_[i].variance_m2;
    weights_[i] = decay * decay / (scale2 * pairs_[i].variance_m2);
  }
  residual_m_ = math::sqrt(scale2 * static_cast<double>(pair_count_) / inverse);
}

// In directions that this level does not observe, a wider one may have: what it gained on the prior
// there is kept, as a marginal, so that what it knows of other directions does not leak in.
void Aligner::keep_wider(const Prior& prior, const Matrix6& to_centre, Observed& observed) const {
  const Matrix6 prior_covariance = prior_information(prior).cwiseInverse().asDiagonal();
  const auto at_centre = [&to_centre](const Matrix6& covariance) {
    return Matrix6(to_centre * Matrix6(covariance * to_centre.transpose()));
  };
  const Matrix6 gain = open_information(at_centre(wider_covariance_), observed) -
                       open_information(at_centre(prior_covariance), observed);
  const Vector6 back = to_centre * motion(X_TS_, wider_X_TS_);
  observed.information += overlap_factor_ * gain;
  observed.gradient += overlap_factor_ * Vector6(gain * back);
}

bool Aligner::solve(const Prior& prior, Registration& out) {
  const NormalEquations equations = sum_up(pairs_.data(), weights_.data(), pair_count_);
  // The feigned information is itself known from so many pairs only.
  const double surplus = 1.0 + kRatioNoise / math::sqrt(static_cast<double>(pair_count_));
  Observed observed = observed_part(equations, surplus * config_.min_information_ratio);
  // From motions of S to those of the points' centre, which the equations are about.
  Matrix6 to_centre = Matrix6::Identity();
  to_centre.topRightCorner<3, 3>() = -geometry::cross_matrix(equations.centre_m - X_TS_.origin.m);
  to_centre.bottomRightCorner<3, 3>() *= equations.lever_m;
  if (observed.directions < 6) keep_wider(prior, to_centre, observed);
  // A point that is in several surfels must not count several times against the prior.
  const Matrix6 half = observed.information * to_centre;
  Matrix6 information = to_centre.transpose() * half / overlap_factor_;
  Vector6 gradient = to_centre.transpose() * observed.gradient / overlap_factor_;
  const Vector6 prior_diagonal = prior_information(prior);
  information.diagonal() += prior_diagonal;
  gradient += prior_diagonal.cwiseProduct(motion(X_TS_, prior.X_TS));
  if (!invert(information, out.covariance)) return false;
  const Vector6 u = out.covariance * gradient;
  X_TS_ = moved(X_TS_, u);
  moved_m_ = math::sqrt(Vector6(to_centre * u).squaredNorm());
  return true;
}

// A direction is open when its variance is not even half of the prior's.
void Aligner::report_open_directions(const Prior& prior, Registration& out) const {
  const Vector6 per_sigma = prior_information(prior).cwiseSqrt();
  const Matrix6 scaled = per_sigma.asDiagonal() * Matrix6(out.covariance * per_sigma.asDiagonal());
  const Eigen6 eigen = eigen_decomposition(scaled);
  out.observed_directions = 0;
  out.unobserved.setZero();
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] < 0.5) {
      ++out.observed_directions;
    } else {
      out.unobserved += eigen.vectors.col(i) * eigen.vectors.col(i).transpose();
    }
  }
}

bool Aligner::step(Cloud& source, Cloud& target, int level, const Prior& prior, Registration& out) {
  find_pairs(source, target, level);
  out.pairs = static_cast<std::int32_t>(pair_count_);
  out.overlap = static_cast<double>(pair_count_) / static_cast<double>(chosen_count_);
  if (out.pairs < config_.min_pairs || out.overlap < config_.min_overlap) return false;
  weigh();
  out.residual_m = residual_m_;
  if (!solve(prior, out)) return false;
  ++out.iterations;
  return true;
}

Status Aligner::run_level(Cloud& source, Cloud& target, int level, const Prior& prior,
                          Registration& out) {
  out.converged = false;
  out.pairs = 0;
  out.overlap = 0;
  const auto enough = static_cast<std::size_t>(config_.min_pairs);
  const std::size_t partners = target.first_cell(level + 1) - target.first_cell(level);
  if (choose_surfels(source, level) < enough || partners < enough) return Status::kUnavailable;
  const double converged_m =
      (level == out.level ? kConverged_cells : kConvergedCoarse_cells) * source.cell_m(level);
  const std::int32_t limit = config_.max_iterations[static_cast<std::size_t>(level)];
  for (std::int32_t i = 0; i < limit && !out.converged; ++i) {
    if (!step(source, target, level, prior, out)) return Status::kNotFound;
    out.converged = moved_m_ < converged_m;
  }
  wider_covariance_ = out.covariance;
  wider_X_TS_ = X_TS_;
  report_open_directions(prior, out);
  return Status::kOk;
}

int Aligner::finest_level(Cloud& source) {
  int widest = kLevels;
  for (int level = 0; level < kLevels; ++level) {
    if (config_.max_iterations[static_cast<std::size_t>(level)] == 0) continue;
    widest = level;
    const std::size_t cells = source.first_cell(level + 1) - source.first_cell(level);
    const auto wanted = std::min(cells, static_cast<std::size_t>(config_.max_pairs));
    const std::size_t surfels = choose_surfels(source, level);
    if (static_cast<double>(surfels) >= kMinSurfels * static_cast<double>(wanted)) break;
  }
  return widest;
}

void Aligner::touch() {
  chosen_.fill(0);
  pairs_.fill(Pair{});
  weights_.fill(0);
  sorted_.fill(0);
}

Status Aligner::align(Cloud& source, Cloud& target, const Prior& prior, Registration& out) {
  if (!is_prior(prior)) return Status::kInvalid;
  if (source.cell_m(0) != config_.cell_m || target.cell_m(0) != config_.cell_m) {
    return Status::kInvalid;
  }
  out = Registration{};
  out.level = finest_level(source);
  wider_covariance_ = prior_information(prior).cwiseInverse().asDiagonal();
  wider_X_TS_ = prior.X_TS;
  X_TS_ = prior.X_TS;
  // A wider level without enough partners leaves the pose where it is; the finest one decides.
  Status status = Status::kUnavailable;
  for (int level = kLevels - 1; level >= out.level; --level) {
    if (config_.max_iterations[static_cast<std::size_t>(level)] == 0) continue;
    status = run_level(source, target, level, prior, out);
  }
  if (ok(status) && !within_gate(prior)) status = Status::kOutOfRange;
  out.X_TS = ok(status) ? X_TS_ : prior.X_TS;
  if (!ok(status)) out.covariance = prior_information(prior).cwiseInverse().asDiagonal();
  return status;
}

}  // namespace surefoot::registration
