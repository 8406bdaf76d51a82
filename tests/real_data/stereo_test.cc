// Real pairs against OpenCV's semi-global matcher: chessboards, whose disparity follows from their
// corners; two boulders before a rover, on level ground; a plant with scanned disparities. None of
// them was looked at when the matcher's settings were chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/rotations.h"
#include "core/stereo/matcher.h"
#include "core/stereo/point_cloud.h"
#include "core/stereo/rectifier.h"
#include "tests/support/stereo_scene.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::real_data {
namespace {

using stereo::CameraModel;
using stereo::GreyView;
using stereo::StereoCalibration;
using tests::DisparityQuality;

const std::string kFolder = std::string(SUREFOOT_SHARED_DATA) + "/stereo";
// Of Debian's package opencv-doc.
const std::string kExamples = "/usr/share/doc/opencv-doc/examples/data";
constexpr double kMaxWrongRatio = 1.3;
constexpr double kSimilarDensity = 0.08;

GreyView view_of(const cv::Mat& picture) {
  return {picture.data, static_cast<std::uint16_t>(picture.cols),
          static_cast<std::uint16_t>(picture.rows)};
}

cv::Mat picture_of(const stereo::GreyImage& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8U,
                 const_cast<std::uint8_t*>(image.pixels.data()))
      .clone();
}

// Both matchers on one rectified pair.
struct Matches {
  std::unique_ptr<stereo::DisparityImage> ours = std::make_unique<stereo::DisparityImage>();
  cv::Mat theirs;  // in 1/16 px
};

Matches match(const cv::Mat& left, const cv::Mat& right, int disparities) {
  static const auto matcher = std::make_unique<stereo::Matcher>();
  Matches matches;
  stereo::MatcherConfig config = tests::recommended_matcher();
  config.disparities = static_cast<std::uint16_t>(disparities);
  EXPECT_EQ(matcher->configure(config), Status::kOk);
  EXPECT_EQ(matcher->match(view_of(left), view_of(right), *matches.ours), Status::kOk);
  cv::StereoSGBM::create(0, disparities, 5, 8 * 25, 32 * 25, 1, 63, 10, 50, 1)
      ->compute(left, right, matches.theirs);
  return matches;
}

// Mean of what several pairs gave.
struct Tally {
  DisparityQuality ours;
  DisparityQuality theirs;
  int pairs = 0;

  void add(const Matches& matches, const std::vector<float>& truth_px, int disparities) {
    const auto width_px = static_cast<std::size_t>(matches.theirs.cols);
    const auto first = static_cast<std::size_t>(disparities);
    add(tests::judge_disparities(matches.ours->values.data(), stereo::kSubpixels, truth_px,
                                 width_px, first),
        ours);
    add(tests::judge_disparities(matches.theirs.ptr<std::int16_t>(), 16, truth_px, width_px, first),
        theirs);
    ++pairs;
  }
  static void add(const DisparityQuality& one, DisparityQuality& sum) {
    sum.density += one.density;
    sum.wrong += one.wrong;
    sum.rms_px += one.rms_px;
  }
  void print(const char* name) const {
    std::printf("  %s, %d: density %.3f wrong %.4f rms %.3f px; SGBM %.3f %.4f %.3f\n", name, pairs,
                ours.density / pairs, ours.wrong / pairs, ours.rms_px / pairs,
                theirs.density / pairs, theirs.wrong / pairs, theirs.rms_px / pairs);
  }
};

CameraModel camera_model(const cv::Mat& matrix, const cv::Mat& distortion, cv::Size size) {
  CameraModel camera;
  camera.width_px = static_cast<std::uint16_t>(size.width);
  camera.height_px = static_cast<std::uint16_t>(size.height);
  camera.fx_px = matrix.at<double>(0, 0);
  camera.fy_px = matrix.at<double>(1, 1);
  camera.cx_px = matrix.at<double>(0, 2);
  camera.cy_px = matrix.at<double>(1, 2);
  for (int k = 0; k < std::min(static_cast<int>(distortion.total()), 8); ++k) {
    camera.distortion[static_cast<std::size_t>(k)] = distortion.at<double>(k);
  }
  return camera;
}

