#include "sim_hal/world/walkers.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

namespace {

constexpr double kBelow_m = 1.0;  // how far a capsule reaches into the ground

// Along the way there and back: [0, 2 length).
double travelled_m(const Walker& walker, double length_m, double t_s) {
  const double way_m = walker.begin_m + walker.speed_m_s * t_s;
  return way_m - 2 * length_m * std::floor(way_m / (2 * length_m));
}

}  // namespace

Vector2 Walker::place_m(double t_s) const {
  const double length_m = (to_m - from_m).norm();
  if (!(length_m > 0)) return from_m;
  const double way_m = travelled_m(*this, length_m, t_s);
  const double part = way_m <= length_m ? way_m / length_m : 2.0 - way_m / length_m;
  return from_m + part * (to_m - from_m);
}

Vector2 Walker::velocity_m_s(double t_s) const {
  const double length_m = (to_m - from_m).norm();
  if (!(length_m > 0)) return Vector2::Zero();
  const double sign = travelled_m(*this, length_m, t_s) <= length_m ? 1.0 : -1.0;
  return sign * speed_m_s / length_m * (to_m - from_m);
}

Walkers::Walkers(const Terrain& terrain)
    : terrain_(terrain), count_(std::min(terrain.walkers.size(), kMaxWalkers)) {
  place(0);
}

void Walkers::place(double t_s) {
  for (std::size_t i = 0; i < count_; ++i) {
    const Walker& walker = terrain_.walkers[i];
    const Vector2 place_m = walker.place_m(t_s);
    const Vector2 velocity_m_s = walker.velocity_m_s(t_s);
    const double ground_m = terrain_.height_m(place_m.x(), place_m.y());
    Capsule& capsule = solids_[i].capsule;
    solids_[i].kind = SolidKind::kWalker;
    capsule.radius_m = kWalkerRadius_m;
    capsule.a_m = Vector3(place_m.x(), place_m.y(), ground_m - kBelow_m);
    capsule.b_m = Vector3(place_m.x(), place_m.y(), ground_m + kWalkerHeight_m - kWalkerRadius_m);
    velocities_[i] = Vector3(velocity_m_s.x(), velocity_m_s.y(), 0);
  }
}

}  // namespace surefoot::sim
