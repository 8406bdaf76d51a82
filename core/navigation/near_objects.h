// What of the objects the follower looks at in a tick, so that a tick costs the same however many
// there are.
//
//   standing  the nearest by their centres, whole objects, until kMaxPoints points are taken or
//             none is left within reach; the farther give way. 2048 points: 68 walls of 3 m.
//   moving    the kMaxMoving nearest by their centres.
// Reach: how far points matter, and the longest way from a centre to a point of its object. Nearer
// is told by rings of kRing_m; in a ring, the first in the list goes first. Ground is left out.
// Frame: O. Cost: each object's centre once, 2048 points at most by whoever follows. No errors.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/navigation/types.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

class NearObjects {
 public:
  static constexpr std::size_t kMaxPoints = 2048;
  static constexpr std::size_t kMaxMoving = 16;
  static constexpr double kObjectReach_m = 4.5;  // a piece of 3 m, its centre in a corner

  // Refers to the objects until the next call. `all_stand`: what moves is taken for standing.
  void gather(const objects::Objects& objects, const Vector2& p_O_m, double points_reach_m,
              bool all_stand);

  const auto& standing() const { return standing_; }
  const auto& moving() const { return moving_; }

 private:
  static constexpr std::size_t kRings = 64;
  static constexpr double kRing_m = 0.25;

  struct Moving {
    const objects::Object* object = nullptr;
    double far2 = 0;
  };

  void take_moving(const objects::Object& object, double far2);
  void take_standing(const objects::Objects& objects);

  std::array<std::uint16_t, kRings> points_in_ring_{};
  std::array<std::uint8_t, objects::kMaxObjects> ring_of_{};
  FixedVector<const objects::Object*, objects::kMaxObjects> standing_;
  FixedVector<Moving, kMaxMoving> moving_;
  std::size_t farthest_ = 0;  // of a full moving_
};

}  // namespace surefoot::navigation
