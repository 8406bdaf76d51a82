#include "core/control/load_sharing.h"

#include <algorithm>

namespace surefoot::control {

// Parallel forces turn nothing about the centre of mass where their places, moved along them to its
// height, have it as their weighted mean. What moves the trunk sideways so asks more of the feet it
// moves away from.
std::array<Vector3, robot::kLegs> share_load(const planning::Feet& feet_O_m,
                                             const LoadShares& shares, const Vector3& centre_O_m,
                                             const Vector3& force_O_N) {
  constexpr double kLeastUp_N = 1e-3;
  const Vector2 slant = force_O_N.head<2>() / std::max(force_O_N[2], kLeastUp_N);
  std::array<Vector3, robot::kLegs> lever;
  Matrix3 gram = Matrix3::Identity() * 1e-9;  // feet in a line: still a solution
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    const Vector3 off = feet_O_m[i] - centre_O_m;
    const Vector2 moved = off.head<2>() - off[2] * slant;
    lever[i] = Vector3(1.0, moved[0], moved[1]);
    gram += shares[i] * lever[i] * lever[i].transpose();
  }
  const Vector3 multiplier = gram.llt().solve(Vector3(force_O_N[2], 0.0, 0.0));
  std::array<Vector3, robot::kLegs> forces_O_N;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    const double up_N = std::max(0.0, shares[i] * lever[i].dot(multiplier));
    forces_O_N[i] = Vector3(slant[0] * up_N, slant[1] * up_N, up_N);
  }
  return forces_O_N;
}

}  // namespace surefoot::control
