// A flat world of circles, walls and walkers, the objects that a scanner on the robot would give,
// and a body that follows velocities with a lag: all that navigation needs to be run as a whole.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/math/elementary.h"
#include "core/navigation/navigator.h"

namespace surefoot::navigation::test {

struct Circle {
  Vector2 p;
  double r = 0;
};

struct Wall {
  Vector2 a;
  Vector2 b;
};

struct Walker {
  Vector2 p;
  Vector2 v;
  double r = 0.25;
};

struct World {
  std::vector<Circle> circles;
  std::vector<Wall> walls;
  std::vector<Walker> walkers;

  // Distance along a ray to the first thing that stands; far: none.
  double cast(const Vector2& from, const Vector2& to, double far) const {
    double best = far;
    for (const Circle& circle : circles) {
      const Vector2 d = circle.p - from;
      const double along = d.dot(to);
      const double aside2 = d.squaredNorm() - along * along;
      if (along < 0 || aside2 > circle.r * circle.r) continue;
      best = std::min(best, along - std::sqrt(circle.r * circle.r - aside2));
    }
    for (const Wall& wall : walls) {
      const Vector2 way = wall.b - wall.a;
      const double across = math::cross(to, way);
      if (std::abs(across) < 1e-12) continue;
      const double along = math::cross(wall.a - from, way) / across;
      const double share = math::cross(wall.a - from, to) / across;
      if (along >= 0 && share >= 0 && share <= 1) best = std::min(best, along);
    }
    return best;
  }
};

// From the rectangle of the robot to a point; negative is not told apart from zero.
inline double gap_to_point(const NavigationConfig& config, const RobotPose& robot,
                           const Vector2& p) {
  const Vector2 d = p - robot.p_O_m;
  const double c = std::cos(robot.yaw_rad);
  const double s = std::sin(robot.yaw_rad);
  const double x = std::max(0.0, std::abs(c * d[0] + s * d[1]) - config.half_length_m);
  const double y = std::max(0.0, std::abs(c * d[1] - s * d[0]) - config.half_width_m);
  return std::hypot(x, y);
}

inline double gap_to_standing(const World& world, const NavigationConfig& config,
                              const RobotPose& robot) {
  double gap = 1e9;
  for (const Circle& circle : world.circles) {
    gap = std::min(gap, gap_to_point(config, robot, circle.p) - circle.r);
  }
  for (const Wall& wall : world.walls) {
    const Vector2 way = wall.b - wall.a;
    const double middle = (robot.p_O_m - wall.a).dot(way) / way.squaredNorm();
    const double reach = 2.0 * config.half_length_m / way.norm();
    for (int i = -20; i <= 20; ++i) {
      const double share = std::clamp(middle + reach * i / 20.0, 0.0, 1.0);
      gap = std::min(gap, gap_to_point(config, robot, wall.a + way * share));
    }
  }
  return gap;
}

// Stands for core/objects: points in cells of 0.2 m, remembered by the paper's age and distance,
// handed out in pieces of 2.5 m.
class Perception {
 public:
  Perception(double noise_m, std::uint64_t seed) : noise_m_(noise_m), random_(seed, 7) {}

  void look(const World& world, const RobotPose& robot, double t_s) {
    constexpr int kRays = 361;
    for (int i = 0; i < kRays; ++i) {
      const double angle = robot.yaw_rad - M_PI / 2 + M_PI * i / (kRays - 1);
      const Vector2 to(std::cos(angle), std::sin(angle));
      double range = world.cast(robot.p_O_m, to, kRange_m);
      if (range >= kRange_m) continue;
      range += noise_m_ * random_.normal();
      const Vector2 p = robot.p_O_m + to * range;
      const auto key = std::make_pair(math::floor_of(p[0] / 0.2), math::floor_of(p[1] / 0.2));
      const auto found = points_.find(key);
      if (found == points_.end()) {
        points_[key] = {p, t_s};
      } else {
        found->second.seen_s = t_s;
      }
    }
    clear_seen_through(world, robot);
    std::erase_if(points_, [&](const auto& item) {
      const double age_s = t_s - item.second.seen_s;
      const double far_m = (item.second.p - robot.p_O_m).norm();
      return (age_s > 30 && far_m > 15) || (age_s > 1800 && far_m > 10);
    });
    for (std::size_t i = 0; i < world.walkers.size(); ++i) {
      if (!sees(world, robot, world.walkers[i])) continue;
      first_seen_s_.insert({i, t_s});
      const bool again = walkers_.count(i) == 0 || t_s - walkers_[i].seen_s > 0.5;
      walkers_[i] = {world.walkers[i], t_s, again ? t_s : walkers_[i].since_s};
    }
    std::erase_if(walkers_, [&](const auto& item) { return t_s - item.second.seen_s > 10; });
    stamp_ = {static_cast<std::int64_t>(t_s * 1e9)};
    fill();
  }

