#include "core/visual_odometry/visual_odometry.h"

#include <Eigen/Cholesky>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/visual_odometry/alignment.h"
#include "core/visual_odometry/depth.h"

namespace surefoot::visual_odometry {
namespace {

constexpr double kCornerNoise_px = 0.7;   // of a corner found anew in another picture
constexpr double kMaxTrackMove_px = 4.0;  // from where the first motion puts a point
constexpr double kMinWarp = 0.4;          // areas: what turned or shrank more is not compared
constexpr double kMaxWarp = 2.5;
constexpr std::uint16_t kNobody = 0xFFFF;

KeyframeView predicted_view(const KeyframeView& last, const Prediction& prediction) {
  const Matrix3 R_NP = prediction.R_PN.transpose();
  return {R_NP * last.R_NK, R_NP * (last.t_NK_m - prediction.p_PN_m)};
}

// How pixels around a feature move with the view; false where they do not face it any more.
bool warp_of(const stereo::RectifiedPair& pair, const Feature& feature, const KeyframeView& view,
             Vector2& at_px, Matrix2& warp) {
  Vector2 places[3];
  for (int i = 0; i < 3; ++i) {
    const double du = i == 1 ? 1 : 0;
    const double dv = i == 2 ? 1 : 0;
    const double disparity_px =
        feature.disparity_px + feature.disparity_per_u * du + feature.disparity_per_v * dv;
    if (!(disparity_px > 0)) return false;
    const Vector3 p =
        view.R_NK * point_of(pair, feature.u_px + du, feature.v_px + dv, disparity_px) +
        view.t_NK_m;
    if (!(p.z() > 0)) return false;
    places[i] = project(pair, p);
  }
  at_px = places[0];
  warp.col(0) = places[1] - places[0];
  warp.col(1) = places[2] - places[0];
  const double area = warp(0, 0) * warp(1, 1) - warp(0, 1) * warp(1, 0);
  return area > kMinWarp && area < kMaxWarp;
}

}  // namespace

Status validate(const VisualOdometryConfig& config) {
  RangeCheck check;
  VisualOdometryConfig::describe(config, check);
  const bool ordered = config.min_disparity_px < config.max_disparity_px;
  return check.good && ordered ? Status::kOk : Status::kInvalid;
}

Status VisualOdometry::configure(const VisualOdometryConfig& config,
                                 const stereo::RectifiedPair& pair) {
  if (!ok(validate(config))) return Status::kInvalid;
  const bool sizes = pair.width_px > 0 && pair.width_px <= stereo::kMaxWidth_px &&
                     pair.height_px > 0 && pair.height_px <= stereo::kMaxHeight_px;
  if (!sizes || !(pair.focal_px > 1) || !(pair.baseline_m > 0)) return Status::kInvalid;
  if (!math::is_finite(pair.focal_px + pair.baseline_m + pair.cx_px + pair.cy_px)) {
    return Status::kInvalid;
  }
  config_ = config;
  pair_ = pair;
  configured_ = true;
  reset();
  return Status::kOk;
}

void VisualOdometry::reset() {
  has_keyframe_ = false;
  started_ = false;
  failures_ = 0;
  last_ = {};
}

Status VisualOdometry::update(const Pictures& pictures, const Prediction& prediction, Motion& out) {
  const auto fits = [&](const auto& picture) {
    return picture.width_px == pair_.width_px && picture.height_px == pair_.height_px;
  };
  if (!configured_ || pictures.left.pixels == nullptr || !fits(pictures.left)) {
    return Status::kInvalid;
  }
  const bool depth = pictures.disparities != nullptr
                         ? fits(*pictures.disparities)
                         : pictures.right.pixels != nullptr && fits(pictures.right);
  if (!depth || (started_ && !(pictures.stamp > last_stamp_))) return Status::kInvalid;
  if (!geometry::is_rotation(prediction.R_PN, 1e-6)) return Status::kInvalid;
  if (!math::is_finite(prediction.p_PN_m.squaredNorm())) return Status::kInvalid;
  started_ = true;
  last_stamp_ = pictures.stamp;

  out = {};
  out.from = keyframe_stamp_;
  out.to = pictures.stamp;
  look(pictures, out);
  const bool enough = out.with_depth >= config_.min_inliers;
  if (!has_keyframe_) {
    if (enough) {
      out.status = MotionStatus::kFirst;
      make_keyframe(out);
      out.new_keyframe = true;
    }
    return Status::kOk;
  }
  const KeyframeView predicted = predicted_view(last_, prediction);
  if (enough && estimate(predicted, out)) {
    out.status = MotionStatus::kOk;
    failures_ = 0;
    out.new_keyframe = keyframe_worn(out);
  } else {
    out.status = enough ? MotionStatus::kInconsistent : MotionStatus::kTooFewFeatures;
    last_ = predicted;
    ++failures_;
    out.new_keyframe = enough && failures_ > config_.max_failures;
  }
  if (out.new_keyframe) make_keyframe(out);
  return Status::kOk;
}

void VisualOdometry::look(const Pictures& pictures, Motion& out) {
  Features& features = features_[present_];
  smooth_picture(pictures.left, left_);
  corners_.find(left_.view(), config_.min_corner, features);
  if (pictures.disparities != nullptr) {
    read_depths(*pictures.disparities, config_, features);
  } else {
    smooth_picture(pictures.right, right_);
    find_depths(right_.view(), config_, features);
  }
  out.corners = static_cast<std::int32_t>(features.size());
  for (const Feature& feature : features) out.with_depth += feature.has_depth() ? 1 : 0;
}

NoisyPoint VisualOdometry::noisy_point(const Feature& feature) const {
  NoisyPoint point;
  point.p_m = point_of(pair_, feature.u_px, feature.v_px, feature.disparity_px);
  point.along_m = point.p_m * (math::sqrt(feature.disparity_variance_px2) / feature.disparity_px);
  point.across_m = kCornerNoise_px * point.p_m.z() / pair_.focal_px;
  return point;
}

// The present feature that is most like the keyframe's `from` among those near to where it should
// be.
void VisualOdometry::pair_up(std::size_t from, const KeyframeView& predicted) {
  const Feature& old = features_[1 - present_][from];
  if (!old.has_depth()) return;
  const Vector3 p_K = point_of(pair_, old.u_px, old.v_px, old.disparity_px);
  const Vector3 p_N = predicted.R_NK * p_K + predicted.t_NK_m;
  if (!(p_N.z() > 0)) return;
  const Vector2 expected = project(pair_, p_N);
  const double radius = config_.search_px + pair_.focal_px * config_.max_step_m / p_N.z();
  const Features& now = features_[present_];
  double best = config_.min_similarity;
  std::size_t to = now.size();
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!now[i].has_depth()) continue;
    const Vector2 off = Vector2(now[i].u_px, now[i].v_px) - expected;
    if (!(off.squaredNorm() <= radius * radius)) continue;
    const double alike = similarity(old.patch, now[i].patch);
    if (alike <= best) continue;
    best = alike;
    to = i;
  }
  if (to == now.size() || best <= best_for_[to]) return;
  best_for_[to] = best;
  best_from_[to] = static_cast<std::uint16_t>(from);
}

