#include "core/registration/registration.h"

#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/registration_parts.h"
#include "tests/support/rocky_board.h"

namespace surefoot::registration {
namespace {

const Prior kPrior{.X_TS = {}, .sigma_m = 0.05, .sigma_rad = 0.05};

class RegistrationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const tests::RockyBoard board(3, {});
    Random random(3);
    first_ = board.scan(-0.6, 4000, random);
    second_ = board.scan(-0.3, 4000, random);
    ASSERT_TRUE(bench_.configure({}));
  }
  void fill_both() {
    bench_.fill(*bench_.target, first_);
    bench_.fill(*bench_.source, second_);
  }
  void expect_the_prior(const Prior& prior) {
    EXPECT_EQ(bench_.result.X_TS.origin.m, prior.X_TS.origin.m);
    EXPECT_EQ(bench_.result.X_TS.rotation.matrix, prior.X_TS.rotation.matrix);
    EXPECT_DOUBLE_EQ(bench_.result.covariance(0, 0), math::square(prior.sigma_m));
    EXPECT_DOUBLE_EQ(bench_.result.covariance(5, 5), math::square(prior.sigma_rad));
  }
  tests::Workbench bench_;
  std::vector<Vector3> first_;
  std::vector<Vector3> second_;
};

TEST_F(RegistrationTest, EmptyCloudsAreUnavailable) {
  bench_.fill(*bench_.source, {});
  bench_.fill(*bench_.target, {});
  EXPECT_EQ(bench_.align(kPrior), Status::kUnavailable);
  expect_the_prior(kPrior);
  ASSERT_TRUE(bench_.configure({}));
  bench_.fill(*bench_.source, first_);
  bench_.fill(*bench_.target, {});
  EXPECT_EQ(bench_.align(kPrior), Status::kUnavailable);
  ASSERT_TRUE(bench_.configure({}));
  bench_.fill(*bench_.source, {{0.1, 0.2, 0.3}});
  bench_.fill(*bench_.target, first_);
  EXPECT_EQ(bench_.align(kPrior), Status::kUnavailable);
  expect_the_prior(kPrior);
}

TEST_F(RegistrationTest, CloudsElsewhereAreNotFound) {
  bench_.fill(*bench_.target, first_);
  for (Vector3& p : second_) p += Vector3(10, 0, 0);
  bench_.fill(*bench_.source, second_);
  EXPECT_EQ(bench_.align(kPrior), Status::kNotFound);
  expect_the_prior(kPrior);
}

// Points all through a volume have no surface to align.
TEST_F(RegistrationTest, NothingButOutliersIsRefused) {
  bench_.fill(*bench_.target, first_);
  Random random(4);
  for (Vector3& p : second_) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(-0.6, 0.6);
  }
  bench_.fill(*bench_.source, second_);
  EXPECT_NE(bench_.align(kPrior), Status::kOk);
  expect_the_prior(kPrior);
}

TEST_F(RegistrationTest, AFifthOfOutliersDoesNotHarm) {
  Random random(5);
  const SourcePose truth = tests::random_motion(random, 0.016, 0.024);
  std::vector<Vector3> seen = tests::seen_from(truth, second_);
  for (int i = 0; i < 1000; ++i) {
    Vector3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(-0.6, 0.6);
    seen.push_back(p);
  }
  bench_.fill(*bench_.target, first_);
  bench_.fill(*bench_.source, seen);
  ASSERT_EQ(bench_.align(kPrior), Status::kOk);
  EXPECT_LT(tests::distance_m(bench_.result.X_TS, truth), 4e-3);
}

TEST_F(RegistrationTest, BadPriorsAreInvalidAndTouchNothing) {
  fill_both();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  bench_.result.iterations = 77;
  std::vector<Prior> bad(7, kPrior);
  bad[0].X_TS.origin.m.x() = nan;
  bad[1].X_TS.rotation.matrix(1, 1) = nan;
  bad[2].X_TS.rotation.matrix *= 1.1;
  bad[3].X_TS.rotation.matrix.col(0) *= -1;
  bad[4].sigma_m = 0;
  bad[5].sigma_rad = -1;
  bad[6].sigma_m = std::numeric_limits<double>::infinity();
  for (const Prior& prior : bad) EXPECT_EQ(bench_.align(prior), Status::kInvalid);
  EXPECT_EQ(bench_.result.iterations, 77);
}

