// A world of posts, walls and ground for a planar scanner to look at, ray by ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/objects/ground_or_wall.h"
#include "core/objects/scan_points.h"

namespace surefoot::objects::test {

struct Post {
  Vector2 centre_m = Vector2::Zero();
  double radius_m = 0.25;
  double top_m = 3.0;  // above its ground
};
struct Wall {
  Vector2 from_m = Vector2::Zero();
  Vector2 to_m = Vector2::Zero();
  double top_m = 3.0;
};

// Level for x <= foot_x_m, from there on rising along x.
struct Ground {
  double slope = 0;
  double foot_x_m = 0;
  bool present = true;
  double at(double x) const { return x > foot_x_m ? slope * (x - foot_x_m) : 0.0; }
};

class ScanWorld {
 public:
  std::vector<Post> posts;
  std::vector<Wall> walls;
  Ground ground;
  double noise_m = 0.01;
  double reach_m = 80;

  double range(const Vector3& from, const Vector3& along) const {
    double best = reach_m;
    for (const Post& post : posts) best = std::min(best, to_post(from, along, post));
    for (const Wall& wall : walls) best = std::min(best, to_wall(from, along, wall));
    if (ground.present) best = std::min(best, to_ground(from, along));
    return best < reach_m ? best : 0;
  }

  hal::LidarScan scan(const ScanPoses& poses, TimeNs stamp, Random& random, int beams = 361,
                      double step_rad = math::kPi / 360) const {
    hal::LidarScan out;
    out.stamp = stamp;
    out.beam_count = static_cast<std::uint16_t>(beams);
    out.first_angle_rad = static_cast<float>(-0.5 * step_rad * (beams - 1));
    out.angle_step_rad = static_cast<float>(step_rad);
    for (int i = 0; i < beams; ++i) {
      const double s = beams > 1 ? i / (beams - 1.0) : 0;
      const Matrix3 R = poses.first.R_OL + (poses.last.R_OL - poses.first.R_OL) * s;
      const Vector3 p = poses.first.p_OL_m + (poses.last.p_OL_m - poses.first.p_OL_m) * s;
      const double angle = static_cast<double>(out.first_angle_rad) + i * step_rad;
      double r = range(p, R * Vector3(std::cos(angle), std::sin(angle), 0));
      if (r > 0) r += noise_m * random.normal();
      out.range_m[static_cast<std::size_t>(i)] = static_cast<float>(std::max(0.0, r));
    }
    return out;
  }

 private:
  static double to_post(const Vector3& from, const Vector3& along, const Post& post) {
    const Vector2 d = along.head<2>();
    const Vector2 off = from.head<2>() - post.centre_m;
    const double a = d.squaredNorm();
    const double b = off.dot(d);
    const double disc = b * b - a * (off.squaredNorm() - post.radius_m * post.radius_m);
    if (disc < 0) return 1e9;
    const double t = (-b - std::sqrt(disc)) / a;
    return t > 0 && from[2] + t * along[2] < post.top_m ? t : 1e9;
  }
  static double to_wall(const Vector3& from, const Vector3& along, const Wall& wall) {
    const Vector2 e = wall.to_m - wall.from_m;
    const Vector2 d = along.head<2>();
    const double det = d[0] * -e[1] + d[1] * e[0];
    if (std::abs(det) < 1e-12) return 1e9;
    const Vector2 o = wall.from_m - from.head<2>();
    const double t = (o[0] * -e[1] + o[1] * e[0]) / det;
    const double u = (d[0] * o[1] - d[1] * o[0]) / det;
    return t > 0 && u >= 0 && u <= 1 && from[2] + t * along[2] < wall.top_m ? t : 1e9;
  }
  double to_ground(const Vector3& from, const Vector3& along) const {
    double best = 1e9;
    if (along[2] < 0) {
      const double t = -from[2] / along[2];
      if (t > 0 && from[0] + t * along[0] <= ground.foot_x_m) best = t;
    }
    const double closing = ground.slope * along[0] - along[2];
    if (closing > 0) {
      const double t = (from[2] - ground.slope * (from[0] - ground.foot_x_m)) / closing;
      if (t > 0 && from[0] + t * along[0] > ground.foot_x_m) best = std::min(best, t);
    }
    return best;
  }
};

// A scanner's pose above a place, and the same for both ends of a sweep.
inline ScannerPose pose_at(double x, double y, double z, double pitch = 0, double yaw = 0) {
  return {geometry::from_roll_pitch_yaw(0, pitch, yaw), {x, y, z}};
}
inline ScanPoses still(const ScannerPose& pose) { return {pose, pose}; }

inline GroundPlane plane_at(double x, double y, double z = 0, double slope_x = 0) {
  return {{x, y, z}, {slope_x, 0}};
}

}  // namespace surefoot::objects::test
