// One thing that stands or moves near the robot: what tracking keeps and planning goes round.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/time.h"
#include "core/math/linear.h"

namespace surefoot::objects {

inline constexpr std::size_t kMaxObjectPoints = 64;  // longer things are kept in several pieces
inline constexpr std::size_t kMaxObjects = 512;      // in the memory

// What the points are taken for. Ground returns are kept apart so that the robot does not fear a
// slope; they never block.
enum class ObjectClass : std::uint8_t { kObstacle = 0, kGround };

struct Object {
  std::uint32_t id = 0;  // given once, never reused
  ObjectClass kind = ObjectClass::kObstacle;
  bool moving = false;  // velocity_O_m_s is significant
  TimeNs first_seen;
  TimeNs last_seen;
  double tracked_s = 0;                               // time it was matched from scan to scan
  Vector2 centre_O_m = Vector2::Zero();               // mean of its points
  Vector2 velocity_O_m_s = Vector2::Zero();           // zero unless moving
  FixedVector<Vector2, kMaxObjectPoints> points_O_m;  // thinned; where they were at last_seen

  // As `=`, but touches only the points in use.
  void assign(const Object& from) {
    id = from.id;
    kind = from.kind;
    moving = from.moving;
    first_seen = from.first_seen;
    last_seen = from.last_seen;
    tracked_s = from.tracked_s;
    centre_O_m = from.centre_O_m;
    velocity_O_m_s = from.velocity_O_m_s;
    points_O_m.assign(from.points_O_m);
  }
};

using Objects = FixedVector<Object, kMaxObjects>;

// A full list is 0.6 MB: what hands one on copies what is in use.
inline void assign(Objects& to, const Objects& from) {
  static_cast<void>(to.resize(from.size()));  // the same capacity
  for (std::size_t i = 0; i < from.size(); ++i) to[i].assign(from[i]);
}

}  // namespace surefoot::objects
