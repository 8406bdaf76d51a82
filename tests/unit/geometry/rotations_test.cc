#include "core/geometry/rotations.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.h"
#include "tests/unit/geometry/random_rotations.h"

namespace surefoot::geometry {
namespace {

using math::kPi;

double quaternion_distance(const Quaternion& a, const Quaternion& b) {
  const double same = std::max(
      {std::fabs(a.w - b.w), std::fabs(a.x - b.x), std::fabs(a.y - b.y), std::fabs(a.z - b.z)});
  const double opposite = std::max(
      {std::fabs(a.w + b.w), std::fabs(a.x + b.x), std::fabs(a.y + b.y), std::fabs(a.z + b.z)});
  return std::min(same, opposite);
}

void expect_rotation(const Matrix3& r) {
  EXPECT_LT(distance(r * r.transpose(), Matrix3::Identity()), 3e-15);
  EXPECT_NEAR(r.determinant(), 1.0, 3e-15);
}

TEST(Rotations, AgreeWithEigenAsOracle) {
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const Vector3 vector_rad = random_vector(random, 3);
    const Matrix3 oracle =
        Eigen::AngleAxisd(vector_rad.norm(), vector_rad.normalized()).toRotationMatrix();
    EXPECT_LT(distance(to_matrix(from_rotation_vector(vector_rad)), oracle), 2e-15);
    const Quaternion a = random_quaternion(random);
    const Quaternion b = random_quaternion(random);
    const Quaternion ab = a * b;
    const Eigen::Quaterniond e =
        Eigen::Quaterniond(a.w, a.x, a.y, a.z) * Eigen::Quaterniond(b.w, b.x, b.y, b.z);
    EXPECT_LT(quaternion_distance(ab, {e.w(), e.x(), e.y(), e.z()}), 1e-15);
    const double roll = random.uniform(-kPi, kPi);
    const double pitch = random.uniform(-kPi / 2, kPi / 2);
    const double yaw = random.uniform(-kPi, kPi);
    const Matrix3 euler =
        (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
         Eigen::AngleAxisd(roll, Vector3::UnitX()))
            .toRotationMatrix();
    EXPECT_LT(distance(from_roll_pitch_yaw(roll, pitch, yaw), euler), 2e-15);
  }
}

TEST(Rotations, AreToldFromOtherMatrices) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Matrix3 r = to_matrix(random_quaternion(random));
    EXPECT_TRUE(is_rotation(r, 1e-14));
    EXPECT_FALSE(is_rotation(-r, 1e-3));  // a reflection
    const auto row = static_cast<int>(random.below(3));
    const auto column = static_cast<int>(random.below(3));
    // An entry off by e moves R' R by e times the entries of its row, the largest at least 0.57.
    for (const double off : {1e-4, -1e-4}) {
      Matrix3 wrong = r;
      wrong(row, column) += off;
      EXPECT_TRUE(is_rotation(wrong, 2.1e-4));
      EXPECT_FALSE(is_rotation(wrong, 0.5e-4));
    }
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e200}) {
      Matrix3 wrong = r;
      wrong(row, column) = bad;
      EXPECT_FALSE(is_rotation(wrong, 1.0));
    }
  }
  EXPECT_FALSE(is_rotation(Matrix3::Zero(), 1e-3));
  EXPECT_FALSE(is_rotation(1.01 * Matrix3::Identity(), 1e-2));
}

TEST(Rotations, QuaternionsAndMatricesRoundTrip) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const Quaternion q = random_quaternion(random);
    const Matrix3 r = to_matrix(q);
    expect_rotation(r);
    const Quaternion back = to_quaternion(r);
    EXPECT_GE(back.w, 0.0);
    EXPECT_LT(quaternion_distance(back, q), 1e-15);
  }
}

TEST(Rotations, HalfTurnsAboutEveryAxisConvertBack) {
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    // Half turns up to a rounding: w is nearly 0, each of x, y, z takes its turn as the largest.
    const Vector3 axis = random_vector(random, 1).normalized();
    const double angle = kPi - (i % 4) * 1e-9;
    const Matrix3 r = to_matrix(from_rotation_vector(axis * angle));
    const Vector3 back = to_rotation_vector(r);
    EXPECT_NEAR(back.norm(), angle, 3e-15);
    EXPECT_LE(back.norm(), kPi + 1e-15);
    EXPECT_LT(distance(to_matrix(from_rotation_vector(back)), r), 3e-15);
  }
}

