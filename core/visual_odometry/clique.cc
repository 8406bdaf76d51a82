#include "core/visual_odometry/clique.h"

#include "core/math/elementary.h"

namespace surefoot::visual_odometry {
namespace {

// Of a distance of two points, in the direction of the line between them.
double distance_variance_m2(const NoisyPoint& a, const NoisyPoint& b, const Vector3& direction) {
  return math::square(a.along_m.dot(direction)) + math::square(b.along_m.dot(direction)) +
         math::square(a.across_m) + math::square(b.across_m);
}

bool agree(const Match& a, const Match& b, double gate_sigma) {
  const Vector3 then = b.then.p_m - a.then.p_m;
  const Vector3 now = b.now.p_m - a.now.p_m;
  const double length_then_m = then.norm();
  const double length_now_m = now.norm();
  if (!(length_then_m > 0 && length_now_m > 0)) return false;
  const double variance = distance_variance_m2(a.then, b.then, then / length_then_m) +
                          distance_variance_m2(a.now, b.now, now / length_now_m);
  return math::square(length_then_m - length_now_m) <= math::square(gate_sigma) * variance;
}

void insert(std::array<std::uint64_t, (kMaxFeatures + 63) / 64>& set, std::size_t i) {
  set[i / 64] |= std::uint64_t{1} << (i % 64);
}

// Not std::popcount: where the CPU has no such instruction it is a call into the compiler's
// library.
int count_bits(std::uint64_t x) {
  x -= x >> 1u & 0x5555555555555555u;
  x = (x & 0x3333333333333333u) + (x >> 2u & 0x3333333333333333u);
  x = (x + (x >> 4u)) & 0x0F0F0F0F0F0F0F0Fu;
  return static_cast<int>(x * 0x0101010101010101u >> 56u);
}

}  // namespace

// count if there is no candidate.
std::size_t CliqueFinder::best_of(const Set& candidates, std::size_t count) const {
  std::size_t best = count;
  int most = -1;
  for (std::size_t i = 0; i < count; ++i) {
    if ((candidates[i / 64] >> (i % 64) & 1u) == 0) continue;
    int common = 0;
    for (std::size_t word = 0; word < kWords; ++word) {
      common += count_bits(candidates[word] & agrees_[i][word]);
    }
    if (common <= most) continue;
    most = common;
    best = i;
  }
  return best;
}

std::size_t CliqueFinder::find(const Matches& matches, double gate_sigma,
                               std::array<bool, kMaxFeatures>& chosen) {
  const std::size_t count = matches.size();
  chosen.fill(false);
  Set candidates{};
  for (std::size_t i = 0; i < count; ++i) {
    agrees_[i].fill(0);
    insert(candidates, i);
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      if (!agree(matches[i], matches[j], gate_sigma)) continue;
      insert(agrees_[i], j);
      insert(agrees_[j], i);
    }
  }
  std::size_t size = 0;
  for (std::size_t next = best_of(candidates, count); next < count;
       next = best_of(candidates, count)) {
    chosen[next] = true;
    ++size;
    // Nothing agrees with itself: what was chosen leaves the candidates here.
    for (std::size_t word = 0; word < kWords; ++word) candidates[word] &= agrees_[next][word];
  }
  return size;
}

}  // namespace surefoot::visual_odometry
