// The four simulated CAN buses with the drives on them. A frame takes frame_time on its bus; a
// command reaches its drive when it is through, the reply follows at once, one per frame, as the
// firmware does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/random.h"
#include "core/base/ring_buffer.h"
#include "core/base/time.h"
#include "core/robot/robot_model.h"
#include "hal/api/can_port.h"
#include "sim_hal/robot/drive.h"
#include "sim_hal/simulator_config.h"

namespace surefoot::sim {

class SimCanPort final : public hal::CanPort {
 public:
  static constexpr std::size_t kQueue = 64;  // per bus and direction

  SimCanPort(const robot::RobotModel& model, const CanConfig& config, const FaultConfig& faults,
             std::uint64_t seed);

  // Brings the buses up to `now`: frames that are through reach their drives, which see the joints
  // as they are now.
  void advance(TimeNs now, const std::array<double, robot::kJoints>& positions_rad,
               const std::array<double, robot::kJoints>& velocities_rad_s);
  // Torques at the joints for the step that begins at `now`.
  std::array<double, robot::kJoints> torques_Nm(TimeNs now);

  std::uint64_t replies_lost() const { return replies_lost_; }
  std::uint64_t frames_unanswered() const { return frames_unanswered_; }

 private:
  struct Pending {
    TimeNs arrival;
    hal::CanFrame frame;
  };
  struct Bus {
    bool present = false;
    TimeNs free_at;
    RingBuffer<Pending, kQueue> to_drives;
    RingBuffer<hal::CanFrame, kQueue> to_host;
  };

  std::size_t do_receive(std::span<hal::CanFrame> out) override;
  Status do_send(const hal::CanFrame& frame) override;
  hal::CanCounters do_counters() const override { return counters_; }

  void deliver(Bus& bus, const Pending& pending);
  bool silent(std::size_t joint, TimeNs now) const;

  CanConfig config_;
  FaultConfig faults_;
  TimeNs frame_time_;
  TimeNs now_;
  std::array<robot::JointWiring, robot::kJoints> wiring_;
  std::array<Drive, robot::kJoints> drives_;
  std::array<Bus, hal::kMaxCanBuses> buses_;
  Random random_;
  hal::CanCounters counters_;
  std::uint64_t replies_lost_ = 0;
  std::uint64_t frames_unanswered_ = 0;
};

}  // namespace surefoot::sim
