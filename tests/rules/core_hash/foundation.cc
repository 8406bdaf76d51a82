// Workloads of core/base, core/math and core/geometry, and of Eigen as core uses it.
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "tests/rules/core_hash/workloads.h"

namespace surefoot::tests {
namespace {

template <int kRows, int kColumns>
Eigen::Matrix<double, kRows, kColumns> random_matrix(Random& random) {
  Eigen::Matrix<double, kRows, kColumns> matrix;
  for (int column = 0; column < kColumns; ++column) {
    for (int row = 0; row < kRows; ++row) matrix(row, column) = random.uniform(-1, 1);
  }
  return matrix;
}

Vector3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

void mix(Fnv64& hash, const geometry::Quaternion& q) {
  for (const double value : {q.w, q.x, q.y, q.z}) tests::mix(hash, value);
}

template <int kSize>
void hash_solvers(Fnv64& hash, Random& random) {
  using Square = Eigen::Matrix<double, kSize, kSize>;
  const Square a = random_matrix<kSize, kSize>(random);
  const Square b = random_matrix<kSize, kSize>(random);
  const Eigen::Matrix<double, kSize, 1> v = random_matrix<kSize, 1>(random);
  const Square positive = a * a.transpose() + Square::Identity();
  tests::mix(hash, Square(a * b));
  tests::mix(hash, Square(a * b * a.transpose()));
  tests::mix(hash, Eigen::Matrix<double, kSize, 1>(positive.llt().solve(v)));
  tests::mix(hash, Eigen::Matrix<double, kSize, 1>(positive.ldlt().solve(v)));
  tests::mix(hash, Eigen::Matrix<double, kSize, 1>(positive.partialPivLu().solve(v)));
  tests::mix(hash, v.squaredNorm());
}

}  // namespace

void hash_random(Fnv64& hash) {
  Random random(2024, 7);
  for (int i = 0; i < 20000; ++i) {
    hash.word(random.next_u32(), 4);
    hash.word(random.below(1000), 4);
    mix(hash, random.uniform(-3, 5));
    mix(hash, random.normal());
  }
}

void hash_elementary(Fnv64& hash) {
  Random random(1);
  for (int i = 0; i < 50000; ++i) {
    const double angle = random.uniform(-20, 20);
    const double far = random.uniform(-1e6, 1e6);
    const double unit = random.uniform(-1, 1);
    const double y = random.normal();
    const double x = random.normal();
    for (const double value :
         {math::sin(angle), math::cos(angle), math::tan(angle), math::sin(far), math::tan(far),
          math::asin(unit), math::acos(unit), math::atan(far), math::atan2(y, x), math::exp(angle),
          math::exp(30 * angle), math::log(math::exp(angle)), math::sqrt(far * far + unit),
          math::wrap_angle(far)}) {
      mix(hash, value);
    }
  }
}

// Eigen unrolls 12 as it does 18, and takes half as long to compile: 25 s, four times a test run.
void hash_linear_algebra(Fnv64& hash) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    hash_solvers<3>(hash, random);
    hash_solvers<6>(hash, random);
    hash_solvers<12>(hash, random);
    const Matrix3 a = random_matrix<3, 3>(random);
    mix(hash, Matrix3((a + 3 * Matrix3::Identity()).inverse()));
    mix(hash, a.determinant());
  }
}

void hash_geometry(Fnv64& hash) {
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const Vector3 u = random_vector(random, 3);
    const Vector3 v = random_vector(random, 3);
    const geometry::Quaternion a = geometry::from_rotation_vector(u);
    const geometry::Quaternion b = geometry::from_rotation_vector(v);
    const Matrix3 r = geometry::to_matrix(a * b);
    mix(hash, geometry::to_quaternion(r));
    mix(hash, geometry::to_rotation_vector(r));
    mix(hash, geometry::to_roll_pitch_yaw(r));
    mix(hash, geometry::from_roll_pitch_yaw(u.x(), u.y(), u.z()));
    mix(hash, geometry::interpolate(a, b, random.uniform()));
  }
}

}  // namespace surefoot::tests
