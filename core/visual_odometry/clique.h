// Which matches belong to one rigid motion (Howard 2008): those whose points keep their distances.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/math/linear.h"
#include "core/visual_odometry/features.h"

namespace surefoot::visual_odometry {

// A point with its uncertainty, as the stereo pair gives it.
struct NoisyPoint {
  Vector3 p_m = Vector3::Zero();
  Vector3 along_m = Vector3::Zero();  // one sigma, along its ray
  double across_m = 0;                // one sigma, across it
};

// The same thing seen from the keyframe and now.
struct Match {
  std::uint16_t from = 0;  // index among the keyframe's features
  std::uint16_t to = 0;    // among the present ones
  NoisyPoint then;
  NoisyPoint now;
};
using Matches = FixedVector<Match, kMaxFeatures>;

class CliqueFinder {
 public:
  // Marks a large set of matches all of whose pairs agree: two distances differ by less than
  // gate_sigma of their noise. Greedy: starts with the match that agrees with most, adds the one
  // that agrees with most of what is left; of equals the first. Returns its size.
  // Cost: O(n^2) distances, O(n^2 size / 64) to grow; n <= kMaxFeatures.
  std::size_t find(const Matches& matches, double gate_sigma,
                   std::array<bool, kMaxFeatures>& chosen);

 private:
  static constexpr std::size_t kWords = (kMaxFeatures + 63) / 64;
  using Set = std::array<std::uint64_t, kWords>;

  std::size_t best_of(const Set& candidates, std::size_t count) const;

  std::array<Set, kMaxFeatures> agrees_{};
};

}  // namespace surefoot::visual_odometry
