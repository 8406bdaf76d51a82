// Which points lie on the robot itself: capsules around the leg links and a box around the trunk.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/mapping/integration.h"
#include "core/math/lanes.h"
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
  // Two capsules side by side in lanes. One that is not set covers nothing.
  struct LinkPair {
    using Axes = std::array<DoubleLanes, 3>;
    Axes low{};  // the capsules' boxes
    Axes high{};
    Axes a{};
    Axes ab{};
    DoubleLanes inverse_length2{};  // of ab; 0: a ball
    DoubleLanes radius2 = all_lanes(-1.0);

    void set(int lane, const SelfCapsule& capsule, const Box& box, double radius_m);
    bool covers(const Vector3& p) const;
  };
  static_assert(kMaxSelfCapsules % kDoubleLanes == 0);

  const SelfModel& self_;
  double inflation_m_;
  Box all_;
  std::array<LinkPair, kMaxSelfCapsules / kDoubleLanes> links_;
  std::size_t pairs_ = 0;
};

}  // namespace surefoot::mapping
