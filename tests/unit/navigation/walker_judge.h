// Whether a robot could have kept out of a walker's way: the judge of the runs with walkers.
//
// A collision is avoidable if, from the state of the robot at some time between the walker's first
// publication as moving and the collision, one constant command within the limits of speed leads
// past all walkers until three seconds after the collision: with the limits of acceleration, the
// body's lag and perfect foresight of the walkers. 24 directions, three speeds, every 0.2 s. A
// witness proves that it was avoidable; none found: unavoidable, as far as the grid is fine.
#pragma once

#include "tests/unit/navigation/world.h"

namespace surefoot::navigation::test {

class WalkerJudge {
 public:
  WalkerJudge(const World& world, const NavigationConfig& config)
      : world_(world), config_(config) {}

  bool avoidable(const RunResult& result, const Collision& collision) const {
    for (std::size_t i = 0; i < result.states.size(); i += 2) {
      const BodyState& state = result.states[i];
      if (state.t_s < collision.first_seen_s) continue;
      if (state.t_s >= collision.t_s) break;
      for (int k = 0; k <= 3 * kDirections; ++k) {
        if (leads_past(state, command(k), collision.t_s + 3.0)) return true;
      }
    }
    return false;
  }

 private:
  static constexpr int kDirections = 24;
  static constexpr double kStep_s = 0.05;

  VelocityCommand command(int k) const {
    const FollowConfig& follow = config_.follow;
    const double share = (k + kDirections - 1) / kDirections / 3.0;  // 0 for k = 0: stand
    const double c = std::cos(2 * M_PI * k / kDirections);
    const double s = std::sin(2 * M_PI * k / kDirections);
    return {share * c * (c > 0 ? follow.cruise_m_s : follow.max_back_m_s),
            share * s * follow.max_left_m_s, 0};
  }

  bool leads_past(const BodyState& from, const VelocityCommand& wanted, double until_s) const {
    RobotPose robot = from.robot;
    VelocityCommand command = from.real;
    VelocityCommand real = from.real;
    const auto towards = [](double at, double to, double by) {
      return at + std::clamp(to - at, -by, by);
    };
    for (double t_s = from.t_s; t_s < until_s; t_s += kStep_s) {
      for (const Walker& walker : world_.walkers) {
        if (gap_to_point(config_, robot, walker.p + walker.v * t_s) <= walker.r) return false;
      }
      const double by = config_.follow.acceleration_m_s2 * kStep_s;
      command.forward_m_s = towards(command.forward_m_s, wanted.forward_m_s, by);
      command.left_m_s = towards(command.left_m_s, wanted.left_m_s, by);
      const double share = kStep_s / 0.15;
      real.forward_m_s += share * (command.forward_m_s - real.forward_m_s);
      real.left_m_s += share * (command.left_m_s - real.left_m_s);
      real.yaw_rate_rad_s -= share * real.yaw_rate_rad_s;
      const double c = std::cos(robot.yaw_rad);
      const double s = std::sin(robot.yaw_rad);
      robot.p_O_m += Vector2(c * real.forward_m_s - s * real.left_m_s,
                             s * real.forward_m_s + c * real.left_m_s) *
                     kStep_s;
      robot.yaw_rad += real.yaw_rate_rad_s * kStep_s;
    }
    return true;
  }

  const World& world_;
  const NavigationConfig& config_;
};

}  // namespace surefoot::navigation::test
