// From the path to body velocities, every tick (paper 003, III-C.1).
//
//   near (to near_m off the path)  parallel to its tangent at full speed, side step onto it
//   far (from far_m)               straight for a point target_m ahead on the path
//   between                        the convex combination of both commands
// Facing away by more than turn_only_rad the robot turns on the spot.
//
// The speed is the least of: cruise; what curves ahead allow, sqrt(v_curve^2 + 2 a d); what the
// ground ahead allows, v <= sqrt(2 a d) with d the way along the path until the robot would touch
// an object, the end of what the sensors see or of the path; what walkers allow
// (walker_avoidance.h). Commands change by no more than the configured accelerations, also when
// the path is replaced.
//
// Free ground ahead: the path's next metres are drawn into a small grid as a corridor of discs a
// little larger than the robot's; each near point is looked up there once, and where it falls on a
// disc, the way to the touch is reckoned exactly along the path's tangent there.
// Frames: O; the command is in the robot's heading.
// Bounds: each object's centre and NearObjects::kMaxPoints points per tick; kNearby samples of a
// path that is not new. No errors.
#pragma once

#include <array>
#include <cstdint>

#include "core/navigation/config.h"
#include "core/navigation/near_objects.h"
#include "core/navigation/types.h"
#include "core/navigation/walker_avoidance.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

// What the speed is held down by.
enum class SpeedReason : std::uint8_t {
  kNone = 0,  // cruise
  kNoPath,    // there is nothing to follow
  kTurning,   // on the spot
  kCurve,
  kBlocked,  // an object on the path ahead
  kWalker,
  kAside,  // out of a walker's way
  kEnd,    // of the path
};

class PathFollower {
 public:
  void reset(const NavigationConfig& config);
  // The path must stay as it is until the next call. Null: stop.
  void set_path(const Path* path);

  VelocityCommand follow(const RobotPose& robot, const objects::Objects& objects, TimeNs stamp);

  SpeedReason reason() const { return reason_; }
  double off_path_m() const { return off_path_m_; }  // to the left of it; signed
  double to_end_m() const { return to_end_m_; }
  double free_m() const { return free_m_; }  // of the way ahead

 private:
  static constexpr std::size_t kNearby = 60;  // samples looked at around the last place
  static constexpr std::int32_t kGridSide = 96;
  static constexpr double kGridCell_m = 0.08;
  static constexpr std::uint8_t kClear = 0xff;

  struct Place {
    std::size_t sample = 0;
    double at_m = 0;
    Vector2 p_O_m = Vector2::Zero();
    PathPoint ahead;  // where the robot will be after the reaction time
  };

  void locate(const RobotPose& robot);
  std::size_t sample_at(double along_m) const;
  double curve_limit_m_s() const;
  double corridor_radius_m() const { return config_.half_width_m + 0.5 * config_.map.clearance_m; }
  void draw_corridor(const RobotPose& robot);
  void draw_disc(const Vector2& p_O_m, std::uint8_t number);
  void measure_free_way(const RobotPose& robot, const objects::Objects& objects);
  double way_to_touch_m(const Vector2& p_O_m, std::uint8_t number) const;
  double speed_limit_m_s();
  VelocityCommand steer(const RobotPose& robot, double speed_m_s);
  VelocityCommand near_command(const RobotPose& robot, double speed_m_s);
  VelocityCommand far_command(const RobotPose& robot, double speed_m_s) const;
  VelocityCommand limited(const VelocityCommand& wanted, double dt_s) const;
  double turning_share(double error_rad) const;

  NavigationConfig config_;
  NearObjects near_;
  WalkerAvoidance walkers_;
  const Path* path_ = nullptr;
  bool fresh_ = true;
  Place place_;
  double off_path_m_ = 0;
  double to_end_m_ = 0;
  double free_m_ = 0;
  struct Disc {
    Vector2 p_O_m = Vector2::Zero();
    Vector2 to_O = Vector2(1, 0);  // towards the next one
    double way_m = 0;
  };

  Vector2 corridor_corner_O_m_ = Vector2::Zero();
  std::size_t discs_ = 0;
  std::array<Disc, kClear> corridor_O_m_;
  std::array<std::uint8_t, static_cast<std::size_t>(kGridSide) * kGridSide> corridor_{};
  VelocityCommand command_;
  bool started_ = false;
  TimeNs last_;
  SpeedReason reason_ = SpeedReason::kNoPath;
};

}  // namespace surefoot::navigation
