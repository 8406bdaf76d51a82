// Which points lie on the robot itself: capsules around the leg links and a box around the trunk.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/mapping/integration.h"
#include "core/math/linear.h"

namespace surefoot::mapping {

inline constexpr std::size_t kMaxSelfCapsules = 16;

// A link of the robot: the points within radius_m of the segment a b.
struct SelfCapsule {
  Vector3 a_O_m = Vector3::Zero();
  Vector3 b_O_m = Vector3::Zero();
  double radius_m = 0;
};

// The robot's own body at the frame's stamp; what the camera sees of it is not ground.
struct SelfModel {
  BodyPose X_OB;
  std::array<double, 3> trunk_size_m{};  // full lengths of a box centred at B; 0: none
  FixedVector<SelfCapsule, kMaxSelfCapsules> capsules;
};

// kInvalid: a value is not finite or a length negative.
Status validate(const SelfModel& self);

// Prepared for many points. Lives during one frame; keeps a reference to the model.
class SelfFilter {
 public:
  SelfFilter(const SelfModel& self, double inflation_m);
  // Points inside the inflated bodies. Cost: a box test for most points, else all capsules.
  bool covers(const Vector3& p_O_m) const;

 private:
  struct Box {
    Vector3 low = Vector3::Zero();
    Vector3 high = Vector3::Zero();
    bool covers(const Vector3& p) const;
  };
  const SelfModel& self_;
  double inflation_m_;
  Box all_;
  std::array<Box, kMaxSelfCapsules> boxes_;
};

}  // namespace surefoot::mapping