  const objects::Objects& objects() const { return *objects_; }
  // When a walker was published first; never: 1e9.
  double first_seen_s(std::size_t walker) const {
    const auto found = first_seen_s_.find(walker);
    return found == first_seen_s_.end() ? 1e9 : found->second;
  }
  // In view now, and for a while.
  bool knows(std::size_t walker, double t_s) const {
    const auto found = walkers_.find(walker);
    return found != walkers_.end() && t_s - found->second.seen_s < 2.0 &&
           found->second.seen_s - found->second.since_s > 2.0;
  }

 private:
  static constexpr double kRange_m = 20.0;
  struct Point {
    Vector2 p;
    double seen_s = 0;
  };

  struct SeenWalker {
    Walker walker;
    double seen_s = 0;
    double since_s = 0;
  };

  // What was there and is gone.
  void clear_seen_through(const World& world, const RobotPose& robot) {
    std::erase_if(points_, [&](const auto& item) {
      const Vector2 way = item.second.p - robot.p_O_m;
      const double far = way.norm();
      const Vector2 heading(std::cos(robot.yaw_rad), std::sin(robot.yaw_rad));
      if (far > kRange_m || far < 0.1 || way.dot(heading) < 0) return false;
      return world.cast(robot.p_O_m, way / far, 100.0) > far + 1.0;
    });
  }

  static bool sees(const World& world, const RobotPose& robot, const Walker& walker) {
    const Vector2 way = walker.p - robot.p_O_m;
    const double far = way.norm();
    const Vector2 heading(std::cos(robot.yaw_rad), std::sin(robot.yaw_rad));
    if (far > kRange_m || way.dot(heading) < 0) return false;
    return world.cast(robot.p_O_m, way / far, far) >= far;
  }

  void fill() {
    objects_->clear();
    std::map<std::pair<int, int>, objects::Object> pieces;
    for (const auto& [key, point] : points_) {
      objects::Object& piece =
          pieces[{math::floor_of(point.p[0] / 2.5), math::floor_of(point.p[1] / 2.5)}];
      static_cast<void>(piece.points_O_m.push_back(point.p));
    }
    std::uint32_t id = 100;
    for (auto& [key, piece] : pieces) {
      piece.id = id++;
      piece.last_seen = stamp_;
      for (const Vector2& p : piece.points_O_m) piece.centre_O_m += p;
      piece.centre_O_m /= static_cast<double>(piece.points_O_m.size());
      static_cast<void>(objects_->push_back(piece));
    }
    for (const auto& [number, seen] : walkers_) {
      const Walker& walker = seen.walker;
      objects::Object object;
      object.id = static_cast<std::uint32_t>(number);
      object.last_seen = {static_cast<std::int64_t>(seen.seen_s * 1e9)};
      object.moving = walker.v.norm() > 0.1;
      const double vx = walker.v[0] + 2.5 * noise_m_ * random_.normal();
      const double vy = walker.v[1] + 2.5 * noise_m_ * random_.normal();
      if (object.moving) object.velocity_O_m_s = Vector2(vx, vy);
      object.centre_O_m = walker.p;
      for (int i = 0; i < 8; ++i) {
        const double angle = M_PI / 4 * i;
        static_cast<void>(object.points_O_m.push_back(
            walker.p + Vector2(std::cos(angle), std::sin(angle)) * walker.r));
      }
      static_cast<void>(objects_->push_back(object));
    }
  }

  double noise_m_;
  Random random_;
  TimeNs stamp_;
  std::map<std::pair<int, int>, Point> points_;
  std::map<std::size_t, SeenWalker> walkers_;
  std::map<std::size_t, double> first_seen_s_;
  std::unique_ptr<objects::Objects> objects_ = std::make_unique<objects::Objects>();
};

struct BodyState {
  double t_s = 0;
  RobotPose robot;
  VelocityCommand real;
};

struct Collision {
  double t_s = 0;
  double first_seen_s = 0;  // the walker
};

struct RunResult {
  NavigationState state = NavigationState::kIdle;
  NavigationReason reason = NavigationReason::kNone;
  double time_s = 0;
  double length_m = 0;
  double least_gap_m = 1e9;         // to what stands
  double least_walker_gap_m = 1e9;  // known for 2 s
  double least_unseen_gap_m = 1e9;  // the others
  double largest_step_m_s = 0;      // of the command, per 5 ms
  double largest_yaw_step_rad_s = 0;
  std::vector<BodyState> states;            // each 0.1 s
  std::vector<Collision> collisions;        // with walkers; the first with each
  std::vector<Vector2> trail;               // each second
  std::vector<std::vector<Vector2>> plans;  // each plan's path, every metre
  NavigationCounters counters;
};

struct RunOptions {
  NavigationConfig config;
  Vector2 goal;
  RobotPose start;
  double limit_s = 300;
  double noise_m = 0.02;
  std::uint64_t seed = 1;
  double tick_s = 0.02;
  std::function<void(World&, double)> change;  // the world, each tick
};

// A plan is released every second and shown 0.1 s later. Objects come every 0.1 s.
class Simulation {
 public:
  Simulation(World world, const RunOptions& options)
      : world_(std::move(world)),
        options_(options),
        perception_(options.noise_m, options.seed),
        robot_(options.start),
        random_(options.seed, 3) {
    EXPECT_TRUE(ok(navigator_->reset(options.config)));
    EXPECT_TRUE(ok(navigator_->set_goal(options.goal)));
  }

