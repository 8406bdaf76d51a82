#include "core/autonomy/own_gaits.h"

#include <gtest/gtest.h>

namespace surefoot::autonomy {
namespace {

constexpr double kStep_s = 0.002;

TEST(OwnGaits, StandsOnceTheBodySaysSoAndIsSilentWhenNothingComes) {
  OwnGaits gaits;
  gaits.reset(true, 0.05);
  gaits.update(nullptr, false, kStep_s);
  EXPECT_FALSE(gaits.standing());
  hal::GaitSample sample;
  sample.standing = true;
  sample.height_m = 0.3;
  gaits.update(&sample, true, kStep_s);
  EXPECT_TRUE(gaits.standing());
  EXPECT_FALSE(gaits.fallen());
  EXPECT_EQ(gaits.height_m(), 0.3);
  for (int i = 0; i < 24; ++i) gaits.update(&sample, false, kStep_s);
  EXPECT_FALSE(gaits.silent());
  for (int i = 0; i < 2; ++i) gaits.update(&sample, false, kStep_s);
  EXPECT_TRUE(gaits.silent());
  EXPECT_FALSE(gaits.standing());
  gaits.update(&sample, true, kStep_s);
  EXPECT_FALSE(gaits.silent());
}

TEST(OwnGaits, PassesVelocitiesOnWhileItWalks) {
  OwnGaits gaits;
  gaits.reset(true, 0.05);
  const control::VelocityCommand velocity{0.5, -0.1, 0.3};
  const hal::GaitCommand walks = gaits.command(control::GaitKind::kTrot, velocity);
  EXPECT_TRUE(walks.walk);
  EXPECT_EQ(walks.forward_m_s, 0.5);
  EXPECT_EQ(walks.left_m_s, -0.1);
  EXPECT_EQ(walks.yaw_rate_rad_s, 0.3);
  const hal::GaitCommand stands = gaits.command(control::GaitKind::kStand, velocity);
  EXPECT_FALSE(stands.walk);
  EXPECT_EQ(stands.forward_m_s, 0.0);
}

TEST(OwnGaits, OffItIsNeitherSilentNorStanding) {
  OwnGaits gaits;
  gaits.reset(false, 0.05);
  hal::GaitSample sample;
  sample.standing = true;
  sample.fallen = true;
  for (int i = 0; i < 100; ++i) gaits.update(&sample, false, kStep_s);
  EXPECT_FALSE(gaits.silent());
  EXPECT_FALSE(gaits.standing());
  EXPECT_FALSE(gaits.fallen());
}

}  // namespace
}  // namespace surefoot::autonomy