// Turned pictures of both cameras, of the cameras' size.
struct Rectified {
  stereo::RectifiedPair cameras;
  cv::Mat left;
  cv::Mat right;
};

Rectified rectified(const StereoCalibration& calibration, const cv::Mat& left,
                    const cv::Mat& right) {
  static const auto rectifier = std::make_unique<stereo::Rectifier>();
  const auto left_out = std::make_unique<stereo::GreyImage>();
  const auto right_out = std::make_unique<stereo::GreyImage>();
  Rectified out;
  EXPECT_EQ(stereo::rectify(calibration, calibration.left.width_px, calibration.left.height_px, 0,
                            out.cameras),
            Status::kOk);
  EXPECT_EQ(rectifier->configure(calibration, out.cameras), Status::kOk);
  EXPECT_EQ(rectifier->run(view_of(left), view_of(right), *left_out, *right_out), Status::kOk);
  out.left = picture_of(*left_out);
  out.right = picture_of(*right_out);
  return out;
}

Vector3 point_of(const stereo::RectifiedPair& cameras, double u_px, double v_px,
                 double disparity_px) {
  const double z_m = cameras.focal_px * cameras.baseline_m / disparity_px;
  return {(u_px - cameras.cx_px) / cameras.focal_px * z_m,
          (v_px - cameras.cy_px) / cameras.focal_px * z_m, z_m};
}

using Corners = std::vector<cv::Point2f>;

class Chessboards : public ::testing::Test {
 protected:
  static constexpr int kPairs = 8;
  static constexpr int kDisparities = 224;
  static constexpr double kSquare_m = 0.025;
  const cv::Size kInner{9, 6};

  void SetUp() override {
    if (!std::filesystem::exists(kFolder + "/chess/left01.jpg")) {
      GTEST_SKIP() << "no pictures in " << kFolder << "/chess";
    }
    for (int k = 1; k <= kPairs; ++k) {
      left_.push_back(read("left", k));
      right_.push_back(read("right", k));
    }
    calibrate();
  }

