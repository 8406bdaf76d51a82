#include "core/motions/motion.h"

#include "core/math/elementary.h"

namespace surefoot::motions {
namespace {

// Files hold rounded numbers.
constexpr double kRounding = 1e-3;

using math::magnitude;

MotionFault check_joint(const MotionRow& row, std::size_t planar, const robot::RobotModel& model) {
  const robot::Actuator& actuator = model.actuators[leg_joint(planar)];
  const double torque = row.torque_Nm[planar];
  const double speed = row.joint_rad_s[planar];
  if (magnitude(torque) > actuator.torque_limit_Nm) return MotionFault::kTorque;
  if (magnitude(speed) > actuator.no_load_speed_rad_s) return MotionFault::kSpeed;
  const double driving = torque < 0 ? -speed : speed;  // in the torque's sense
  const double most = actuator.stall_torque_Nm * (1.0 - driving / actuator.no_load_speed_rad_s);
  if (magnitude(torque) > most + kRounding) return MotionFault::kPower;
  const double angle = row.joint_rad[planar];
  if (angle < actuator.min_rad || angle > actuator.max_rad) return MotionFault::kStop;
  return MotionFault::kNone;
}

}  // namespace

MotionCheck check_motion(const Motion& motion, const robot::RobotModel& model) {
  const StartSet& start = motion.start;
  if (motion.rows.size() < 2) return {MotionFault::kTooShort, 0};
  if (start.edge_min_m > start.edge_max_m || start.rise_min_m > start.rise_max_m) {
    return {MotionFault::kStartSet, 0};
  }
  const double end_s = motion.rows[motion.rows.size() - 1].time_s;
  if (motion.rows[0].time_s != 0.0 || motion.front_lift_s > motion.hind_lift_s ||
      motion.hind_lift_s >= end_s) {
    return {MotionFault::kTimes, 0};
  }
  for (std::size_t i = 0; i < motion.rows.size(); ++i) {
    if (i > 0 && motion.rows[i].time_s < motion.rows[i - 1].time_s) {
      return {MotionFault::kTimes, i};
    }
    for (std::size_t joint = 0; joint < kPlanarJoints; ++joint) {
      const MotionFault fault = check_joint(motion.rows[i], joint, model);
      if (fault != MotionFault::kNone) return {fault, i};
    }
  }
  return {};
}

MotionRow motion_at(const Motion& motion, double time_s, std::size_t& hint) {
  const std::size_t last = motion.rows.size() - 1;
  SUREFOOT_ASSERT(last >= 1);
  if (hint >= last || motion.rows[hint].time_s > time_s) hint = 0;
  while (hint + 1 < last && motion.rows[hint + 1].time_s <= time_s) ++hint;
  const MotionRow& a = motion.rows[hint];
  const MotionRow& b = motion.rows[hint + 1];
  const double h = b.time_s - a.time_s;
  if (time_s >= b.time_s || h <= 0.0) return b;
  if (time_s <= a.time_s) return a;
  const double s = (time_s - a.time_s) / h;
  const double c = 1.0 - s;
  const auto linear = [&](double p, double q) { return p * c + q * s; };
  const auto cubic = [&](double p, double dp, double q, double dq) {
    return p * c * c * (1.0 + 2.0 * s) + q * s * s * (3.0 - 2.0 * s) +
           h * s * c * (c * dp - s * dq);
  };
  MotionRow row;
  row.time_s = time_s;
  for (std::size_t i = 0; i < 3; ++i) {
    row.trunk[i] = cubic(a.trunk[i], a.trunk_rate[i], b.trunk[i], b.trunk_rate[i]);
    row.trunk_rate[i] = linear(a.trunk_rate[i], b.trunk_rate[i]);
  }
  for (std::size_t i = 0; i < kPlanarJoints; ++i) {
    row.joint_rad[i] = cubic(a.joint_rad[i], a.joint_rad_s[i], b.joint_rad[i], b.joint_rad_s[i]);
    row.joint_rad_s[i] = linear(a.joint_rad_s[i], b.joint_rad_s[i]);
    row.torque_Nm[i] = linear(a.torque_Nm[i], b.torque_Nm[i]);
    row.force_N[i] = linear(a.force_N[i], b.force_N[i]);
  }
  return row;
}

}  // namespace surefoot::motions
