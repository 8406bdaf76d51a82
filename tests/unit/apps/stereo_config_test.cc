// A robot's stereo calibration: OpenCV's text, and everything that can be wrong with it.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "apps/common/config_root.h"
#include "tests/support/config_file.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;
using tests::replaced;

const fs::path kFolder = tests::config_folder();

class StereoConfig : public testing::Test {
 protected:
  // Issues of LittleDog's file with this calibration.
  std::string issues_with(const std::string& calibration, std::vector<std::string> sets = {}) {
    sets.push_back("robot.stereo_camera.calibration=" +
                   folder_.write("pair.yaml", calibration).string());
    RunRequest request;
    request.robot = "littledog";
    request.sets = sets;
    ConfigIssues issues;
    config_ = load_config_parts(request, kFolder, issues);
    return to_string(issues);
  }
  std::string edited(const std::string& from, const std::string& to) {
    return issues_with(replaced(good_, from, to));
  }

  const std::string good_ = tests::text_of(kFolder / "cameras/littledog_stereo.yaml");
  Config config_;

 private:
  tests::ScratchFolder folder_;
};

TEST_F(StereoConfig, ReadsWhatOpenCvWrites) {
  ASSERT_EQ(issues_with(good_), "");
  const robot::StereoCameraCalibration& c = config_.robot.stereo_camera.calibration;
  EXPECT_TRUE(config_.robot.stereo_camera.present);
  EXPECT_EQ(c.width_px, 320);
  EXPECT_EQ(c.height_px, 240);
  EXPECT_EQ(c.left.matrix[0], 209.6);
  EXPECT_EQ(c.right.matrix[5], 121.1);
  EXPECT_EQ(c.left.distortion[3], -0.0004);
  EXPECT_EQ(c.left.distortion[7], 0.0);  // five in the file
  EXPECT_EQ(c.p_EV_m[0], -0.07);
}

TEST_F(StereoConfig, ItsCanonicalTextReadsBack) {
  ASSERT_EQ(issues_with(good_), "");
  RunRequest request;
  ConfigIssues issues;
  Config again;
  read_record_text(record_text(request, config_), request, again, issues);
  EXPECT_EQ(config_text(again), config_text(config_));
  EXPECT_EQ(again.robot.stereo_camera.calibration.R_EV,
            config_.robot.stereo_camera.calibration.R_EV);
}

TEST_F(StereoConfig, ARobotWithoutOneKeepsItsText) {
  RunRequest request;
  request.robot = "mini_cheetah";
  ConfigIssues issues;
  const Config config = load_config_parts(request, kFolder, issues);
  EXPECT_FALSE(config.robot.stereo_camera.present);
  EXPECT_EQ(config_text(config).find("stereo"), std::string::npos);
}

TEST_F(StereoConfig, NamesFileLineAndKey) {
  const std::string text = edited("rows: 3\n   cols: 3", "rows: 3\n   cols: 4");
  EXPECT_NE(text.find("pair.yaml:"), std::string::npos) << text;
  EXPECT_NE(text.find("robot.stereo_camera.calibration.camera_matrix_left"), std::string::npos);
  EXPECT_NE(text.find("wrong size: 9 numbers for 3 x 4"), std::string::npos) << text;
}

TEST_F(StereoConfig, RefusesWhatIsMissingOrNoPair) {
  const struct {
    std::string from;
    std::string to;
    std::string message;
  } cases[] = {
      {"image_width: 320", "picture_width: 320", "image_width: missing"},
      {"\nR: ", "\nQ: ", "calibration.R: missing"},
      {"\nT: ", "\nU: ", "calibration.T: missing"},
      {"distortion_coefficients_right", "d_right", "distortion_coefficients_right: missing"},
      {"image_width: 320", "image_width: 2000", "2000 is out of range"},
      {"209.6", "nan", "is not a finite number"},
      {"209.6", "0.0", "singular"},
      {"[ 209.6, 0.0", "[ 209.6, 4.0", "no camera matrix"},
      {"-0.07,", "0.07,", "swapped?"},
      {"-0.07,", "0.0,", "no baseline"},
      {"rows: 1\n   cols: 5", "rows: 1\n   cols: 6", "wrong size: 5 numbers for 1 x 6"},
      {"camera_matrix_left: !!opencv-matrix",
       "camera_matrix_left: 7\nx: ", "expected a matrix of rows, cols and data"},
      {"image_height: 240", "image_height: [", "not valid YAML"},
  };
  for (const auto& c : cases) {
    const std::string text = edited(c.from, c.to);
    EXPECT_NE(text.find(c.message), std::string::npos) << c.from << ": " << text;
    EXPECT_NE(text.find("pair.yaml"), std::string::npos) << text;
  }
}

TEST_F(StereoConfig, RefusesARotationThatIsNone) {
  const std::size_t at = good_.find("R: !!");
  const std::size_t data = good_.find("[ 0.99", at);
  ASSERT_NE(data, std::string::npos);
  std::string text = good_;
  text.replace(data, 6, "[ 0.89");
  const std::string issues = issues_with(text);
  EXPECT_NE(issues.find("no rotation"), std::string::npos) << issues;
}

TEST_F(StereoConfig, RefusesGroupsThatDoNotFit) {
  const struct {
    std::string set;
    std::string message;
  } cases[] = {
      {"robot.stereo_camera.min_range_m=1.5", "min_range_m: not below max_range_m"},
      {"robot.depth_camera.rate_Hz=30", "the map is made from the stereo camera"},
      {"stereo.matcher.disparities=40", "multiple of 16"},
      {"stereo.shrink=9", "9 is out of range"},
  };
  for (const auto& c : cases) {
    const std::string text = issues_with(good_, {c.set});
    EXPECT_NE(text.find(c.message), std::string::npos) << text;
  }
}

TEST_F(StereoConfig, RefusesASecondOdometerBesideTheCamera) {
  const struct {
    std::string set;
    std::string message;
  } cases[] = {
      {"robot.tracking_camera.rate_Hz=200", "the stereo camera is the odometer"},
      {"visual_odometry.camera.min_disparity_px=65", "not below max_disparity_px"},
      {"visual_odometry.fusion.gate_sigma=0", "0 is out of range"},
      {"robot.tracking_camera.rate_Hz=0", ""},
  };
  for (const auto& c : cases) {
    RunRequest request;
    request.robot = "bigdog";
    request.sets = {c.set};
    ConfigIssues issues;
    load_config_parts(request, kFolder, issues);
    const std::string text = to_string(issues);
    EXPECT_EQ(text.empty(), c.message.empty()) << text;
    EXPECT_NE(text.find(c.message), std::string::npos) << text;
  }
}

TEST_F(StereoConfig, AFileThatDoesNotExistIsNamed) {
  RunRequest request;
  request.robot = "littledog";
  request.sets = {"robot.stereo_camera.calibration=nowhere.yaml"};
  ConfigIssues issues;
  load_config_parts(request, kFolder, issues);
  EXPECT_NE(to_string(issues).find("nowhere.yaml does not exist"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::apps