// Of several keyframe's features that chose the same present one, the most alike keeps it.
void VisualOdometry::match(const KeyframeView& predicted) {
  matches_.clear();
  best_for_.fill(0);
  best_from_.fill(kNobody);
  for (std::size_t from = 0; from < features_[1 - present_].size(); ++from) {
    pair_up(from, predicted);
  }
  for (std::size_t to = 0; to < features_[present_].size(); ++to) {
    if (best_from_[to] == kNobody) continue;
    Match found;
    found.from = best_from_[to];
    found.to = static_cast<std::uint16_t>(to);
    found.then = noisy_point(features_[1 - present_][found.from]);
    found.now = noisy_point(features_[present_][to]);
    if (!ok(matches_.push_back(found))) return;
  }
}

// A first motion from the largest consistent set.
bool VisualOdometry::start(const KeyframeView& predicted, KeyframeView& out, Motion& motion) {
  match(predicted);
  motion.matched = static_cast<std::int32_t>(matches_.size());
  motion.clique = static_cast<std::int32_t>(cliques_.find(matches_, config_.gate_sigma, chosen_));
  if (motion.clique < config_.min_inliers) return false;
  observations_.clear();
  KeyframeView guess = predicted;
  Vector3 shift = Vector3::Zero();
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (!chosen_[i]) continue;
    const Match& found = matches_[i];
    const Feature& old = features_[1 - present_][found.from];
    const Feature& now = features_[present_][found.to];
    shift += found.now.p_m - guess.R_NK * found.then.p_m;
    const Observation seen = {found.from,
                              found.then.p_m,
                              old.disparity_px,
                              old.disparity_variance_px2,
                              Vector2(now.u_px, now.v_px),
                              math::square(kCornerNoise_px),
                              true};
    if (!ok(observations_.push_back(seen))) break;
  }
  guess.t_NK_m = shift / static_cast<double>(motion.clique);
  Solution solution;
  if (!solve_motion(pair_, guess, config_.gate_sigma, observations_, solution)) return false;
  out = solution.view;
  return static_cast<std::int32_t>(solution.inliers) >= config_.min_inliers;
}

