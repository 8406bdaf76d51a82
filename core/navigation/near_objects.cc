#include "core/navigation/near_objects.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr std::uint8_t kLeftOut = 0xff;

}  // namespace

void NearObjects::gather(const objects::Objects& objects, const Vector2& p_O_m,
                         double points_reach_m, bool all_stand) {
  moving_.clear();
  farthest_ = 0;
  points_in_ring_.fill(0);
  const double reach_m =
      std::min(points_reach_m + kObjectReach_m, kRing_m * static_cast<double>(kRings));
  const double reach2 = math::square(reach_m);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const objects::Object& object = objects[i];
    ring_of_[i] = kLeftOut;
    if (object.kind == objects::ObjectClass::kGround) continue;
    const double far2 = (object.centre_O_m - p_O_m).squaredNorm();
    if (object.moving && !all_stand) {
      take_moving(object, far2);
      continue;
    }
    if (!(far2 < reach2)) continue;
    const double rings = std::min(math::sqrt(far2) / kRing_m, static_cast<double>(kRings - 1));
    const auto ring = static_cast<std::uint8_t>(rings);
    ring_of_[i] = ring;
    points_in_ring_[ring] =
        static_cast<std::uint16_t>(points_in_ring_[ring] + object.points_O_m.size());
  }
  take_standing(objects);
}

void NearObjects::take_moving(const objects::Object& object, double far2) {
  if (!moving_.full()) {
    static_cast<void>(moving_.push_back({&object, far2}));
  } else if (moving_[farthest_].far2 > far2) {
    moving_[farthest_] = {&object, far2};
  } else {
    return;
  }
  if (!moving_.full()) return;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    if (moving_[i].far2 > moving_[farthest_].far2) farthest_ = i;
  }
}

// Whole rings from the nearest on; of the ring that does not fit as a whole, as many as do.
void NearObjects::take_standing(const objects::Objects& objects) {
  standing_.clear();
  std::size_t points = 0;
  std::size_t split = 0;
  while (split < kRings && points + points_in_ring_[split] <= kMaxPoints) {
    points += points_in_ring_[split++];
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (ring_of_[i] > split || ring_of_[i] == kLeftOut) continue;
    if (ring_of_[i] == split) {
      if (points + objects[i].points_O_m.size() > kMaxPoints) continue;
      points += objects[i].points_O_m.size();
    }
    static_cast<void>(standing_.push_back(&objects[i]));
  }
}

}  // namespace surefoot::navigation
