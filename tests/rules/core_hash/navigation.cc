// Workloads of core/objects and core/navigation: scans of posts that a body on its way sees, and
// the way it finds between what it makes of them.
#include <memory>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/navigation/navigator.h"
#include "core/objects/object_map.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/unit/navigation/parts.h"
#include "tests/unit/objects/config.h"

namespace surefoot::tests {
namespace {

constexpr std::size_t kPosts = 24;
constexpr double kRadius_m = 0.2;
constexpr std::uint16_t kBeams = 181;

struct Walk {
  std::array<Vector2, kPosts> posts_O_m;
  navigation::RobotPose robot;
  TimeNs stamp;
};

Walk begin_walk() {
  Walk walk;
  Random random(31);
  for (Vector2& post : walk.posts_O_m) {
    post[0] = random.uniform(2.0, 20.0);
    post[1] = random.uniform(-5.0, 5.0);
  }
  return walk;
}

// Distance along a beam to the nearest post; 0: none.
double range_m(const Walk& walk, double bearing_rad) {
  const math::SinCos beam = math::sin_cos(bearing_rad);
  double nearest_m = 1e9;
  for (const Vector2& post : walk.posts_O_m) {
    const Vector2 to = post - walk.robot.p_O_m;
    const double along = beam.cos * to[0] + beam.sin * to[1];
    const double off = beam.cos * to[1] - beam.sin * to[0];
    const double inside = kRadius_m * kRadius_m - off * off;
    if (along <= 0 || inside <= 0) continue;
    const double hit_m = along - math::sqrt(inside);
    if (hit_m < nearest_m) nearest_m = hit_m;
  }
  return nearest_m < 25.0 ? nearest_m : 0.0;
}

hal::LidarScan scan_of(const Walk& walk, Random& random) {
  hal::LidarScan scan;
  scan.stamp = walk.stamp;
  scan.beam_interval = microseconds(37);
  scan.beam_count = kBeams;
  scan.first_angle_rad = -1.57f;
  scan.angle_step_rad = 3.14f / (kBeams - 1);
  for (std::uint16_t i = 0; i < kBeams; ++i) {
    const double beam_rad = -1.57 + 3.14 / (kBeams - 1) * i;
    const double hit_m = range_m(walk, walk.robot.yaw_rad + beam_rad);
    if (hit_m > 0) scan.range_m[i] = static_cast<float>(hit_m + random.uniform(-0.02, 0.02));
  }
  return scan;
}

void move(Walk& walk, const navigation::VelocityCommand& command, double step_s) {
  const math::SinCos yaw = math::sin_cos(walk.robot.yaw_rad);
  walk.robot.p_O_m[0] += step_s * (yaw.cos * command.forward_m_s - yaw.sin * command.left_m_s);
  walk.robot.p_O_m[1] += step_s * (yaw.sin * command.forward_m_s + yaw.cos * command.left_m_s);
  walk.robot.yaw_rad = math::wrap_angle(walk.robot.yaw_rad + step_s * command.yaw_rate_rad_s);
}

}  // namespace

void hash_navigation(Fnv64& hash) {
  const auto map = std::make_unique<objects::ObjectMap>();
  const auto navigator = std::make_unique<navigation::Navigator>();
  map->reset(objects::test::config());
  static_cast<void>(navigator->reset(navigation::test::small_robot()));
  static_cast<void>(navigator->set_goal(Vector2(22.0, 0.0)));
  Walk walk = begin_walk();
  Random random(32);
  for (int step = 0; step < 1500; ++step) {
    walk.stamp = milliseconds(20 * (step + 1));
    objects::ScannerPose pose;
    pose.R_OL = geometry::rotation_z(walk.robot.yaw_rad);
    pose.p_OL_m = Vector3(walk.robot.p_O_m[0], walk.robot.p_O_m[1], 0.5);
    objects::GroundPlane ground;
    ground.feet_O_m = Vector3(walk.robot.p_O_m[0], walk.robot.p_O_m[1], 0.0);
    static_cast<void>(map->update(scan_of(walk, random), {pose, pose}, ground, nullptr));
    if (step % 50 == 10) navigator->plan(map->objects(), walk.robot, walk.stamp);
    move(walk, navigator->follow(walk.robot, map->objects(), walk.stamp), 0.02);
    mix(hash, walk.robot.p_O_m);
    hash.word(map->objects().size(), 4);
  }
  for (const objects::Object& object : map->objects()) mix(hash, object.centre_O_m);
  hash.word(navigator->status().counters.plans, 8);
}

}  // namespace surefoot::tests
