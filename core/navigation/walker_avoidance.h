// Keeps out of the way of what moves: slower along the path, standing, or a step aside or back.
//
// Walkers are discs that go on as they do. The robot, a disc round its corners, is tried along its
// path at shares of its speed, the fastest first; the first that keeps the margin from every
// walker over the horizon is taken. If even standing still does not, eight directions are tried
// that leave what stands alone, and the one that keeps the walkers farthest is taken. So a robot
// that stands still moves too. A walker already nearer than the margin has to get no nearer.
//
// Frame: O. Bounds: the kMaxWalkers nearest walkers, 12 steps of time for each share. No errors.
#pragma once

#include <array>

#include "core/navigation/config.h"
#include "core/navigation/near_objects.h"
#include "core/navigation/types.h"

namespace surefoot::navigation {

// What the robot is about to do, without walkers.
struct Intent {
  RobotPose robot;
  const Path* path = nullptr;              // null: stand
  std::size_t sample = 0;                  // of the path, just before the robot's projection
  double at_m = 0;                         // arc length of the projection
  Vector2 off_path_O_m = Vector2::Zero();  // from there to the robot
  double speed_m_s = 0;
};

struct Evasion {
  double share = 1;    // of the intended speed
  bool aside = false;  // then this instead
  Vector2 velocity_O_m_s = Vector2::Zero();
};

class WalkerAvoidance {
 public:
  static constexpr double kLooksAround_m = 3.0;  // for what stands; half_length_m is 2 m at most

  void reset(const NavigationConfig& config);
  Evasion decide(const Intent& intent, const NearObjects& near, TimeNs stamp);

 private:
  static constexpr std::size_t kMaxWalkers = NearObjects::kMaxMoving;
  static constexpr std::size_t kDirections = 8;
  static constexpr std::size_t kShares = 5;
  static constexpr std::size_t kSteps = 12;

  struct Walker {
    Vector2 p_O_m = Vector2::Zero();
    Vector2 velocity_O_m_s = Vector2::Zero();
    double keep_m = 0;  // between the centres
    double now_m = 0;   // distance
  };

  void gather(const Intent& intent, const NearObjects& near, TimeNs stamp);
  // Stops at the first step that leaves less than `asked_m`.
  double room_along_m(const Intent& intent, double share, double asked_m) const;
  double room_at_m(const Vector2& from_O_m, const Vector2& velocity_O_m_s, double from_s,
                   double to_s) const;
  double room_m(const Walker& walker, const Vector2& from_O_m, const Vector2& velocity_O_m_s,
                double from_s, double to_s) const;
  Vector2 step_O_m_s(const RobotPose& robot, std::size_t direction) const;
  void close_ways(const RobotPose& robot, const NearObjects& near);
  Evasion step_aside(const Intent& intent, const NearObjects& near);

  double half_length_m_ = 0;
  double half_width_m_ = 0;
  double radius_m_ = 0;
  FollowConfig config_;
  FixedVector<Walker, kMaxWalkers> walkers_;
  std::array<bool, kDirections> open_{};
  std::size_t last_share_ = 0;
  std::size_t last_direction_ = kDirections;  // none
};

}  // namespace surefoot::navigation
