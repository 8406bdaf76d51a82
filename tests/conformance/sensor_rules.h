// Rules that all sensor ports share, once for all backends.
//
// Ports that hand over lists (ImuPort, PosePort) and ports that hand over one frame
// (DepthCameraPort, LidarPort, StereoCameraPort):
//   SENSOR-EMPTY     nothing waiting (or no room): 0 or kUnavailable, nothing written, nothing lost
//   SENSOR-BOUND     never more samples than asked for
//   SENSOR-ORDER     oldest first: stamps and sequence numbers grow
//   SENSOR-FORM      values are in their documented domain
//   SENSOR-COMPLETE  whatever arrives is delivered or counted as dropped
//   SENSOR-COUNT     delivered counts what was delivered, counters never go back
//   SENSOR-GAP       sequence numbers missing before the host are counted as gaps, and only those:
//                    what a full queue drops is counted once, as dropped
// OperatorPort:
//   OPERATOR-EMPTY, -FORM, -COUNT  as above
//   OPERATOR-NEWEST  the newest command is delivered, once
//   OPERATOR-DROPPED older ones are counted as dropped
// StereoCameraPort also:
//   STEREO-TRIGGER   a trigger is accepted and a pair comes of it
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/fields.h"
#include "hal/api/depth_camera_port.h"
#include "hal/api/imu_port.h"
#include "hal/api/lidar_port.h"
#include "hal/api/operator_port.h"
#include "hal/api/pose_port.h"
#include "hal/api/stereo_camera_port.h"
#include "tests/conformance/violations.h"

namespace surefoot::conformance {

// A backend and what its suite needs to stimulate it.
template <class PortType, class SampleType>
class SensorBench {
 public:
  using Port = PortType;
  using Sample = SampleType;

  virtual ~SensorBench() = default;
  virtual Port& port() = 0;
  // Lets at least `count` samples arrive, if the source has them. Returns how many did at least.
  virtual std::size_t arrive(std::size_t count) = 0;
  // Loses `count` samples before the host. false: the backend cannot be made to.
  virtual bool lose(std::size_t) { return false; }
  // Samples that fit into the port's queue; 0: not known or not limited.
  virtual std::size_t capacity() const { return 0; }
};

using ImuBench = SensorBench<hal::ImuPort, hal::ImuSample>;
using PoseBench = SensorBench<hal::PosePort, hal::PoseSample>;
using DepthBench = SensorBench<hal::DepthCameraPort, hal::DepthFrame>;
using LidarBench = SensorBench<hal::LidarPort, hal::LidarScan>;
using StereoBench = SensorBench<hal::StereoCameraPort, hal::StereoFrame>;
using OperatorBench = SensorBench<hal::OperatorPort, hal::OperatorCommand>;

// Empty: the sample is in its domain. Else what is wrong.
std::string form_fault(const hal::ImuSample& sample);
std::string form_fault(const hal::PoseSample& sample);
std::string form_fault(const hal::DepthFrame& frame);
std::string form_fault(const hal::LidarScan& scan);
std::string form_fault(const hal::StereoFrame& frame);
std::string form_fault(const hal::OperatorCommand& command);

template <class Sample>
std::uint64_t digest(const Sample& sample) {
  Fnv64 hash;
  FieldHasher hasher(hash);
  hasher.members(sample);
  return hash.value();
}

// What a delivered sample leaves behind: images are too large to keep.
struct Delivered {
  TimeNs stamp;
  std::uint32_t sequence = 0;
};

// One call; appends what was delivered. Returns how many.
template <class Port, class Sample>
class Receiver {
 public:
  Receiver(Port& port, Findings& findings) : port_(port), findings_(findings) {}

  std::size_t receive(std::size_t chunk, std::vector<Delivered>& out) {
    if constexpr (requires(std::span<Sample> s) { port_.receive(s); }) {
      std::vector<Sample> buffer(chunk + 1, marked());
      const std::size_t count = port_.receive(std::span<Sample>(buffer).first(chunk));
      findings_.expect(count <= chunk, "SENSOR-BOUND", std::to_string(count) + " samples");
      const std::uint64_t mark = digest(marked());
      findings_.expect(digest(buffer[chunk]) == mark, "SENSOR-BOUND", "wrote beyond the room");
      if (count == 0 && chunk > 0) {
        findings_.expect(digest(buffer[0]) == mark, "SENSOR-EMPTY", "wrote without a sample");
      }
      for (std::size_t i = 0; i < count && i < chunk; ++i) note(buffer[i], out);
      return count;
    } else {
      auto frame = std::make_unique<Sample>(marked());
      const std::uint64_t mark = digest(*frame);
      const Status status = port_.receive(*frame);
      if (ok(status)) {
        note(*frame, out);
        return 1;
      }
      findings_.expect(status == Status::kUnavailable, "SENSOR-EMPTY", to_string(status));
      findings_.expect(digest(*frame) == mark, "SENSOR-EMPTY", "wrote without a frame");
      return 0;
    }
  }