  cv::Mat read(const char* side, int number) const {
    return cv::imread(kFolder + "/chess/" + side + "0" + std::to_string(number) + ".jpg",
                      cv::IMREAD_GRAYSCALE);
  }
  Corners corners(const cv::Mat& picture) const {
    Corners found;
    if (!cv::findChessboardCorners(picture, kInner, found)) return {};
    cv::cornerSubPix(picture, found, {5, 5}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 0.001});
    return found;
  }

  // From the pairs of odd number; the even ones are judged.
  void calibrate() {
    std::vector<std::vector<cv::Point3f>> board;
    std::vector<Corners> left, right;
    for (std::size_t k = 0; k < left_.size(); k += 2) {
      left.push_back(corners(left_[k]));
      right.push_back(corners(right_[k]));
      ASSERT_FALSE(left.back().empty() || right.back().empty());
      board.emplace_back();
      for (int i = 0; i < kInner.area(); ++i) {
        board.back().emplace_back(static_cast<float>(kSquare_m * (i % kInner.width)),
                                  static_cast<float>(kSquare_m * (i / kInner.width)), 0.0f);
      }
    }
    const cv::Size size = left_[0].size();
    cv::Mat K1, K2, D1, D2, R, T, E, F;
    std::vector<cv::Mat> turns, shifts;
    cv::calibrateCamera(board, left, size, K1, D1, turns, shifts, cv::CALIB_FIX_K3);
    cv::calibrateCamera(board, right, size, K2, D2, turns, shifts, cv::CALIB_FIX_K3);
    const double rms_px = cv::stereoCalibrate(board, left, right, K1, D1, K2, D2, size, R, T, E, F,
                                              cv::CALIB_USE_INTRINSIC_GUESS + cv::CALIB_FIX_K3);
    EXPECT_LT(rms_px, 0.4);
    calibration_.left = camera_model(K1, D1, size);
    calibration_.right = camera_model(K2, D2, size);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        calibration_.R_EV(row, column) = R.at<double>(row, column);
      }
      calibration_.p_EV_m[row] = T.at<double>(row);
    }
  }

  struct Fit {
    double plane_rms_px = 1e9;  // of the corners' disparities
    double row_rms_px = 1e9;    // between the corners of both pictures
    double square_m = 0;        // mean side, triangulated
  };

  // Disparity of the board within its outer inner corners, 0 elsewhere: a plane's is linear in the
  // pixel.
  std::vector<float> truth(const Rectified& pair, Fit& fit) const {
    std::vector<float> disparity_px(pair.left.total(), 0.0f);
    const Corners left = corners(pair.left);
    const Corners right = corners(pair.right);
    if (left.empty() || right.empty()) return disparity_px;
    const cv::Mat law = plane_law(left, right, fit);
    fit.square_m = mean_side_m(left, right, pair.cameras);
    const auto corner = [&](int i) { return cv::Point(left[static_cast<std::size_t>(i)]); };
    const std::vector<cv::Point> outline{corner(0), corner(kInner.width - 1),
                                         corner(kInner.area() - 1),
                                         corner(kInner.area() - kInner.width)};
    cv::Mat mask(pair.left.size(), CV_8U, cv::Scalar(0));
    cv::fillConvexPoly(mask, outline, cv::Scalar(1));
    for (int v = 0; v < mask.rows; ++v) {
      for (int u = 0; u < mask.cols; ++u) {
        if (mask.at<std::uint8_t>(v, u) == 0) continue;
        const double value = law.at<double>(0) * u + law.at<double>(1) * v + law.at<double>(2);
        disparity_px[static_cast<std::size_t>(v * mask.cols + u)] = static_cast<float>(value);
      }
    }
    return disparity_px;
  }

  static cv::Mat plane_law(const Corners& left, const Corners& right, Fit& fit) {
    const auto count = static_cast<int>(left.size());
    cv::Mat inputs(count, 3, CV_64F), wanted(count, 1, CV_64F), law;
    double rows = 0;
    for (int i = 0; i < count; ++i) {
      const cv::Point2d l = left[static_cast<std::size_t>(i)];
      const cv::Point2d r = right[static_cast<std::size_t>(i)];
      inputs.at<double>(i, 0) = l.x;
      inputs.at<double>(i, 1) = l.y;
      inputs.at<double>(i, 2) = 1;
      wanted.at<double>(i) = l.x - r.x;
      rows += (l.y - r.y) * (l.y - r.y);
    }
    cv::solve(inputs, wanted, law, cv::DECOMP_SVD);
    fit.plane_rms_px = cv::norm(inputs * law - wanted) / std::sqrt(count);
    fit.row_rms_px = std::sqrt(rows / count);
    return law;
  }

  // Along the rows of the board.
  double mean_side_m(const Corners& left, const Corners& right,
                     const stereo::RectifiedPair& cameras) const {
    const auto place = [&](std::size_t i) {
      const cv::Point2d l = left[i];
      return point_of(cameras, l.x, l.y, l.x - static_cast<double>(right[i].x));
    };
    double sum_m = 0;
    int sides = 0;
    for (std::size_t i = 0; i + 1 < left.size(); ++i) {
      if ((i + 1) % static_cast<std::size_t>(kInner.width) == 0) continue;
      sum_m += (place(i + 1) - place(i)).norm();
      ++sides;
    }
    return sum_m / sides;
  }

  std::vector<cv::Mat> left_;
  std::vector<cv::Mat> right_;
  StereoCalibration calibration_;
};