  RunResult run() {
    const int ticks = static_cast<int>(options_.limit_s / options_.tick_s);
    const int per_plan = static_cast<int>(1.0 / options_.tick_s);
    for (int tick = 0; tick < ticks && going(); ++tick) step(tick, per_plan);
    result_.state = navigator_->status().state;
    result_.reason = navigator_->status().reason;
    result_.counters = navigator_->status().counters;
    return result_;
  }

  const Navigator& navigator() const { return *navigator_; }

 private:
  bool going() const { return navigator_->status().state == NavigationState::kGoing; }

  void step(int tick, int per_plan) {
    const double t_s = tick * options_.tick_s;
    const TimeNs stamp{static_cast<std::int64_t>(t_s * 1e9)};
    if (options_.change) options_.change(world_, t_s);
    if (tick % (per_plan / 10) == 0) {
      perception_.look(world_, robot_, t_s);
      result_.states.push_back({t_s, robot_, real_});
    }
    if (tick % per_plan == 0) {
      navigator_->release(perception_.objects(), robot_, stamp);
      navigator_->run();
      result_.trail.push_back(robot_.p_O_m);
    }
    if (tick % per_plan == per_plan / 10) {
      navigator_->publish();
      note_plan();
    }
    const VelocityCommand command = navigator_->follow(robot_, perception_.objects(), stamp);
    note(command, t_s);
    move(command);
  }

  void note_plan() {
    std::vector<Vector2> plan;
    const Path& path = navigator_->path();
    for (std::size_t i = 0; i < path.size(); i += 10) plan.push_back(path[i].p_O_m);
    result_.plans.push_back(plan);
  }

  void note(const VelocityCommand& command, double t_s) {
    const double per_tick = 0.005 / options_.tick_s;
    result_.largest_step_m_s = std::max(
        {result_.largest_step_m_s, std::abs(command.forward_m_s - last_.forward_m_s) * per_tick,
         std::abs(command.left_m_s - last_.left_m_s) * per_tick});
    result_.largest_yaw_step_rad_s =
        std::max(result_.largest_yaw_step_rad_s,
                 std::abs(command.yaw_rate_rad_s - last_.yaw_rate_rad_s) * per_tick);
    last_ = command;
    result_.time_s = t_s;
    result_.least_gap_m =
        std::min(result_.least_gap_m, gap_to_standing(world_, options_.config, robot_));
    for (std::size_t i = 0; i < world_.walkers.size(); ++i) {
      const Walker& walker = world_.walkers[i];
      const double gap = gap_to_point(options_.config, robot_, walker.p) - walker.r;
      // Who comes from where the robot has not looked for a while is not its fault.
      double& least =
          perception_.knows(i, t_s) ? result_.least_walker_gap_m : result_.least_unseen_gap_m;
      if (gap <= 0 && hit_.insert(i).second) {
        result_.collisions.push_back({t_s, perception_.first_seen_s(i)});
      }
      least = std::min(least, gap);
    }
  }

  void move(const VelocityCommand& command) {
    const double share = options_.tick_s / 0.15;
    real_.forward_m_s += share * (command.forward_m_s - real_.forward_m_s);
    real_.left_m_s += share * (command.left_m_s - real_.left_m_s);
    real_.yaw_rate_rad_s += share * (command.yaw_rate_rad_s - real_.yaw_rate_rad_s);
    const double sway = options_.noise_m * random_.normal();  // m/s
    const double c = std::cos(robot_.yaw_rad);
    const double s = std::sin(robot_.yaw_rad);
    const double left = real_.left_m_s + sway;
    const Vector2 v(c * real_.forward_m_s - s * left, s * real_.forward_m_s + c * left);
    robot_.p_O_m += v * options_.tick_s;
    robot_.yaw_rad += real_.yaw_rate_rad_s * options_.tick_s;
    result_.length_m += v.norm() * options_.tick_s;
    for (Walker& walker : world_.walkers) walker.p += walker.v * options_.tick_s;
  }

  World world_;
  RunOptions options_;
  Perception perception_;
  RobotPose robot_;
  Random random_;
  std::unique_ptr<Navigator> navigator_ = std::make_unique<Navigator>();
  VelocityCommand last_;
  VelocityCommand real_;
  std::set<std::size_t> hit_;
  RunResult result_;
};

}  // namespace surefoot::navigation::test
