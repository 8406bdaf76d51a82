#include "sim_hal/robot/sim_can_port.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {

namespace {
constexpr std::uint64_t kCanStream = 4;
constexpr std::uint32_t kLargestStandardId = 0x7FF;
}  // namespace

SimCanPort::SimCanPort(const robot::RobotModel& model, const CanConfig& config,
                       const FaultConfig& faults, std::uint64_t seed)
    : config_(config),
      faults_(faults),
      frame_time_{static_cast<std::int64_t>(std::llround(config.frame_time_s * 1e9))},
      wiring_(model.wiring),
      random_(seed, kCanStream) {
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    drives_[joint] = Drive(model.wiring[joint], model.actuators[joint % robot::kJointsPerLeg],
                           model.drive_timeout_s);
    buses_[model.wiring[joint].bus].present = true;
  }
}

Status SimCanPort::do_send(const hal::CanFrame& frame) {
  if (frame.size > 8 || frame.id > kLargestStandardId || frame.flags != 0) return Status::kInvalid;
  if (frame.bus >= buses_.size() || !buses_[frame.bus].present) {
    ++counters_.send_dropped;
    return Status::kUnavailable;
  }
  Bus& bus = buses_[frame.bus];
  // The wire is shared with the replies: each frame waits for its turn.
  const TimeNs arrival = std::max(bus.free_at, now_) + frame_time_;
  if (!ok(bus.to_drives.push({arrival, frame}))) {
    ++counters_.send_dropped;
    return Status::kExhausted;
  }
  bus.free_at = arrival + frame_time_;
  ++counters_.sent;
  return Status::kOk;
}

void SimCanPort::advance(TimeNs now, const std::array<double, robot::kJoints>& positions_rad,
                         const std::array<double, robot::kJoints>& velocities_rad_s) {
  now_ = now;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    drives_[joint].sense(positions_rad[joint], velocities_rad_s[joint]);
  }
  for (Bus& bus : buses_) {
    while (!bus.to_drives.empty() && bus.to_drives.front().arrival <= now) {
      deliver(bus, bus.to_drives.front());
      bus.to_drives.pop_front();
    }
  }
}

bool SimCanPort::silent(std::size_t joint, TimeNs now) const {
  return faults_.silent_joint == static_cast<std::int32_t>(joint) &&
         now.seconds() >= faults_.silent_from_s;
}

void SimCanPort::deliver(Bus& bus, const Pending& pending) {
  const hal::CanFrame& frame = pending.frame;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    if (wiring_[joint].bus != frame.bus || wiring_[joint].can_id != frame.id) continue;
    if (silent(joint, pending.arrival)) {
      ++replies_lost_;
      return;
    }
    Drive& drive = drives_[joint];
    if (!drive.receive({frame.data.data(), frame.size}, pending.arrival)) break;
    const double position_noise = config_.encoder_noise_rad * random_.normal();
    const double velocity_noise = config_.velocity_noise_rad_s * random_.normal();
    const bool lost = random_.uniform() < config_.reply_loss;
    if (lost) {
      ++replies_lost_;
      return;
    }
    const actuation::ReplyBytes bytes =
        drive.reply(config_.reply_size, position_noise, velocity_noise);
    hal::CanFrame reply;
    reply.stamp = pending.arrival + frame_time_;
    reply.id = config_.reply_id;
    reply.bus = frame.bus;
    reply.size = bytes.size;
    std::copy_n(bytes.data.begin(), bytes.size, reply.data.begin());
    if (bus.to_host.push_overwrite(reply)) ++counters_.receive_dropped;
    return;
  }
  ++frames_unanswered_;
}

std::size_t SimCanPort::do_receive(std::span<hal::CanFrame> out) {
  std::size_t count = 0;
  while (count < out.size()) {
    Bus* oldest = nullptr;
    for (Bus& bus : buses_) {
      if (bus.to_host.empty() || bus.to_host.front().stamp > now_) continue;
      if (oldest == nullptr || bus.to_host.front().stamp < oldest->to_host.front().stamp) {
        oldest = &bus;
      }
    }
    if (oldest == nullptr) break;
    out[count++] = oldest->to_host.front();
    oldest->to_host.pop_front();
    ++counters_.received;
  }
  return count;
}

std::array<double, robot::kJoints> SimCanPort::torques_Nm(TimeNs now) {
  std::array<double, robot::kJoints> torques{};
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const double torque = drives_[joint].joint_torque_Nm(now);
    torques[joint] = silent(joint, now) ? 0.0 : torque;
  }
  return torques;
}

}  // namespace surefoot::sim
