// From a wanted velocity to one that keeps clear of the fields.
//
// Potential of one field (a radial basis function with compact support), s = free space between
// the disc, grown by what it stands for, and the robot, a capsule along its heading, grown by the
// margin:
//   U(s) = P L / 3 (1 - s / L)^3 for s < L, else 0;  -dU/ds = P (1 - s / L)^2
// The robot is moved by its translation, so the gradient is along the line that joins the nearest
// points (paper 002, section IV-A: the gradient is added to the commanded velocity).
#pragma once

#include <cstdint>

#include "core/math/linear.h"
#include "core/obstacles/config.h"
#include "core/obstacles/field_pool.h"

namespace surefoot::obstacles {

// The robot as the fields see it: all points within radius_m of a segment along its heading.
struct Footprint {
  double half_length_m = 0;
  double radius_m = 0;
};

struct RobotPlace {
  Vector2 p_O_m = Vector2::Zero();
  double yaw_rad = 0;
};

// What the mission wants.
struct Wish {
  Vector2 velocity_O_m_s = Vector2::Zero();
  Vector2 path_O = Vector2(1, 0);  // unit vector along the path
  double off_path_m = 0;           // the robot is to the left of the path's line by this
};

class Avoidance {
 public:
  void reset(const ObstacleConfig& config, const Footprint& footprint);

  // Every tick. Without a field in reach the wish itself, bit for bit.
  Vector2 velocity_O_m_s(const Fields& fields, const RobotPlace& place, const Wish& wish);

  // Sum over the fields, and its negative gradient with respect to the robot's position.
  double potential(const Fields& fields, const RobotPlace& place) const;
  Vector2 push_O_m_s(const Fields& fields, const RobotPlace& place) const;
  // Free space before the nearest field; reach_m where none is in reach. Negative: inside the
  // margin.
  double free_space_m(const Fields& fields, const RobotPlace& place) const;

  // Side on which what is ahead is passed: +1 left, -1 right, 0 nothing is ahead.
  int side() const { return side_; }
  // Passes on the other side from now on.
  void change_side() { side_ = -side_; }

 private:
  struct Contact {
    Vector2 away_O = Vector2::Zero();  // unit vector from the field to the robot
    double free_m = 0;
  };
  // The capsule's axis.
  struct Axis {
    Vector2 p_O_m = Vector2::Zero();
    Vector2 heading_O = Vector2(1, 0);
  };
  // What is ahead, to the left of the robot's path.
  struct Extent {
    bool any = false;
    double low_m = 0;
    double high_m = 0;
  };
  Axis axis(const RobotPlace& place) const;
  Contact contact(const Field& field, const Axis& axis) const;
  double push_m_s(double free_m) const;
  double room_m() const;
  void extend(const Fields& fields, const RobotPlace& place, const Vector2& path_O,
              Extent& extent) const;
  void choose_side(const Fields& fields, const RobotPlace& place, const Wish& wish);
  Vector2 bounded(const Vector2& v_O_m_s, const Vector2& heading_O) const;
  Vector2 slowed(const Vector2& v_O_m_s, const Fields& fields, const Axis& axis) const;

  ObstacleConfig config_;
  Footprint footprint_;
  int side_ = 0;
};

}  // namespace surefoot::obstacles