TEST_F(RegistrationTest, CloudsOfAnotherCellSizeAreInvalid) {
  ASSERT_EQ(bench_.source->reset(0.05), Status::kOk);
  fill_both();
  EXPECT_EQ(bench_.align(kPrior), Status::kInvalid);
}

TEST_F(RegistrationTest, BadConfigurationsAreInvalid) {
  std::vector<RegistrationConfig> bad(13);
  bad[0].cell_m = 0;
  bad[1].cell_m = std::numeric_limits<double>::quiet_NaN();
  bad[2].max_iterations = {0, 0, 0, 0};
  bad[3].max_iterations = {kMaxIterations + 1, 1, 1, 1};
  bad[4].max_iterations = {-1, 1, 1, 1};
  bad[5].max_pairs = kMaxPairs + 1;
  bad[6].min_pairs = 5;
  bad[7].min_overlap = 1.1;
  bad[8].max_normal_angle_rad = 2;
  bad[9].outlier_sigma = 0;
  bad[10].min_information_ratio = 0.5;
  bad[11].gate_sigma = 0;
  bad[12].normal_error_rad = -0.1;
  for (const RegistrationConfig& config : bad) {
    EXPECT_EQ(bench_.aligner->configure(config), Status::kInvalid);
  }
  EXPECT_EQ(bench_.aligner->config().cell_m, RegistrationConfig{}.cell_m);
}

// A result that contradicts dead reckoning is not taken.
TEST_F(RegistrationTest, ResultsBeyondTheGateAreOutOfRange) {
  Random random(6);
  const SourcePose truth = tests::random_motion(random, 0.03, 0.01);
  bench_.fill(*bench_.target, first_);
  bench_.fill(*bench_.source, tests::seen_from(truth, second_));
  Prior sure = kPrior;
  sure.sigma_m = 0.005;
  EXPECT_EQ(bench_.align(sure), Status::kOutOfRange);
  expect_the_prior(sure);
  EXPECT_EQ(bench_.align(kPrior), Status::kOk);
}

// 100 m from the origin nothing changes but rounding.
TEST_F(RegistrationTest, FarFromTheOriginItIsTheSame) {
  Random random(7);
  const SourcePose truth = tests::random_motion(random, 0.016, 0.024);
  const Vector3 far(102.0 * 0.2, -204.0 * 0.2, 12.0 * 0.2);  // whole coarse cells
  bench_.fill(*bench_.target, first_);
  bench_.fill(*bench_.source, tests::seen_from(truth, second_));
  ASSERT_EQ(bench_.align(kPrior), Status::kOk);
  const SourcePose near = bench_.result.X_TS;
  ASSERT_TRUE(bench_.configure({}));
  for (Vector3& p : first_) p += far;
  bench_.fill(*bench_.target, first_);
  bench_.fill(*bench_.source, tests::seen_from(truth, second_));
  Prior prior = kPrior;
  prior.X_TS.origin.m = far;
  ASSERT_EQ(bench_.align(prior), Status::kOk);
  EXPECT_LT((bench_.result.X_TS.origin.m - far - near.origin.m).norm(), 1e-8);
  EXPECT_LT(tests::angle_rad(bench_.result.X_TS, near), 1e-8);
}

TEST_F(RegistrationTest, SameInputsGiveTheSameBits) {
  fill_both();
  ASSERT_EQ(bench_.align(kPrior), Status::kOk);
  const Registration once = bench_.result;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(bench_.configure({}));
    fill_both();
    ASSERT_EQ(bench_.align(kPrior), Status::kOk);
    EXPECT_EQ(bench_.result.X_TS.origin.m, once.X_TS.origin.m);
    EXPECT_EQ(bench_.result.X_TS.rotation.matrix, once.X_TS.rotation.matrix);
    EXPECT_EQ(bench_.result.covariance, once.covariance);
  }
}

TEST_F(RegistrationTest, StepsAreBounded) {
  RegistrationConfig config;
  config.max_iterations = {1, 1, 1, 1};
  ASSERT_TRUE(bench_.configure(config));
  Random random(8);
  bench_.fill(*bench_.target, first_);
  bench_.fill(*bench_.source, tests::seen_from(tests::random_motion(random, 0.03, 0.03), second_));
  ASSERT_EQ(bench_.align(kPrior), Status::kOk);
  EXPECT_LE(bench_.result.iterations, 4);
  EXPECT_FALSE(bench_.result.converged);
}

}  // namespace
}  // namespace surefoot::registration
