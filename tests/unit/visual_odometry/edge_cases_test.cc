// What must not be taken for a motion, and what is refused.
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/visual_odometry/visual_odometry.h"
#include "tests/support/textured_scene.h"
#include "tests/support/visual_odometry_setup.h"

namespace surefoot::tests {
namespace {

using visual_odometry::Motion;
using visual_odometry::MotionStatus;
using visual_odometry::Pictures;
using visual_odometry::Prediction;

class EdgeCases : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(odometry_->configure(recommended_visual_odometry(), pair_), Status::kOk);
  }

  Motion see(const StereoPictures& pictures, const Prediction& prediction = {}) {
    stamp_ns_ += 80'000'000;
    const Pictures input{TimeNs{stamp_ns_}, pictures.left_view(), pictures.right_view(), nullptr};
    Motion motion;
    EXPECT_EQ(odometry_->update(input, prediction, motion), Status::kOk);
    EXPECT_TRUE(math::is_finite(motion.p_KN_m.sum()) && math::is_finite(motion.R_KN.sum()) &&
                math::is_finite(motion.covariance.sum()));
    EXPECT_EQ(motion.to, TimeNs{stamp_ns_});
    return motion;
  }

  StereoPictures plain(std::uint8_t grey) const {
    StereoPictures pictures;
    pictures.width_px = pair_.width_px;
    pictures.height_px = pair_.height_px;
    pictures.left.assign(std::size_t{pair_.width_px} * pair_.height_px, grey);
    pictures.right = pictures.left;
    return pictures;
  }

  StereoPictures noise(std::uint64_t seed) const {
    StereoPictures pictures = plain(0);
    Random random(seed);
    for (std::uint8_t& grey : pictures.left) grey = static_cast<std::uint8_t>(random.below(256));
    for (std::uint8_t& grey : pictures.right) grey = static_cast<std::uint8_t>(random.below(256));
    return pictures;
  }

  static CameraPlace at(double x_m, double yaw_rad = 0) {
    return walking_camera(Vector3(x_m, 0, 0.45), yaw_rad, 0.5, 0);
  }

  stereo::RectifiedPair pair_ = small_pair();
  TexturedScene scene_{3, 160, 8};
  std::unique_ptr<visual_odometry::VisualOdometry> odometry_ =
      std::make_unique<visual_odometry::VisualOdometry>();
  std::int64_t stamp_ns_ = 0;
};

TEST_F(EdgeCases, DarkAndPlainPicturesHaveTooFewFeatures) {
  EXPECT_EQ(see(plain(0)).status, MotionStatus::kTooFewFeatures);
  EXPECT_FALSE(odometry_->has_keyframe());
  const StereoPictures first = scene_.render(pair_, at(0), {});
  EXPECT_EQ(see(first).status, MotionStatus::kFirst);
  for (const int grey : {0, 128, 255}) {
    const Motion motion = see(plain(static_cast<std::uint8_t>(grey)));
    EXPECT_EQ(motion.status, MotionStatus::kTooFewFeatures);
    EXPECT_FALSE(motion.new_keyframe);
  }
}

TEST_F(EdgeCases, TheKeyframeOutlastsADarkPicture) {
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  EXPECT_EQ(see(plain(0)).status, MotionStatus::kTooFewFeatures);
  const Motion motion = see(scene_.render(pair_, at(0.03), {}));
  EXPECT_EQ(motion.status, MotionStatus::kOk);
  EXPECT_EQ(motion.from, TimeNs{80'000'000});
  EXPECT_NEAR(motion.p_KN_m.norm(), 0.03, 0.0006);
}

TEST_F(EdgeCases, AnotherSceneIsInconsistentAndThenTheKeyframe) {
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  const TexturedScene other(77, 160, 8);
  const StereoPictures elsewhere = other.render(pair_, at(0), {});
  for (int i = 0; i < recommended_visual_odometry().max_failures; ++i) {
    const Motion motion = see(elsewhere);
    EXPECT_EQ(motion.status, MotionStatus::kInconsistent);
    EXPECT_FALSE(motion.new_keyframe);
  }
  EXPECT_TRUE(see(elsewhere).new_keyframe);
  EXPECT_EQ(see(elsewhere).status, MotionStatus::kOk);
}

