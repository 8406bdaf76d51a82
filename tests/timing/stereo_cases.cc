// Stereo: one pair of the reference size. The matcher's work does not depend on what it sees but
// for the speckle filter, which has most to join where everything is one surface.
#include "core/autonomy/stereo_task.h"
#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/stereo/matcher.h"
#include "core/stereo/point_cloud.h"
#include "core/stereo/rectifier.h"
#include "core/visual_odometry/visual_odometry.h"
#include "tests/support/stereo_setup.h"
#include "tests/support/textured_scene.h"
#include "tests/support/visual_odometry_setup.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

constexpr std::uint16_t kWidth_px = 320;
constexpr std::uint16_t kHeight_px = 240;
constexpr int kDisparity_px = 20;
constexpr int kNear_px = 40;  // within LittleDog's range

class Stereo : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    stereo::StereoCalibration cameras;
    for (stereo::CameraModel* camera : {&cameras.left, &cameras.right}) {
      *camera = {kWidth_px, kHeight_px, 260.0, 260.0, 159.5, 119.5, {}};
    }
    cameras.p_EV_m = Vector3(-0.06, 0.0, 0.0);
    stereo::RectifiedPair pair;
    SUREFOOT_ASSERT(ok(stereo::rectify(cameras, kWidth_px, kHeight_px, 0.0, pair)));
    SUREFOOT_ASSERT(ok(rectifier_.configure(cameras, pair)));
    SUREFOOT_ASSERT(ok(matcher_.configure(tests::recommended_matcher())));
    draw();
    return true;
  }

 protected:
  void rectify() {
    SUREFOOT_ASSERT(ok(rectifier_.run(left_.view(), right_.view(), flat_left_, flat_right_)));
  }
  void match() {
    SUREFOOT_ASSERT(
        ok(matcher_.match(flat_left_.view(), flat_right_.view(), disparities_, &report_)));
  }

  stereo::Rectifier rectifier_;
  stereo::Matcher matcher_;
  stereo::GreyImage left_;
  stereo::GreyImage right_;
  stereo::GreyImage flat_left_;
  stereo::GreyImage flat_right_;
  stereo::DisparityImage disparities_;
  stereo::MatchReport report_;

 private:
  // Random texture on a plane across the view.
  void draw() {
    Random random(1);
    for (stereo::GreyImage* image : {&left_, &right_}) {
      image->width_px = kWidth_px;
      image->height_px = kHeight_px;
    }
    for (std::size_t i = 0; i < left_.view().pixel_count(); ++i) {
      left_.pixels[i] = static_cast<std::uint8_t>(random.below(256));
      right_.pixels[i] = static_cast<std::uint8_t>(random.below(256));
      if (i >= kDisparity_px) right_.pixels[i - kDisparity_px] = left_.pixels[i];
    }
  }
};

class StereoMatch final : public Stereo {
 public:
  bool prepare(std::size_t round) override {
    if (!Stereo::prepare(round)) return false;
    rectify();
    return true;
  }
  void run() override { match(); }
  bool did_the_work() override { return report_.matched > 60000; }
};

class StereoRest final : public Stereo {
 public:
  bool prepare(std::size_t round) override {
    if (!Stereo::prepare(round)) return false;
    rectify();
    match();
    return true;
  }
  void run() override {
    rectify();
    cleared_ = rectifier_.clear_unseen(3, disparities_);
    status_ =
        stereo::make_points(disparities_, rectifier_.pair(), tests::recommended_points(), cloud_);
  }
  bool did_the_work() override { return ok(status_) && cleared_ > 0 && cloud_.size() > 55000; }

 private:
  std::uint32_t cleared_ = 0;
  Status status_ = Status::kNotFound;
  stereo::PointCloud cloud_;
};

// The whole stereo task of the robot that has one: 320 x 240 pixels, 112 disparities.
class StereoTaskCase final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::RunRequest request{"littledog", "flat", "cross", "sim", 1, {}};
    apps::ConfigIssues issues;
    const apps::Config config = apps::load_config(request, SUREFOOT_SOURCE_DIR "/config", issues);
    SUREFOOT_ASSERT(issues.empty());
    SUREFOOT_ASSERT(ok(task_.reset(config.robot.stereo_camera, config.autonomy.stereo, {}, true)));
    pair_.width_px = kWidth_px;
    pair_.height_px = kHeight_px;
    // Columns of a coarse random pattern: what lenses and turn move from row to row, and by parts
    // of a pixel, still matches.
    Random random(1);
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    for (std::size_t u = 0; u < kWidth_px; ++u) {
      const std::uint32_t part = u % 4;
      if (part == 0) {
        from = to;
        to = random.below(256);
      }
      const auto grey = static_cast<std::uint8_t>((from * (4 - part) + to * part) / 4);
      for (std::size_t v = 0; v < kHeight_px; ++v) {
        pair_.left[v * kWidth_px + u] = grey;
        if (u >= kNear_px) pair_.right[v * kWidth_px + u - kNear_px] = grey;
      }
    }
    SUREFOOT_ASSERT(task_.release(pair_, autonomy::PoseHistory{}));
    return true;
  }
  void run() override {
    task_.run();
    task_.publish();
  }
  bool did_the_work() override { return task_.valid_share() > 0.5; }

 private:
  autonomy::StereoTask task_;
  hal::StereoFrame pair_;
};

// A pair after the keyframe's, 10 cm farther on: disparities by the right picture, match, clique,
// tracking, motion.
class VisualOdometryCase final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    SUREFOOT_ASSERT(ok(odometry_.configure(tests::recommended_visual_odometry(), pair_)));
    const tests::StereoPictures first = render(0.0);
    second_ = render(kStep_m);
    SUREFOOT_ASSERT(ok(odometry_.update(seen(first, 1), {}, motion_)));
    prediction_.p_PN_m = start().R_WN.transpose() * Vector3(kStep_m, 0, 0);
    return true;
  }
  void run() override {
    SUREFOOT_ASSERT(ok(odometry_.update(seen(second_, 2), prediction_, motion_)));
  }
  bool did_the_work() override {
    return motion_.status == visual_odometry::MotionStatus::kOk && motion_.inliers > 100;
  }

 private:
  static constexpr double kStep_m = 0.1;

  static tests::CameraPlace start() {
    return tests::walking_camera(Vector3(0, 0, 0.45), 0.0, 0.5, 0.0);
  }
  tests::StereoPictures render(double x_m) const {
    tests::CameraPlace place = start();
    place.p_WN_m[0] += x_m;
    return scene_.render(pair_, place, tests::Exposure{});
  }
  static visual_odometry::Pictures seen(const tests::StereoPictures& pictures, int second) {
    return {milliseconds(1000 * second), pictures.left_view(), pictures.right_view(), nullptr};
  }

  stereo::RectifiedPair pair_ = tests::small_pair();
  tests::TexturedScene scene_{1, 160, 12};
  tests::StereoPictures second_;
  visual_odometry::VisualOdometry odometry_;
  visual_odometry::Prediction prediction_;
  visual_odometry::Motion motion_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kStereoCases[] = {
    {"stereo_match", "matching, 320 x 240 pixels, 64 disparities, all matched", make<StereoMatch>},
    {"stereo_rest", "rectification and points of such a pair", make<StereoRest>},
    {"stereo_task", "the stereo task: LittleDog's pair, 112 disparities", make<StereoTaskCase>},
    {"visual_odometry", "a pair's motion from its keyframe, 320 x 240 pixels",
     make<VisualOdometryCase>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
