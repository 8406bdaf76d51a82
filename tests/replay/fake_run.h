// A made-up robot and autonomy for record and replay: inputs of every kind from a seed, a control
// task that mixes them into its outputs, a slow task on the depth frames with injected overruns.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/random.h"
#include "core/runtime/executive.h"
#include "tests/unit/runtime/fake_board.h"

namespace surefoot::testing {

// State that depends on every input it ever saw.
struct FakeAutonomy {
  // Spoils the output at one tick, as a replay with changed code would.
  std::uint64_t tamper_tick = UINT64_MAX;

  double position_m = 0;
  std::uint64_t seen = 0;
  std::uint64_t tick = 0;
  std::uint64_t depth_sum = 0;  // of the slow task's snapshot
  std::uint64_t working = 0;
  std::uint64_t published = 0;

  static bool control_release(void* self, const autonomy::TickInputs& inputs) {
    auto& a = *static_cast<FakeAutonomy*>(self);
    a.tick = inputs.tick;
    for (const auto& frame : inputs.can) a.seen = a.seen * 31 + frame.id + frame.data[0];
    for (const auto& sample : inputs.imu) a.position_m += 1e-3 * sample.specific_force_I_m_s2[0];
    for (const auto& sample : inputs.pose) a.position_m += 1e-4 * sample.p_ST_m[1];
    if (inputs.operator_fresh) a.position_m += inputs.operator_command.forward_m_s;
    if (inputs.stereo_fresh) {
      a.seen = a.seen * 31 + inputs.stereo->left[3] + inputs.stereo->right[5];
    }
    if (inputs.lidar_fresh) a.position_m += inputs.lidar->range_m[4];
    for (const auto& sample : inputs.gait) a.position_m += 1e-3 * sample.velocity_B_m_s[0];
    if (inputs.late) a.seen += 7;
    return true;
  }
  static void control_run(void*) {}
  static void control_publish(void* self, autonomy::TickOutputs& outputs) {
    auto& a = *static_cast<FakeAutonomy*>(self);
    hal::CanFrame frame;
    frame.id = static_cast<std::uint32_t>(a.seen & 0x7FF);
    frame.size = 8;
    for (std::size_t i = 0; i < 8; ++i)
      frame.data[i] = static_cast<std::uint8_t>(a.seen >> (8 * i));
    for (std::uint8_t bus = 0; bus < 3; ++bus) {
      frame.bus = bus;
      const Status status = outputs.can.push_back(frame);
      SUREFOOT_ASSERT(ok(status));
    }
    outputs.gait.walk = a.tick % 3 == 1;
    outputs.gait.forward_m_s = a.position_m;
    outputs.stereo_trigger = a.tick % 20 == 3;
    outputs.telemetry.p_OB_m[0] = a.position_m;
    outputs.telemetry.replies_missed = a.published;
    outputs.telemetry.legs[2].foot_O_m[1] = a.tick == a.tamper_tick ? -0.125 : 0.25;
  }
  static bool map_release(void* self, const autonomy::TickInputs& inputs) {
    auto& a = *static_cast<FakeAutonomy*>(self);
    if (!inputs.depth_fresh) return false;
    a.depth_sum = 0;
    for (std::size_t i = 0; i < inputs.depth->pixel_count(); ++i) {
      a.depth_sum += inputs.depth->depth[i];
    }
    return true;
  }
  static void map_run(void* self) {
    auto& a = *static_cast<FakeAutonomy*>(self);
    a.working = a.working * 17 + a.depth_sum;
  }
  static void map_publish(void* self, autonomy::TickOutputs& outputs) {
    auto& a = *static_cast<FakeAutonomy*>(self);
    a.published = a.working;
    outputs.telemetry.map_digest = a.published;
  }
  std::array<runtime::Task, 2> table() {
    return {
        runtime::Task{"control", 1, 0, 0, 100, this, control_release, control_run, control_publish},
        runtime::Task{"map", 5, 2, 3, 1000, this, map_release, map_run, map_publish}};
  }
};

// Fills a fake board with the inputs of one tick.
class FakeInputs {
 public:
  explicit FakeInputs(std::uint64_t seed) : random_(seed) {}

  void feed(FakeBoard& board, std::uint64_t tick) {
    const std::uint32_t frames = random_.below(14);
    for (std::uint32_t i = 0; i < frames; ++i) {
      hal::CanFrame frame;
      frame.stamp = board.clock.time;
      frame.id = random_.below(0x800);
      frame.size = static_cast<std::uint8_t>(random_.below(9));
      for (std::size_t k = 0; k < frame.size; ++k) {
        frame.data[k] = static_cast<std::uint8_t>(random_.below(256));
      }
      board.can.push(frame);
    }
    hal::ImuSample sample;
    sample.specific_force_I_m_s2[0] = random_.uniform(-1, 1);
    board.imu.push(sample);
    if (tick % 3 == 0) {
      hal::PoseSample pose;
      pose.p_ST_m[1] = random_.uniform();
      board.pose.push(pose);
    }
    if (tick % 50 == 10) {
      board.operator_port.fresh = true;
      board.operator_port.command.forward_m_s = random_.uniform();
    }
    if (tick % 5 == 2) feed_depth(board);
    if (tick % 20 == 12) feed_stereo(board);
    if (tick % 7 == 4) feed_lidar(board);
    if (tick % 2 == 1) {
      hal::GaitSample gait;
      gait.sequence = static_cast<std::uint32_t>(tick);
      gait.velocity_B_m_s[0] = random_.uniform();
      board.gait.push(gait);
    }
  }

 private:
  void feed_depth(FakeBoard& board) {
    board.depth.frame.intrinsics.width_px = 80;
    board.depth.frame.intrinsics.height_px = 60;
    for (std::size_t i = 0; i < board.depth.frame.pixel_count(); ++i) {
      board.depth.frame.depth[i] = static_cast<std::uint16_t>(500 + random_.below(2000));
    }
    board.depth.waiting = 1;
  }

  void feed_stereo(FakeBoard& board) {
    hal::StereoFrame& frame = board.stereo.frame;
    frame.width_px = 24;
    frame.height_px = 16;
    for (std::size_t i = 0; i < frame.pixel_count(); ++i) {
      frame.left[i] = static_cast<std::uint8_t>(random_.below(256));
      frame.right[i] = static_cast<std::uint8_t>(random_.below(256));
    }
    board.stereo.waiting = 1;
  }

  void feed_lidar(FakeBoard& board) {
    board.lidar.scan.beam_count = 19;
    for (std::size_t i = 0; i < 19; ++i) {
      board.lidar.scan.range_m[i] = static_cast<float>(random_.uniform(0.5, 20.0));
    }
    board.lidar.waiting = 1;
  }

  Random random_;
};

}  // namespace surefoot::testing