 private:
  static Sample marked() {
    Sample sample{};
    sample.stamp = {-12345};
    sample.sequence = 0xA5A5A5A5u;
    return sample;
  }
  void note(const Sample& sample, std::vector<Delivered>& out) {
    const std::string fault = form_fault(sample);
    findings_.expect(fault.empty(), "SENSOR-FORM", fault);
    out.push_back({sample.stamp, sample.sequence});
  }

  Port& port_;
  Findings& findings_;
};

inline bool never_back(const hal::SensorCounters& before, const hal::SensorCounters& after) {
  return before.delivered <= after.delivered && before.dropped <= after.dropped &&
         before.gaps <= after.gaps && before.corrupt <= after.corrupt;
}

template <class Bench>
class SensorSuite {
 public:
  using Port = typename Bench::Port;
  using Sample = typename Bench::Sample;

  explicit SensorSuite(Bench& bench)
      : bench_(bench), port_(bench.port()), receiver_(port_, findings_) {}

  Violations run() {
    drain(16);
    check_empty();
    for (const std::size_t chunk : {std::size_t{1}, std::size_t{3}, std::size_t{16}}) {
      check_delivery(chunk, 4);
    }
    if (bench_.capacity() > 0) check_delivery(16, bench_.capacity() + 3);
    check_gaps();
    if constexpr (requires { port_.trigger(); }) check_trigger();
    return findings_.take();
  }

 private:
  static constexpr std::size_t kAtMost = 100'000;  // of a backend that never runs dry

  std::vector<Delivered> drain(std::size_t chunk) {
    std::vector<Delivered> all;
    for (;;) {
      const std::size_t count = receiver_.receive(chunk, all);
      if (count == 0 || all.size() > kAtMost) return all;
    }
  }

  void check_empty() {
    std::vector<Delivered> got;
    receiver_.receive(4, got);
    findings_.expect(got.empty(), "SENSOR-EMPTY", "samples where none arrived");
    const std::size_t arrived = bench_.arrive(1);
    if constexpr (requires(std::span<Sample> s) { port_.receive(s); }) {
      findings_.expect(receiver_.receive(0, got) == 0, "SENSOR-EMPTY", "samples into no room");
    }
    findings_.expect(drain(16).size() >= arrived, "SENSOR-EMPTY", "the sample got lost");
  }

  void check_delivery(std::size_t chunk, std::size_t wanted) {
    const hal::SensorCounters before = port_.counters();
    const std::size_t arrived = bench_.arrive(wanted);
    const std::vector<Delivered> got = drain(chunk);
    const hal::SensorCounters after = port_.counters();
    const std::uint64_t dropped = after.dropped - before.dropped;
    for (std::size_t i = 0; i < got.size(); ++i) check_order(got[i]);
    findings_.expect(got.size() + dropped >= arrived, "SENSOR-COMPLETE",
                     std::to_string(arrived) + " arrived, " + std::to_string(got.size()) +
                         " delivered, " + std::to_string(dropped) + " dropped");
    findings_.expect(never_back(before, after), "SENSOR-COUNT", "a counter went back");
    findings_.expect(after.delivered - before.delivered == got.size(), "SENSOR-COUNT",
                     std::to_string(after.delivered - before.delivered) + " counted, " +
                         std::to_string(got.size()) + " delivered");
    findings_.expect(after.gaps == before.gaps, "SENSOR-GAP",
                     std::to_string(after.gaps - before.gaps) + " counted where none was lost");
  }

  void check_order(const Delivered& sample) {
    if (any_) {
      findings_.expect(last_.stamp < sample.stamp, "SENSOR-ORDER", "stamps do not grow");
      findings_.expect(static_cast<std::int32_t>(sample.sequence - last_.sequence) > 0,
                       "SENSOR-ORDER", "sequence numbers do not grow");
    }
    any_ = true;
    last_ = sample;
  }

  void check_gaps() {
    if (bench_.arrive(1) == 0) return;
    const hal::SensorCounters before = port_.counters();
    if (!bench_.lose(3) || bench_.arrive(1) == 0) return;
    drain(16);
    const hal::SensorCounters after = port_.counters();
    findings_.expect(after.gaps - before.gaps == 3, "SENSOR-GAP",
                     std::to_string(after.gaps - before.gaps) + " counted, 3 lost");
    findings_.expect(after.dropped == before.dropped, "SENSOR-GAP",
                     "losses before the host were counted as drops of the host");
  }

  void check_trigger() requires requires(Port& port) { port.trigger(); }
  {
    drain(1);
    findings_.expect(ok(port_.trigger()), "STEREO-TRIGGER", "refused");
    bench_.arrive(0);
    std::vector<Delivered> got;
    receiver_.receive(1, got);
    findings_.expect(got.size() == 1, "STEREO-TRIGGER", "no pair came of it");
  }

  Bench& bench_;
  Port& port_;
  Findings findings_;
  Receiver<Port, Sample> receiver_;
  bool any_ = false;
  Delivered last_;
};

template <class Bench>
Violations sensor_violations(Bench& bench) {
  return SensorSuite<Bench>(bench).run();
}

Violations operator_violations(OperatorBench& bench);

}  // namespace surefoot::conformance
