// The stereo camera as an odometer: which pair belongs to which trigger, and what is predicted.
#include "core/autonomy/camera_motion.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/samples.h"
#include "tests/support/textured_scene.h"
#include "tests/support/visual_odometry_setup.h"

namespace surefoot::autonomy {
namespace {

constexpr TimeNs kPeriod = milliseconds(200);
constexpr TimeNs kDelay = milliseconds(3);  // from the trigger to the exposure
constexpr double kSpeed_m_s = 0.4;

// A robot that is nothing but a camera: B and N are the same.
tests::CameraPlace camera_at(TimeNs stamp) {
  const double t_s = stamp.seconds();
  return tests::walking_camera(Vector3(kSpeed_m_s * t_s, 0, 0.45), 0.1 * t_s, 0.5, 0.0);
}

class Camera : public testing::Test {
 protected:
  Camera() {
    config_.present = true;
    config_.camera = tests::recommended_visual_odometry();
    EXPECT_EQ(motion_->reset(config_, tests::small_pair(), CameraInBody{}), Status::kOk);
  }

  // The poses that legs and gyro know, 5 % off, up to a time.
  void know_poses(TimeNs until) {
    for (; known_ <= until; known_ = known_ + milliseconds(2)) {
      const tests::CameraPlace place = camera_at(known_);
      estimation::RobotState state;
      state.stamp = known_;
      state.p_OB_m = 1.05 * place.p_WN_m;
      state.q_OB = geometry::to_quaternion(place.R_WN);
      history_->push(state);
    }
  }

  // A pair that was asked for at `trigger`; what came of it.
  estimation::VisualMotion pair(TimeNs trigger, TimeNs exposed) {
    know_poses(exposed + milliseconds(40));
    motion_->note_trigger(trigger);
    motion_->release(exposed, *history_);
    const tests::StereoPictures pictures =
        scene_.render(tests::small_pair(), camera_at(exposed), tests::Exposure{});
    motion_->run(pictures.left_view(), pictures.right_view(), nullptr);
    return motion_->publish();
  }

  const CameraMotionCounters& counters() const { return motion_->counters(); }

  CameraMotionConfig config_;
  std::unique_ptr<CameraMotion> motion_ = std::make_unique<CameraMotion>();
  std::unique_ptr<PoseHistory> history_ = std::make_unique<PoseHistory>();
  tests::TexturedScene scene_{3, 160, 12};
  TimeNs known_ = milliseconds(900);
};

TEST_F(Camera, MotionsAreStampedWithTheTicksThatAskedForThem) {
  TimeNs trigger = milliseconds(1000);
  const estimation::VisualMotion first = pair(trigger, trigger + kDelay);
  EXPECT_FALSE(first.valid);
  EXPECT_TRUE(first.new_keyframe);
  EXPECT_EQ(first.to, trigger);
  TimeNs keyframe = trigger;
  for (int i = 0; i < tests::samples(6, 2); ++i) {
    trigger = trigger + kPeriod;
    const estimation::VisualMotion motion = pair(trigger, trigger + kDelay);
    ASSERT_TRUE(motion.valid);
    EXPECT_EQ(motion.from, keyframe);
    EXPECT_EQ(motion.to, trigger);
    const tests::CameraPlace key = camera_at(keyframe + kDelay);
    const tests::CameraPlace now = camera_at(trigger + kDelay);
    const Vector3 p_KN_m = key.R_WN.transpose() * (now.p_WN_m - key.p_WN_m);
    EXPECT_LT((motion.p_KN_m - p_KN_m).norm(), 0.002);
    EXPECT_GT(motion.covariance.trace(), 0.0);
    if (motion.new_keyframe) keyframe = trigger;
  }
  EXPECT_EQ(counters().first, 1U);
  EXPECT_EQ(counters().motions, static_cast<std::uint64_t>(tests::samples(6, 2)));
  // Told once.
  EXPECT_FALSE(motion_->publish().valid);
}

TEST_F(Camera, APairThatNobodyAskedForIsCounted) {
  const TimeNs trigger = milliseconds(1000);
  EXPECT_FALSE(pair(trigger, trigger + milliseconds(21)).new_keyframe);
  EXPECT_FALSE(pair(trigger, trigger - milliseconds(2)).new_keyframe);
  EXPECT_EQ(counters().without_pose, 2U);
  EXPECT_EQ(counters().first, 0U);
}

TEST_F(Camera, APairWithoutAPoseOrFromThePastIsCounted) {
  EXPECT_FALSE(pair(milliseconds(500), milliseconds(503)).new_keyframe);
  EXPECT_EQ(counters().without_pose, 1U);
  EXPECT_TRUE(pair(milliseconds(1000), milliseconds(1003)).new_keyframe);
  EXPECT_FALSE(pair(milliseconds(1000), milliseconds(1003)).new_keyframe);
  EXPECT_EQ(counters().late, 1U);
}

TEST_F(Camera, AfterAGapOrAFallAKeyframeBegins) {
  EXPECT_TRUE(pair(milliseconds(1000), milliseconds(1003)).new_keyframe);
  // Longer than the history.
  EXPECT_TRUE(pair(milliseconds(3000), milliseconds(3003)).new_keyframe);
  motion_->forget();
  EXPECT_TRUE(pair(milliseconds(3200), milliseconds(3203)).new_keyframe);
  EXPECT_EQ(counters().first, 3U);
  EXPECT_EQ(counters().motions, 0U);
}

TEST_F(Camera, WithoutAConfigurationItDoesNothing) {
  EXPECT_EQ(motion_->reset({}, tests::small_pair(), CameraInBody{}), Status::kOk);
  EXPECT_FALSE(motion_->enabled());
  EXPECT_FALSE(pair(milliseconds(1000), milliseconds(1003)).new_keyframe);
  EXPECT_EQ(counters().without_pose + counters().first, 0U);
  config_.camera.min_inliers = 0;
  EXPECT_EQ(motion_->reset(config_, tests::small_pair(), CameraInBody{}), Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::autonomy
