// A pattern on all surfaces of the world, fixed to them: what stereo matching lives on.
#pragma once

#include <cstdint>

#include "core/math/linear.h"

namespace surefoot::sim {

class SurfacePattern {
 public:
  explicit SurfacePattern(std::uint64_t seed) : seed_(seed) {}

  // About -1 to 1, deviation 0.25, mean 0: value noise on a lattice of 8 cm and on five of half the
  // size of the one before. What is finer than `footprint_m`, the side of a pixel on the surface,
  // fades out: a camera does not see it.
  double at(const Vector3& p_W_m, double footprint_m) const;

 private:
  double octave(const Vector3& p, std::uint64_t salt) const;

  std::uint64_t seed_;
};

}  // namespace surefoot::sim