TEST(Rotations, RotationVectorsRoundTripOverAllMagnitudes) {
  Random random(4);
  for (int exponent = -320; exponent <= 0; ++exponent) {
    for (int i = 0; i < 20; ++i) {
      const Vector3 vector_rad = random_vector(random, 1) * std::pow(10.0, exponent);
      const Vector3 back = to_rotation_vector(to_matrix(from_rotation_vector(vector_rad)));
      // The matrix holds 1 - angle^2 / 2, but the small entries carry the vector itself.
      EXPECT_LE(distance(back, vector_rad), 1e-15 * vector_rad.norm() + 1e-323) << exponent;
    }
  }
  EXPECT_EQ(to_rotation_vector(Matrix3::Identity()), Vector3(0, 0, 0));
}

TEST(Rotations, LargeRotationVectorsWrap) {
  const Vector3 axis = Vector3(1, -2, 0.5).normalized();
  const Matrix3 small = to_matrix(from_rotation_vector(axis * 1.0));
  const Matrix3 large = to_matrix(from_rotation_vector(axis * (1.0 + 8 * kPi)));
  EXPECT_LT(distance(small, large), 2e-14);
  const Vector3 wrapped = to_rotation_vector(to_matrix(from_rotation_vector(axis * 4.0)));
  EXPECT_LT(distance(wrapped, axis * (4.0 - 2 * kPi)), 2e-15);
}

TEST(Rotations, NormalisingNeverDividesByZero) {
  const Quaternion identity = normalised({0, 0, 0, 0});
  EXPECT_EQ(identity.w, 1.0);
  EXPECT_EQ(normalised({0, 0, -3, 0}).y, -1.0);
  EXPECT_EQ(normalised({1e-200, 0, 0, 0}).w, 1.0);
}

TEST(Rotations, RollPitchYawRoundTrips) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const double roll = random.uniform(-kPi, kPi);
    const double pitch = random.uniform(-1.5, 1.5);
    const double yaw = random.uniform(-kPi, kPi);
    const Vector3 back = to_roll_pitch_yaw(from_roll_pitch_yaw(roll, pitch, yaw));
    const double scale = 1.0 / std::cos(pitch);
    EXPECT_NEAR(back.x(), roll, 2e-15 * scale);
    EXPECT_NEAR(back.y(), pitch, 2e-15 * scale);
    EXPECT_NEAR(back.z(), yaw, 2e-15 * scale);
  }
}

// Towards the singularity roll and yaw lose their meaning one by one, the rotation must not.
TEST(Rotations, GimbalLockKeepsTheRotation) {
  Random random(6);
  for (int exponent = -20; exponent <= 0; ++exponent) {
    for (const double sign : {-1.0, 1.0}) {
      for (int i = 0; i < 50; ++i) {
        const double roll = random.uniform(-kPi, kPi);
        const double yaw = random.uniform(-kPi, kPi);
        const double pitch = sign * (kPi / 2 - std::pow(10.0, exponent));
        const Matrix3 r = from_roll_pitch_yaw(roll, pitch, yaw);
        const Vector3 angles = to_roll_pitch_yaw(r);
        EXPECT_LE(std::fabs(angles.y()), kPi / 2);
        EXPECT_LT(distance(from_roll_pitch_yaw(angles.x(), angles.y(), angles.z()), r), 4e-12)
            << exponent;
      }
    }
  }
  const Vector3 locked = to_roll_pitch_yaw(from_roll_pitch_yaw(0.3, kPi / 2, 1.0));
  EXPECT_EQ(locked.x(), 0.0);
  EXPECT_NEAR(locked.y(), kPi / 2, 1e-15);
  EXPECT_NEAR(locked.z(), 0.7, 1e-15);
}

TEST(Rotations, CrossMatrixAndRotationZ) {
  const Vector3 a(1, -2, 3);
  const Vector3 b(0.5, 4, -1);
  EXPECT_LT(distance(cross_matrix(a) * b, a.cross(b)), 1e-15);
  EXPECT_LT(distance(rotation_z(0.4), from_roll_pitch_yaw(0, 0, 0.4)), 1e-16);
}

TEST(Rotations, InterpolationRunsEvenlyAlongTheShorterArc) {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const Quaternion a = random_quaternion(random);
    const Quaternion b = random_quaternion(random);
    const Quaternion minus_b = {-b.w, -b.x, -b.y, -b.z};
    EXPECT_LT(quaternion_distance(interpolate(a, b, 0), a), 1e-15);
    EXPECT_LT(quaternion_distance(interpolate(a, b, 1), b), 2e-15);
    const Quaternion quarter = interpolate(a, b, 0.25);
    EXPECT_LT(quaternion_distance(quarter, interpolate(a, minus_b, 0.25)), 1e-15);
    const Matrix3 whole = to_matrix(a).transpose() * to_matrix(b);
    const Matrix3 part = to_matrix(a).transpose() * to_matrix(quarter);
    EXPECT_NEAR(to_rotation_vector(part).norm(), 0.25 * to_rotation_vector(whole).norm(), 4e-15);
  }
}

}  // namespace
}  // namespace surefoot::geometry