void VisualOdometry::track_one(std::size_t index, const KeyframeView& view) {
  const Feature& feature = features_[1 - present_][index];
  Vector2 at_px;
  Matrix2 warp;
  Template patch;
  Alignment found;
  if (!feature.has_depth() || !warp_of(pair_, feature, view, at_px, warp)) return;
  if (!make_template(feature.patch, patch)) return;
  if (!align(patch, warp, left_.view(), at_px, kMaxTrackMove_px, found)) return;
  if (found.similarity < config_.min_similarity) return;
  const Observation seen = {static_cast<std::uint16_t>(index),
                            point_of(pair_, feature.u_px, feature.v_px, feature.disparity_px),
                            feature.disparity_px,
                            feature.disparity_variance_px2,
                            found.at_px,
                            math::square(config_.track_noise_px) +
                                2 * math::square(config_.grey_noise) / found.information,
                            true};
  static_cast<void>(observations_.push_back(seen));  // one per feature: there is room
}

void VisualOdometry::track(const KeyframeView& view) {
  observations_.clear();
  for (std::size_t i = 0; i < features_[1 - present_].size(); ++i) track_one(i, view);
}

bool VisualOdometry::accept(const Solution& solution, const KeyframeView& predicted,
                            Motion& out) const {
  const auto inliers = static_cast<double>(solution.inliers);
  if (out.inliers < config_.min_inliers) return false;
  if (inliers < config_.min_inlier_share * out.tracked) return false;
  const Matrix3 beyond = solution.view.R_NK * predicted.R_NK.transpose();
  if (!(geometry::to_rotation_vector(beyond).norm() <= config_.gyro_tolerance_rad)) return false;
  const Vector3 step_m = solution.view.t_NK_m - beyond * predicted.t_NK_m;
  if (!(step_m.norm() <= config_.max_step_m)) return false;
  const Eigen::LDLT<Matrix6> factors(solution.information);
  if (!(factors.vectorD().minCoeff() > 0)) return false;
  // Larger than the noise said: then so is the uncertainty.
  const double freedom = 2.0 * inliers - 6.0;
  const double stretch = solution.chi2 > freedom ? solution.chi2 / freedom : 1.0;
  Matrix6 covariance_N;
  for (int i = 0; i < 6; ++i) covariance_N.col(i) = stretch * factors.solve(Vector6::Unit(i));
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = solution.view.R_NK.transpose();
  turn.bottomRightCorner<3, 3>() = solution.view.R_NK.transpose();
  out.covariance = turn * covariance_N * turn.transpose();
  out.covariance = (0.5 * (out.covariance + out.covariance.transpose())).eval();
  out.R_KN = solution.view.R_NK.transpose();
  out.p_KN_m = -(out.R_KN * solution.view.t_NK_m);
  out.residual_px = solution.residual_px;
  return true;
}

// From a first motion to the accepted one.
bool VisualOdometry::refine(const KeyframeView& first, const KeyframeView& predicted, Motion& out) {
  track(first);
  out.tracked = static_cast<std::int32_t>(observations_.size());
  out.inliers = 0;
  Solution solution;
  if (!solve_motion(pair_, first, config_.gate_sigma, observations_, solution)) return false;
  out.inliers = static_cast<std::int32_t>(solution.inliers);
  if (!accept(solution, predicted, out)) return false;
  last_ = solution.view;
  return true;
}

// Where the corners tell no motion, or one that is not believed, the prediction is the first one:
// corners that are faint are seldom found twice, and the largest set may be that of an object.
bool VisualOdometry::estimate(const KeyframeView& predicted, Motion& out) {
  KeyframeView first;
  return (start(predicted, first, out) && refine(first, predicted, out)) ||
         refine(predicted, predicted, out);
}

bool VisualOdometry::keyframe_worn(const Motion& motion) const {
  if (motion.inliers < config_.keep_share * keyframe_points_) return true;
  double disparities_px = 0;
  for (const Observation& observation : observations_) {
    if (observation.inlier) disparities_px += observation.disparity_px;
  }
  const double inverse_depth_1_m =
      disparities_px / (motion.inliers * pair_.focal_px * pair_.baseline_m);
  if (motion.p_KN_m.norm() * inverse_depth_1_m > config_.keep_parallax) return true;
  return geometry::to_rotation_vector(motion.R_KN).norm() > config_.keep_turn_rad;
}

void VisualOdometry::make_keyframe(const Motion& motion) {
  present_ = 1 - present_;
  has_keyframe_ = true;
  keyframe_stamp_ = motion.to;
  keyframe_points_ = motion.with_depth;
  failures_ = 0;
  last_ = {};
}

}  // namespace surefoot::visual_odometry
