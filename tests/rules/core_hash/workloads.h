// The workloads of core_hash: each drives one module with seeded inputs and hashes what comes out,
// bit for bit. A module is added by a function here and a line in main.cc.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/base/hash.h"

namespace surefoot::tests {

inline void mix(Fnv64& hash, double value) { hash.word(std::bit_cast<std::uint64_t>(value), 8); }

template <class Derived>
void mix(Fnv64& hash, const Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) mix(hash, matrix(row, column));
  }
}

void hash_random(Fnv64& hash);
void hash_elementary(Fnv64& hash);
void hash_linear_algebra(Fnv64& hash);
void hash_geometry(Fnv64& hash);
void hash_kinematics(Fnv64& hash);
void hash_dynamics(Fnv64& hash);
void hash_actuation(Fnv64& hash);
void hash_attitude(Fnv64& hash);
void hash_tracking(Fnv64& hash);
void hash_registration(Fnv64& hash);
void hash_stereo(Fnv64& hash);
void hash_mapping(Fnv64& hash);
void hash_terrain(Fnv64& hash);
void hash_terrain_task(Fnv64& hash);
void hash_planning(Fnv64& hash);
void hash_swing(Fnv64& hash);
void hash_convex_mpc(Fnv64& hash);
void hash_whole_body(Fnv64& hash);
void hash_recovery(Fnv64& hash);
void hash_static_walk(Fnv64& hash);
void hash_jump(Fnv64& hash);
void hash_ledge(Fnv64& hash);
void hash_obstacles(Fnv64& hash);
void hash_navigation(Fnv64& hash);

}  // namespace surefoot::tests
