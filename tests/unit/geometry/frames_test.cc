#include "core/geometry/frames.h"

#include <gtest/gtest.h>

#include "core/math/elementary.h"
#include "tests/unit/geometry/random_rotations.h"

namespace surefoot::geometry {
namespace {

Pose<Odometry, Body> random_pose(Random& random) {
  Pose<Odometry, Body> pose;
  pose.rotation.matrix = random_rotation(random);
  pose.origin.m = random_vector(random, 10);
  return pose;
}

TEST(Frames, APoseTurnsThenShifts) {
  Pose<Odometry, Body> X_OB;
  X_OB.rotation.matrix = rotation_z(math::kPi / 2);
  X_OB.origin.m = {10, 20, 30};
  const Point<Odometry> p = X_OB * Point<Body>{{1, 2, 3}};
  EXPECT_LT(distance(p.m, Vector3(8, 21, 33)), 1e-14);
  const Vector<Odometry> v = X_OB * Vector<Body>{{1, 2, 3}};
  EXPECT_LT(distance(v.v, Vector3(-2, 1, 3)), 1e-15);
}

TEST(Frames, PointsAndVectorsFollowAffineRules) {
  const Point<Body> a{{1, 2, 3}};
  const Point<Body> b{{4, 4, 4}};
  const Vector<Body> ab = b - a;
  EXPECT_EQ((a + ab).m, b.m);
  EXPECT_EQ((b - ab).m, a.m);
  EXPECT_EQ((ab * 2.0 - ab).v, ab.v);
  EXPECT_EQ((ab + ab).v, (ab * 2.0).v);
}

TEST(Frames, InverseUndoesAndChainsAssociate) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Pose<Odometry, Body> X_OB = random_pose(random);
    Pose<Body, DepthCamera> X_BC;
    X_BC.rotation.matrix = random_rotation(random);
    X_BC.origin.m = random_vector(random, 1);
    const Point<DepthCamera> p_C{random_vector(random, 5)};

    EXPECT_LT(distance(((X_OB * X_BC) * p_C).m, (X_OB * (X_BC * p_C)).m), 1e-13);
    EXPECT_LT(distance((X_BC.inverse() * (X_BC * p_C)).m, p_C.m), 1e-13);
    const Pose<Odometry, Odometry> identity = X_OB * X_OB.inverse();
    EXPECT_LT(distance(identity.rotation.matrix, Matrix3::Identity()), 1e-14);
    EXPECT_LT(identity.origin.m.norm(), 1e-13);
    const Pose<DepthCamera, Odometry> back = (X_OB * X_BC).inverse();
    const Pose<DepthCamera, Odometry> parts = X_BC.inverse() * X_OB.inverse();
    EXPECT_LT(distance(back.origin.m, parts.origin.m), 1e-13);
    EXPECT_LT(distance(back.rotation.matrix, parts.rotation.matrix), 1e-14);
  }
}

}  // namespace
}  // namespace surefoot::geometry