// A hard case for any matcher: plain squares that repeat. Ours leaves most of the plain area out.
TEST_F(Chessboards, FewerAreWrongThanOfSgbm) {
  Tally tally;
  for (std::size_t k = 1; k < left_.size(); k += 2) {
    const Rectified pair = rectified(calibration_, left_[k], right_[k]);
    Fit fit;
    const std::vector<float> truth_px = truth(pair, fit);
    EXPECT_LT(fit.plane_rms_px, 0.3) << "pair " << k + 1;
    EXPECT_LT(fit.row_rms_px, 0.4) << "pair " << k + 1;
    EXPECT_NEAR(fit.square_m, kSquare_m, 0.0003) << "pair " << k + 1;
    tally.add(match(pair.left, pair.right, kDisparities), truth_px, kDisparities);
  }
  tally.print("chessboards");
  EXPECT_LE(tally.ours.wrong, tally.theirs.wrong);
  EXPECT_GE(tally.ours.density, 0.15 * tally.pairs);
}

// Ames Stereo Pipeline's camera: pose in the rover's frame W (x forward, y right, z down).
struct RoverCamera {
  CameraModel model;
  Matrix3 R_WC;
  Vector3 p_WC_m;
};

RoverCamera read_tsai(const std::string& path, const cv::Mat& picture) {
  RoverCamera camera;
  camera.model.width_px = static_cast<std::uint16_t>(picture.cols);
  camera.model.height_px = static_cast<std::uint16_t>(picture.rows);
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream text(line);
    std::string key, equals;
    text >> key >> equals;
    if (key == "fu") text >> camera.model.fx_px;
    if (key == "fv") text >> camera.model.fy_px;
    if (key == "cu") text >> camera.model.cx_px;
    if (key == "cv") text >> camera.model.cy_px;
    if (key == "k1") text >> camera.model.distortion[0];
    if (key == "k2") text >> camera.model.distortion[1];
    if (key == "p1") text >> camera.model.distortion[2];
    if (key == "p2") text >> camera.model.distortion[3];
    for (int i = 0; key == "C" && i < 3; ++i) text >> camera.p_WC_m[i];
    for (int i = 0; key == "R" && i < 9; ++i) text >> camera.R_WC(i / 3, i % 3);
  }
  camera.R_WC = geometry::to_matrix(geometry::to_quaternion(camera.R_WC));
  return camera;
}

// Heights of the points in one metre of the way.
struct Band {
  double median_m = 0;
  double quartiles_m = 0;  // between the first and the third
  double points = 0;
};

Band band_of(std::vector<double> z_m) {
  if (z_m.empty()) return {};
  std::sort(z_m.begin(), z_m.end());
  const std::size_t n = z_m.size();
  return {z_m[n / 2], z_m[3 * n / 4] - z_m[n / 4], static_cast<double>(n)};
}

class Rover : public ::testing::Test {
 protected:
  static constexpr int kDisparities = 48;
  static constexpr int kBands = 3;  // from 1 m before the rover on

  void SetUp() override {
    cv::Mat left = cv::imread(kFolder + "/k10_left.png", cv::IMREAD_GRAYSCALE);
    cv::Mat right = cv::imread(kFolder + "/k10_right.png", cv::IMREAD_GRAYSCALE);
    if (left.empty() || right.empty()) GTEST_SKIP() << "no pictures in " << kFolder;
    left_ = read_tsai(kFolder + "/k10_left.tsai", left);
    const RoverCamera right_camera = read_tsai(kFolder + "/k10_right.tsai", right);
    StereoCalibration calibration;
    calibration.left = left_.model;
    calibration.right = right_camera.model;
    calibration.R_EV = right_camera.R_WC.transpose() * left_.R_WC;
    calibration.p_EV_m = right_camera.R_WC.transpose() * (left_.p_WC_m - right_camera.p_WC_m);
    pair_ = rectified(calibration, left, right);
    halve();
  }

  // The recording's calibration is off by a row of the full picture.
  void halve() {
    for (cv::Mat* picture : {&pair_.left, &pair_.right}) {
      cv::Mat small;
      cv::resize(*picture, small, {}, 0.5, 0.5, cv::INTER_AREA);
      *picture = small;
    }
    pair_.cameras.focal_px *= 0.5;
    pair_.cameras.cx_px = 0.5 * (pair_.cameras.cx_px + 0.5) - 0.5;
    pair_.cameras.cy_px = 0.5 * (pair_.cameras.cy_px + 0.5) - 0.5;
  }