TEST_F(EdgeCases, NoiseIsNoMotion) {
  const MotionStatus first = see(noise(1)).status;
  EXPECT_EQ(first, MotionStatus::kTooFewFeatures);
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    EXPECT_NE(see(noise(seed)).status, MotionStatus::kOk);
  }
}

TEST_F(EdgeCases, AHugeMotionIsNotInvented) {
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  EXPECT_EQ(see(scene_.render(pair_, at(0.9), {})).status, MotionStatus::kInconsistent);
  EXPECT_EQ(see(scene_.render(pair_, at(0, 0.7), {})).status, MotionStatus::kInconsistent);
}

TEST_F(EdgeCases, AQuickTurnThatTheGyroKnowsIsFollowed) {
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  Prediction prediction;
  prediction.R_PN = at(0).R_WN.transpose() * at(0, 0.3).R_WN;
  const Motion motion = see(scene_.render(pair_, at(0.01, 0.3), {}), prediction);
  ASSERT_EQ(motion.status, MotionStatus::kOk);
  const Vector3 off = geometry::to_rotation_vector(motion.R_KN * prediction.R_PN.transpose());
  EXPECT_LT(off.norm(), 0.002);
}

TEST_F(EdgeCases, ATurnThatTheGyroDeniesIsInconsistent) {
  EXPECT_EQ(see(scene_.render(pair_, at(0), {})).status, MotionStatus::kFirst);
  Prediction prediction;
  prediction.R_PN = geometry::rotation_z(0.045);
  EXPECT_EQ(see(scene_.render(pair_, at(0), {}), prediction).status, MotionStatus::kInconsistent);
}

TEST_F(EdgeCases, RefusesWhatIsNoInput) {
  const StereoPictures pictures = scene_.render(pair_, at(0), {});
  EXPECT_EQ(see(pictures).status, MotionStatus::kFirst);
  const Pictures good{TimeNs{1'000'000'000}, pictures.left_view(), pictures.right_view(), nullptr};
  Motion motion;
  const auto refused = [&](const Pictures& input, const Prediction& prediction) {
    return odometry_->update(input, prediction, motion) == Status::kInvalid;
  };
  Pictures input = good;
  input.stamp = TimeNs{stamp_ns_};
  EXPECT_TRUE(refused(input, {})) << "not after the last one";
  input = good;
  input.left.width_px = 319;
  EXPECT_TRUE(refused(input, {}));
  input = good;
  input.right.pixels = nullptr;
  EXPECT_TRUE(refused(input, {}));
  Prediction prediction;
  prediction.R_PN *= 1.01;
  EXPECT_TRUE(refused(good, prediction));
  prediction.R_PN = Matrix3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(refused(good, prediction));
  prediction = {};
  prediction.p_PN_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(good, prediction));
  EXPECT_FALSE(refused(good, {})) << "nothing has changed";
}

TEST_F(EdgeCases, RefusesBadConfigurations) {
  visual_odometry::VisualOdometryConfig config = recommended_visual_odometry();
  config.min_disparity_px = 65;
  EXPECT_EQ(odometry_->configure(config, pair_), Status::kInvalid);
  config = recommended_visual_odometry();
  config.gate_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(odometry_->configure(config, pair_), Status::kInvalid);
  stereo::RectifiedPair pair = pair_;
  pair.baseline_m = 0;
  EXPECT_EQ(odometry_->configure(recommended_visual_odometry(), pair), Status::kInvalid);
  EXPECT_EQ(odometry_->configure({}, pair_), Status::kInvalid);
}

TEST_F(EdgeCases, SameBitsTwice) {
  const StereoPictures a = scene_.render(pair_, at(0), {});
  const StereoPictures b = scene_.render(pair_, at(0.02), {});
  const auto run = [&] {
    EXPECT_EQ(odometry_->configure(recommended_visual_odometry(), pair_), Status::kOk);
    EXPECT_EQ(see(a).status, MotionStatus::kFirst);
    return see(b);
  };
  const Motion first = run();
  const Motion second = run();
  EXPECT_EQ(first.p_KN_m, second.p_KN_m);
  EXPECT_EQ(first.R_KN, second.R_KN);
  EXPECT_EQ(first.covariance, second.covariance);
}

}  // namespace
}  // namespace surefoot::tests
