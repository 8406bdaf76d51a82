// A robot without dynamics around the autonomy: joints go where they are told, level attitude, feet
// on the ground feel their share of the weight. Enough to stand up and to trot, always the same.
#pragma once

#include <array>

#include "apps/common/config_root.h"
#include "core/autonomy/autonomy.h"

namespace surefoot::timing {

struct KinematicInputs {
  std::size_t imu_samples = 2;
  std::size_t can_frames = robot::kJoints;  // replies; beyond twelve the drives repeat themselves
};

class KinematicRobot {
 public:
  explicit KinematicRobot(const apps::Config& config);

  // One tick in three parts; the middle one is the control task.
  void prepare(const KinematicInputs& amounts = {});
  void run() { autonomy_.run_control(); }
  void apply();
  void tick() {
    prepare();
    run();
    apply();
  }
  // Ticks until the autonomy is in the phase; false: it is not after `most` ticks.
  bool reach(autonomy::MissionPhase phase, std::size_t most);

  const autonomy::Telemetry& telemetry() const { return outputs_.telemetry; }
  autonomy::Autonomy& autonomy() { return autonomy_; }
  autonomy::TickInputs& inputs() { return inputs_; }
  TimeNs now() const { return inputs_.stamp; }
  // Of the trunk's centre over the ground, as the lowest foot says.
  double height_m() const { return height_m_; }

 private:
  hal::CanFrame reply(std::size_t joint) const;
  void feel_ground();

  robot::RobotModel model_;
  autonomy::Autonomy autonomy_;
  actuation::JointBus bus_;  // reads the command frames
  autonomy::TickInputs inputs_;
  autonomy::TickOutputs outputs_;
  double height_m_ = 0;
  std::array<double, robot::kJoints> q_rad_{};
  std::array<double, robot::kJoints> qd_rad_s_{};
  robot::Dynamics dynamics_;
  robot::GeneralisedVector acceleration_ = robot::GeneralisedVector::Zero();
  std::array<double, robot::kJoints> torque_Nm_{};
};

}  // namespace surefoot::timing