  // Beside the rocks: 0.6 to 1.2 m off the middle. `values` in 1/scale px.
  std::array<Band, kBands> ground(const std::int16_t* values, double scale) const {
    const Matrix3 R_WN = left_.R_WC * pair_.cameras.R_NV.transpose();
    std::array<std::vector<double>, kBands> heights_m;
    for (int i = 0; i < static_cast<int>(pair_.left.total()); ++i) {
      if (values[i] < scale) continue;
      const Vector3 p_W_m = left_.p_WC_m + R_WN * point_of(pair_.cameras, i % pair_.left.cols,
                                                           i / pair_.left.cols, values[i] / scale);
      const double band = std::floor(p_W_m.x()) - 1;
      const double off_m = std::fabs(p_W_m.y());
      if (band < 0 || band >= kBands || off_m < 0.6 || off_m > 1.2) continue;
      heights_m[static_cast<std::size_t>(band)].push_back(p_W_m.z());
    }
    std::array<Band, kBands> bands;
    for (std::size_t k = 0; k < bands.size(); ++k) bands[k] = band_of(heights_m[k]);
    return bands;
  }

  RoverCamera left_;
  Rectified pair_;
};

TEST_F(Rover, GroundBesideTheRocksLiesWhereSgbmHasIt) {
  const Matches matches = match(pair_.left, pair_.right, kDisparities);
  const auto ours = ground(matches.ours->values.data(), stereo::kSubpixels);
  const auto theirs = ground(matches.theirs.ptr<std::int16_t>(), 16);
  for (std::size_t k = 0; k < ours.size(); ++k) {
    std::printf("  %zu m ahead: z %.3f m, quartiles %.3f m, %.0f points; SGBM %.3f %.3f %.0f\n",
                k + 1, ours[k].median_m, ours[k].quartiles_m, ours[k].points, theirs[k].median_m,
                theirs[k].quartiles_m, theirs[k].points);
    EXPECT_NEAR(ours[k].median_m, theirs[k].median_m, 0.02);
    EXPECT_LE(ours[k].quartiles_m, 1.4 * theirs[k].quartiles_m);
    EXPECT_GE(ours[k].points, 0.5 * theirs[k].points);
  }
}

// Disparities scanned with structured light, whole pixels of the full picture; 0: none.
TEST(Plant, AtMostTheWrongPixelsOfSgbm) {
  const cv::Mat left = cv::imread(kExamples + "/aloeL.jpg", cv::IMREAD_GRAYSCALE);
  const cv::Mat right = cv::imread(kExamples + "/aloeR.jpg", cv::IMREAD_GRAYSCALE);
  const cv::Mat scanned = cv::imread(kExamples + "/aloeGT.png", cv::IMREAD_GRAYSCALE);
  if (left.empty() || right.empty() || scanned.empty()) {
    GTEST_SKIP() << "no aloe pair in " << kExamples << " (Debian package opencv-doc)";
  }
  constexpr int kMost_px = 212;
  for (const int part : {2, 3, 4}) {
    const cv::Size size(left.cols / part, left.rows / part);
    cv::Mat small_left, small_right, truth;
    cv::resize(left, small_left, size, 0, 0, cv::INTER_AREA);
    cv::resize(right, small_right, size, 0, 0, cv::INTER_AREA);
    cv::resize(scanned, truth, size, 0, 0, cv::INTER_NEAREST);
    std::vector<float> truth_px;
    for (std::size_t i = 0; i < truth.total(); ++i) {
      truth_px.push_back(static_cast<float>(truth.data[i]) / static_cast<float>(part));
    }
    const int disparities = (kMost_px / part / 16 + 1) * 16;
    Tally tally;
    tally.add(match(small_left, small_right, disparities), truth_px, disparities);
    tally.print(("plant, 1/" + std::to_string(part)).c_str());
    EXPECT_LE(tally.ours.wrong, kMaxWrongRatio * tally.theirs.wrong);
    EXPECT_GE(tally.ours.density, tally.theirs.density - kSimilarDensity);
  }
}

}  // namespace
}  // namespace surefoot::real_data
