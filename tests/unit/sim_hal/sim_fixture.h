// A Mini-Cheetah and the small pieces that drive it over CAN, for the simulator's tests.
// Figures: MIT Cheetah-Software (research/locomotion.md 1.1).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/actuation/motor_protocol.h"
#include "core/robot/robot_model.h"
#include "sim_hal/simulator.h"

namespace surefoot::sim {

inline constexpr double kKneeBelt = 1.5549;

inline robot::Actuator motor(double gear_ratio, double torque_limit_Nm, double no_load_rad_s) {
  robot::Actuator actuator;
  actuator.gear_ratio = gear_ratio;
  actuator.rotor_inertia_kg_m2 = 63e-6;
  actuator.rotor_mass_kg = 0.055;
  actuator.torque_limit_Nm = torque_limit_Nm;
  actuator.stall_torque_Nm = 6.94 * gear_ratio;  // 24 V / 0.173 ohm * 0.05 N m / A
  actuator.no_load_speed_rad_s = no_load_rad_s;
  actuator.viscous_friction_Nm_s = 0.01;
  actuator.dry_friction_Nm = 0.2;
  actuator.min_rad = -3.1;
  actuator.max_rad = 3.1;
  return actuator;
}

// Wiring with every trap in it: mixed directions, a belt and offsets.
inline robot::JointWiring wiring(std::size_t leg, std::size_t joint) {
  robot::JointWiring w;
  w.bus = static_cast<std::uint8_t>(leg);
  w.can_id = static_cast<std::uint16_t>(joint + 1);
  w.direction = (leg + joint) % 2 == 0 ? 1.0 : -1.0;
  w.belt_ratio = joint == 2 ? kKneeBelt : 1.0;
  w.offset_rad = joint == 1 ? 1.5708 : (joint == 2 ? -4.35 : 0.0);
  w.position_range_rad = 12.5;
  w.velocity_range_rad_s = 65;
  w.kp_max_Nm_rad = 500;
  w.kd_max_Nm_s_rad = 5;
  w.torque_range_Nm = 18;
  return w;
}

inline robot::RobotModel mini_cheetah() {
  robot::RobotModel m;
  m.trunk = {3.3, {0, 0, 0}, {0.011253, 0.036203, 0.042673, 0, 0, 0}};
  m.trunk_size_m = {0.38, 0.2, 0.1};
  m.abad_x_m = 0.19;
  m.abad_y_m = 0.049;
  m.hip_offset_m = 0.062;
  m.thigh_length_m = 0.209;
  m.knee_offset_m = 0.004;
  m.shank_length_m = 0.195;
  m.foot_radius_m = 0.015;
  m.thigh_radius_m = 0.02;
  m.shank_radius_m = 0.01;
  m.abad = {0.54, {0, 0.036, 0}, {381e-6, 560e-6, 444e-6, 58e-6, 0.45e-6, 0.95e-6}};
  m.thigh = {0.634, {0, 0.016, -0.02}, {1983e-6, 2103e-6, 408e-6, 245e-6, 13e-6, 1.5e-6}};
  m.shank = {0.064, {0, 0, -0.061}, {245e-6, 248e-6, 6e-6, 0, 0, 0}};
  m.actuators = {motor(6, 17, 40), motor(6, 17, 40), motor(6 * kKneeBelt, 26, 25.7)};
  for (std::size_t i = 0; i < robot::kJoints; ++i) m.wiring[i] = wiring(i / 3, i % 3);
  m.drive_timeout_s = 0.025;
  m.imu.mount = {{0.02, -0.01, 0.03}, {0, 0, 0}};
  m.imu.rate_Hz = 1000;
  robot::DepthCameraSpecification& camera = m.depth_camera;
  camera.mount = {{0.28, 0, 0.03}, {0, 0.6, 0}};
  camera.width_px = 160;
  camera.height_px = 90;
  camera.horizontal_view_rad = 1.518;
  camera.vertical_view_rad = 1.012;
  camera.rate_Hz = 30;
  camera.min_range_m = 0.17;
  camera.max_range_m = 3.0;
  camera.disparity_noise_px = 0.08;
  camera.baseline_m = 0.05;
  camera.native_width_px = 848;
  return m;
}

inline actuation::WireRanges ranges(const robot::JointWiring& w) {
  return {w.position_range_rad, w.velocity_range_rad_s, w.kp_max_Nm_rad, w.kd_max_Nm_s_rad,
          w.torque_range_Nm};
}

inline hal::CanFrame frame_for(const robot::JointWiring& w, const actuation::CommandBytes& bytes) {
  hal::CanFrame frame;
  frame.id = w.can_id;
  frame.bus = w.bus;
  frame.size = 8;
  for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
  return frame;
}

struct JointGoal {
  double position_rad = 0;
  double kp_Nm_rad = 0;  // at the joint
  double kd_Nm_s_rad = 0;
  double torque_Nm = 0;
};

// Drives the simulator tick by tick, as an executive would.
class Rig {
 public:
  static constexpr TimeNs kTick = milliseconds(2);

  // Not `config = {}`: g++ 12 crashes on that.
  explicit Rig(const WorldSpec& world = {}, const SimulatorConfig& config = SimulatorConfig(),
               std::uint64_t seed = 1, const robot::RobotModel& robot = mini_cheetah())
      : model(robot),
        simulator(std::make_unique<Simulator>(robot, world, config, seed)),
        board(simulator->board()) {}

  void send_special(actuation::FrameKind kind) {
    for (const robot::JointWiring& w : model.wiring) {
      accepted = ok(board.can->send(frame_for(w, actuation::encode_special(kind)))) && accepted;
    }
  }
  void send(std::size_t joint, const JointGoal& goal) {
    const robot::JointWiring& w = model.wiring[joint];
    const double factor = w.direction * w.belt_ratio;
    const actuation::DriveCommand command{
        factor * goal.position_rad + w.offset_rad, 0.0, goal.kp_Nm_rad / (factor * factor),
        goal.kd_Nm_s_rad / (factor * factor), goal.torque_Nm / factor};
    actuation::CommandBytes bytes{};
    accepted = ok(actuation::encode_command(ranges(w), command, bytes)) && accepted;
    accepted = ok(board.can->send(frame_for(w, bytes))) && accepted;
  }
  void send_all(const std::array<double, 3>& leg_rad, double kp, double kd) {
    for (std::size_t i = 0; i < robot::kJoints; ++i) send(i, {leg_rad[i % 3], kp, kd, 0});
  }
  std::size_t tick() {
    time = time + kTick;
    accepted = ok(board.clock->wait_until(time)) && accepted;
    return board.can->receive(replies);
  }
  // Enables the drives and rises from the folded pose within 1 s, then stands.
  void stand(double seconds, double kp = 80, double kd = 2) {
    send_special(actuation::FrameKind::kEnterMotorMode);
    tick();
    const int ticks = static_cast<int>(seconds / kTick.seconds());
    for (int i = 0; i < ticks; ++i) {
      const double s = std::min(1.0, 0.002 * i);
      send_all({0.0, -1.4 + s * 0.6, 2.7 - s * 1.1}, kp, kd);
      tick();
    }
  }

  robot::RobotModel model;
  std::unique_ptr<Simulator> simulator;
  hal::Board board;
  TimeNs time;
  std::array<hal::CanFrame, 64> replies{};
  bool accepted = true;
};

}  // namespace surefoot::sim
