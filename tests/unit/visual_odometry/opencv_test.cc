// Against OpenCV: its corners, and its usual chain for the motion between two pictures (ORB, brute
// force matching, semi-global disparities, PnP with RANSAC).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/rotations.h"
#include "core/visual_odometry/visual_odometry.h"
#include "tests/unit/visual_odometry/walk.h"

namespace surefoot::tests {
namespace {

using visual_odometry::Features;

cv::Mat matrix_of(const stereo::GreyView& view) {
  return cv::Mat(view.height_px, view.width_px, CV_8U, const_cast<std::uint8_t*>(view.pixels))
      .clone();
}

TEST(CornersOpenCv, AreTheSmallerEigenvalue) {
  const StereoPictures pictures =
      TexturedScene(5, 160, 10).render(small_pair(), camera_at({}, 0), {});
  const auto finder = std::make_unique<visual_odometry::CornerFinder>();
  const auto features = std::make_unique<Features>();
  finder->find(pictures.left_view(), 1, *features);
  cv::Mat eigenvalues;
  cv::cornerMinEigenVal(matrix_of(pictures.left_view()), eigenvalues, 7, 1);
  // OpenCV sums what it has scaled by 1 / (7 x 255); here it is the mean of (difference / 2)^2.
  const double scale = 255.0 * 255.0 / 4.0;
  ASSERT_GT(features->size(), 250u);
  for (const visual_odometry::Feature& feature : *features) {
    const double theirs =
        scale * static_cast<double>(eigenvalues.at<float>(feature.v_px, feature.u_px));
    EXPECT_NEAR(feature.corner, theirs, 1e-3 * theirs);
  }
}

TEST(CornersOpenCv, LieWhereGoodFeaturesToTrackFindsThem) {
  const StereoPictures pictures =
      TexturedScene(6, 160, 10).render(small_pair(), camera_at({}, 0), {});
  const auto finder = std::make_unique<visual_odometry::CornerFinder>();
  const auto features = std::make_unique<Features>();
  finder->find(pictures.left_view(), 1, *features);
  std::vector<cv::Point2f> theirs;
  cv::goodFeaturesToTrack(matrix_of(pictures.left_view()), theirs, 100, 0.01, 14, cv::noArray(), 7);
  int found = 0;
  int inside = 0;
  for (const cv::Point2f& corner : theirs) {
    const int border = visual_odometry::kBorder_px;
    if (corner.x < border || corner.y < border || corner.x >= 320 - border ||
        corner.y >= 240 - border) {
      continue;
    }
    ++inside;
    found += std::any_of(features->begin(), features->end(), [&](const auto& feature) {
      return std::abs(feature.u_px - static_cast<double>(corner.x)) <= 2 &&
             std::abs(feature.v_px - static_cast<double>(corner.y)) <= 2;
    });
  }
  std::printf("of %d strongest corners %d are ours too\n", inside, found);
  EXPECT_GT(found, 0.7 * inside);
}

// Motion of the camera by OpenCV's parts; false: none.
bool opencv_motion(const stereo::RectifiedPair& pair, const StereoPictures& key,
                   const StereoPictures& now, CameraPlace& out) {
  const cv::Mat left = matrix_of(key.left_view());
  cv::Mat disparities;
  cv::StereoSGBM::create(0, 64, 5, 8 * 25, 32 * 25, 1, 63, 10, 50, 1)
      ->compute(left, matrix_of(key.right_view()), disparities);
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(1000, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, 5);
  std::vector<cv::KeyPoint> then_points;
  std::vector<cv::KeyPoint> now_points;
  cv::Mat then_words;
  cv::Mat now_words;
  orb->detectAndCompute(left, cv::noArray(), then_points, then_words);
  orb->detectAndCompute(matrix_of(now.left_view()), cv::noArray(), now_points, now_words);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(then_words, now_words, matches);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> seen;
  for (const cv::DMatch& match : matches) {
    const cv::Point2f at = then_points[static_cast<std::size_t>(match.queryIdx)].pt;
    const double disparity = disparities.at<std::int16_t>(cvRound(at.y), cvRound(at.x)) / 16.0;
    if (disparity < 1) continue;
    const Vector3 p = visual_odometry::point_of(pair, static_cast<double>(at.x),
                                                static_cast<double>(at.y), disparity);
    points.emplace_back(p.x(), p.y(), p.z());
    const cv::Point2f to = now_points[static_cast<std::size_t>(match.trainIdx)].pt;
    seen.emplace_back(to.x, to.y);
  }
  const cv::Matx33d camera(pair.focal_px, 0, pair.cx_px, 0, pair.focal_px, pair.cy_px, 0, 0, 1);
  cv::Mat turn;
  cv::Mat shift;
  if (points.size() < 10) return false;
  if (!cv::solvePnPRansac(points, seen, camera, cv::noArray(), turn, shift, false, 300, 1.5F)) {
    return false;
  }
  const Vector3 w(turn.at<double>(0), turn.at<double>(1), turn.at<double>(2));
  const Vector3 t(shift.at<double>(0), shift.at<double>(1), shift.at<double>(2));
  out.R_WN = geometry::to_matrix(geometry::from_rotation_vector(w)).transpose();
  out.p_WN_m = -(out.R_WN * t);
  return true;
}

struct Errors {
  std::vector<double> ours_m;
  std::vector<double> theirs_m;
  std::vector<double> ours_rad;
  std::vector<double> theirs_rad;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void compare(std::uint64_t seed, double contrast, double grey_noise, Errors& errors) {
  const stereo::RectifiedPair pair = small_pair();
  const TexturedScene scene(seed, contrast, 12);
  const auto odometry = std::make_unique<visual_odometry::VisualOdometry>();
  ASSERT_EQ(odometry->configure(recommended_visual_odometry(), pair), Status::kOk);
  StereoPictures pictures[2];
  CameraPlace places[2];
  visual_odometry::Motion motion;
  for (int i = 0; i < 2; ++i) {
    places[i] = camera_at({}, 0.4 + i * kPicturePeriod_s + 0.3 * static_cast<double>(seed));
    Exposure exposure;
    exposure.grey_noise = grey_noise;
    exposure.noise_seed = 10 * seed + static_cast<std::uint64_t>(i);
    pictures[i] = scene.render(pair, places[i], exposure);
    const visual_odometry::Pictures input{TimeNs{(i + 1) * 80'000'000}, pictures[i].left_view(),
                                          pictures[i].right_view(), nullptr};
    visual_odometry::Prediction prediction;
    if (i == 1) prediction.R_PN = relative(places[0], places[1]).R_WN;
    ASSERT_EQ(odometry->update(input, prediction, motion), Status::kOk);
  }
  CameraPlace theirs;
  ASSERT_TRUE(opencv_motion(pair, pictures[0], pictures[1], theirs));
  ASSERT_EQ(motion.status, visual_odometry::MotionStatus::kOk);
  const CameraPlace truth = relative(places[0], places[1]);
  const auto turn = [&](const Matrix3& R) {
    return geometry::to_rotation_vector(R * truth.R_WN.transpose()).norm();
  };
  errors.ours_m.push_back((motion.p_KN_m - truth.p_WN_m).norm());
  errors.theirs_m.push_back((theirs.p_WN_m - truth.p_WN_m).norm());
  errors.ours_rad.push_back(turn(motion.R_KN));
  errors.theirs_rad.push_back(turn(theirs.R_WN));
}

TEST(MotionOpenCv, IsMoreExactThanOrbWithPnp) {
  for (const auto& [contrast, noise] : {std::pair{160.0, 2.0}, std::pair{60.0, 3.0}}) {
    Errors errors;
    for (std::uint64_t seed = 1; seed <= 9; ++seed) compare(seed, contrast, noise, errors);
    ASSERT_EQ(errors.ours_m.size(), 9u);
    const double ratio_m = median(errors.ours_m) / median(errors.theirs_m);
    const double ratio_rad = median(errors.ours_rad) / median(errors.theirs_rad);
    std::printf(
        "contrast %3.0f noise %.0f: ours %.3f mm %.3f mrad, OpenCV %.3f mm %.3f mrad, "
        "ratio %.2f %.2f\n",
        contrast, noise, 1e3 * median(errors.ours_m), 1e3 * median(errors.ours_rad),
        1e3 * median(errors.theirs_m), 1e3 * median(errors.theirs_rad), ratio_m, ratio_rad);
    EXPECT_LT(ratio_m, 0.7);
    EXPECT_LT(ratio_rad, 0.7);
  }
}

}  // namespace
}  // namespace surefoot::tests
