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
};

using Objects = FixedVector<Object, kMaxObjects>;

}  // namespace surefoot::objects
