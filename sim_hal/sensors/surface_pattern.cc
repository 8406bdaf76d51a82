#include "sim_hal/sensors/surface_pattern.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

constexpr double kCoarsest_m = 0.08;
constexpr int kOctaves = 6;
constexpr double kAmplitude = 0.32;  // of each octave

// -1 to 1 from the lattice point (splitmix64's finish).
double value_at(std::int64_t i, std::int64_t j, std::int64_t k, std::uint64_t salt) {
  std::uint64_t h = salt;
  h += static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15ULL;
  h += static_cast<std::uint64_t>(j) * 0xC2B2AE3D27D4EB4FULL;
  h += static_cast<std::uint64_t>(k) * 0x165667B19E3779F9ULL;
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBULL;
  h ^= h >> 31U;
  return static_cast<double>(h >> 11U) * (2.0 / 9007199254740992.0) - 1.0;
}

double blend(double a, double b, double share) { return a + (b - a) * share; }

double smooth(double x) { return x * x * (3.0 - 2.0 * x); }

}  // namespace

// Trilinear between lattice points one apart, with smooth shares.
double SurfacePattern::octave(const Vector3& p, std::uint64_t salt) const {
  const double x = std::floor(p.x());
  const double y = std::floor(p.y());
  const double z = std::floor(p.z());
  const auto i = static_cast<std::int64_t>(x);
  const auto j = static_cast<std::int64_t>(y);
  const auto k = static_cast<std::int64_t>(z);
  const double across = smooth(p.x() - x);
  const double along = smooth(p.y() - y);
  const auto row = [&](std::int64_t b, std::int64_t c) {
    return blend(value_at(i, b, c, salt), value_at(i + 1, b, c, salt), across);
  };
  return blend(blend(row(j, k), row(j + 1, k), along),
               blend(row(j, k + 1), row(j + 1, k + 1), along), smooth(p.z() - z));
}

double SurfacePattern::at(const Vector3& p_W_m, double footprint_m) const {
  double sum = 0;
  double cell_m = kCoarsest_m;
  for (int o = 0; o < kOctaves; ++o, cell_m *= 0.5) {
    const double seen = std::min(1.0, cell_m / footprint_m - 1.0);
    if (seen <= 0) break;
    const auto salt = seed_ * 0xD6E8FEB86659FD93ULL + static_cast<std::uint64_t>(o + 1);
    sum += kAmplitude * seen * octave(p_W_m / cell_m, salt * 0xA24BAED4963EE407ULL);
  }
  return sum;
}

}  // namespace surefoot::sim
