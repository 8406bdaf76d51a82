// The suites themselves: they find nothing wrong with the queue backends, and they find every
// defect.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <ostream>

#include "tests/conformance/can_port_rules.h"
#include "tests/conformance/clock_rules.h"
#include "tests/conformance/queue_backends.h"
#include "tests/conformance/record_sink_rules.h"
#include "tests/conformance/sensor_rules.h"

namespace surefoot::conformance {
namespace {

// A defect and the rule that must catch it.
struct Case {
  Defect defect;
  const char* rule;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.rule; }

void expect_verdict(const Case& c, const Violations& violations) {
  if (c.defect == Defect::kNone) {
    EXPECT_EQ(joined(violations), "");
  } else {
    EXPECT_TRUE(Findings::breaks(violations, c.rule)) << c.rule << " not in:\n"
                                                      << joined(violations);
  }
}

class QueueCanBench final : public CanBench {
 public:
  explicit QueueCanBench(Defect defect) : port_(defect) {}
  hal::CanPort& port() override { return port_; }
  std::size_t arrive(std::uint8_t bus, std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      hal::CanFrame frame;
      frame.stamp = milliseconds(static_cast<std::int64_t>(number_ / 1000 * 1000));  // many equal
      frame.bus = bus;
      frame.size = 4;
      for (unsigned byte = 0; byte < 4; ++byte) {
        frame.data[byte] = static_cast<std::uint8_t>(number_ >> (8 * byte));
      }
      ++number_;
      port_.push(frame);
    }
    return count;
  }
  std::int64_t number_of(const hal::CanFrame& frame) const override {
    std::int64_t number = 0;
    for (unsigned byte = 4; byte > 0; --byte) number = number * 256 + frame.data[byte - 1];
    return number;
  }
  std::size_t bus_count() const override { return QueueCanPort::kBuses; }
  std::size_t receive_capacity() const override { return QueueCanPort::kReceiveCapacity; }

 private:
  QueueCanPort port_;
  std::uint32_t number_ = 0;
};

class CanSuite : public testing::TestWithParam<Case> {};
TEST_P(CanSuite, FindsTheDefect) {
  QueueCanBench bench(GetParam().defect);
  expect_verdict(GetParam(), can_port_violations(bench));
}
INSTANTIATE_TEST_SUITE_P(
    Defects, CanSuite,
    testing::Values(
        Case{Defect::kNone, ""}, Case{Defect::kWritesWhenEmpty, "CAN-EMPTY"},
        Case{Defect::kIgnoresRoom, "CAN-EMPTY"}, Case{Defect::kNewestFirst, "CAN-ORDER"},
        Case{Defect::kSwapsBuses, "CAN-ORDER"}, Case{Defect::kNotCounted, "CAN-COUNT"},
        Case{Defect::kLosesSilently, "CAN-COMPLETE"}, Case{Defect::kDirtyPadding, "CAN-FORM"},
        Case{Defect::kBadForm, "CAN-FORM"}, Case{Defect::kAcceptsAnything, "CAN-REFUSE"},
        Case{Defect::kNoBusCheck, "CAN-NO-BUS"}, Case{Defect::kRefusesSilently, "CAN-SEND"}));

// Samples that are in their domain, or just outside.
void fill(hal::ImuSample& s, bool bad) { s.specific_force_I_m_s2[2] = bad ? NAN : 9.81; }
void fill(hal::PoseSample& s, bool bad) { s.q_ST_wxyz[0] = bad ? 0.9 : 1.0; }
void fill(hal::DepthFrame& f, bool bad) {
  f.intrinsics = {.width_px = 4, .height_px = 3, .fx_px = bad ? 0.0 : 5.0, .fy_px = 5.0};
}
void fill(hal::LidarScan& s, bool bad) {
  s.beam_count = 3;
  s.range_m[1] = bad ? -1.0F : 2.0F;
}
void fill(hal::StereoFrame& f, bool bad) {
  f.width_px = 4;
  f.height_px = bad ? 0 : 3;
}
void fill(hal::OperatorCommand& c, bool bad) { c.forward_m_s = bad ? NAN : 0.5; }

template <class Backend, class Bench>
class QueueBench final : public Bench {
 public:
  explicit QueueBench(Defect defect) : backend_(defect) {}
  typename Bench::Port& port() override { return backend_; }
  std::size_t arrive(std::size_t count) override {
    if constexpr (requires { backend_.take_trigger(); }) {
      if (backend_.take_trigger()) ++count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      auto sample = std::make_unique<typename Bench::Sample>();
      sample->sequence = sequence_++;
      sample->stamp = milliseconds(++number_);
      fill(*sample, backend_.queue().defect() == Defect::kBadForm);
      backend_.queue().push(*sample);
    }
    return count;
  }
  bool lose(std::size_t count) override {
    sequence_ += static_cast<std::uint32_t>(count);
    return true;
  }
  std::size_t capacity() const override { return SampleQueue<typename Bench::Sample>::kCapacity; }

 private:
  Backend backend_;
  std::uint32_t sequence_ = 0xFFFFFFF0u;  // wraps during the suite
  std::int64_t number_ = 0;
};

template <class Backend, class Bench>
void expect_sensor_verdict(const Case& c) {
  QueueBench<Backend, Bench> bench(c.defect);
  expect_verdict(c, sensor_violations<Bench>(bench));
}

class ListSensorSuite : public testing::TestWithParam<Case> {};
TEST_P(ListSensorSuite, FindsTheDefectInAnImu) {
  expect_sensor_verdict<QueueListPort<hal::ImuPort, hal::ImuSample>, ImuBench>(GetParam());
}
TEST_P(ListSensorSuite, FindsTheDefectInAPoseSource) {
  expect_sensor_verdict<QueueListPort<hal::PosePort, hal::PoseSample>, PoseBench>(GetParam());
}

class FrameSensorSuite : public testing::TestWithParam<Case> {};
TEST_P(FrameSensorSuite, FindsTheDefectInADepthCamera) {
  expect_sensor_verdict<QueueFramePort<hal::DepthCameraPort, hal::DepthFrame>, DepthBench>(
      GetParam());
}
TEST_P(FrameSensorSuite, FindsTheDefectInALidar) {
  expect_sensor_verdict<QueueFramePort<hal::LidarPort, hal::LidarScan>, LidarBench>(GetParam());
}
TEST_P(FrameSensorSuite, FindsTheDefectInAStereoCamera) {
  expect_sensor_verdict<QueueStereoPort, StereoBench>(GetParam());
}

const auto kSensorDefects = testing::Values(
    Case{Defect::kNone, ""}, Case{Defect::kWritesWhenEmpty, "SENSOR-EMPTY"},
    Case{Defect::kNewestFirst, "SENSOR-ORDER"}, Case{Defect::kDeliversTwice, "SENSOR-ORDER"},
    Case{Defect::kNotCounted, "SENSOR-COUNT"}, Case{Defect::kLosesSilently, "SENSOR-COMPLETE"},
    Case{Defect::kBadForm, "SENSOR-FORM"}, Case{Defect::kGapsUnseen, "SENSOR-GAP"},
    Case{Defect::kDropsAreGaps, "SENSOR-GAP"});
INSTANTIATE_TEST_SUITE_P(Defects, ListSensorSuite, kSensorDefects);
INSTANTIATE_TEST_SUITE_P(Defects, FrameSensorSuite, kSensorDefects);
INSTANTIATE_TEST_SUITE_P(DefectsOfLists, ListSensorSuite,
                         testing::Values(Case{Defect::kIgnoresRoom, "SENSOR-EMPTY"}));
TEST(StereoSuite, FindsATriggerThatDoesNothing) {
  expect_sensor_verdict<QueueStereoPort, StereoBench>({Defect::kIgnoresTrigger, "STEREO-TRIGGER"});
}

class OperatorSuite : public testing::TestWithParam<Case> {};
TEST_P(OperatorSuite, FindsTheDefect) {
  QueueBench<QueueOperatorPort, OperatorBench> bench(GetParam().defect);
  expect_verdict(GetParam(), operator_violations(bench));
}
INSTANTIATE_TEST_SUITE_P(Defects, OperatorSuite,
                         testing::Values(Case{Defect::kNone, ""},
                                         Case{Defect::kWritesWhenEmpty, "OPERATOR-EMPTY"},
                                         Case{Defect::kDropsNewest, "OPERATOR-NEWEST"},
                                         Case{Defect::kDeliversTwice, "OPERATOR-NEWEST"},
                                         Case{Defect::kLosesSilently, "OPERATOR-DROPPED"},
                                         Case{Defect::kNotCounted, "OPERATOR-COUNT"},
                                         Case{Defect::kBadForm, "OPERATOR-FORM"}));

class ClockSuite : public testing::TestWithParam<Case> {};
TEST_P(ClockSuite, FindsTheDefect) {
  const int ticks =
      GetParam().defect == Defect::kIgnoresLate ? 100 : 15;  // outlives the suite or not
  SteppedClock clock(GetParam().defect, ticks);
  expect_verdict(
      GetParam(),
      clock_violations({.clock = &clock, .period = milliseconds(2), .allowed_overshoot = {0}}));
}
INSTANTIATE_TEST_SUITE_P(Defects, ClockSuite,
                         testing::Values(Case{Defect::kNone, ""},
                                         Case{Defect::kReturnsEarly, "CLOCK-WAIT"},
                                         Case{Defect::kIgnoresLate, "CLOCK-LATE"},
                                         Case{Defect::kGoesBack, "CLOCK-MONOTONIC"},
                                         Case{Defect::kComesBackToLife, "CLOCK-END"}));

class MemorySinkBench final : public RecordSinkBench {
 public:
  explicit MemorySinkBench(Defect defect) : sink_(defect) {}
  hal::RecordSink& sink() override { return sink_; }
  std::vector<StoredMessage> stored() override {
    std::vector<StoredMessage> all;
    for (const MemorySink::Entry& e : sink_.entries()) {
      all.push_back({e.channel, e.stamp, {e.bytes, e.bytes + e.size}});
    }
    return all;
  }

 private:
  MemorySink sink_;
};

class SinkSuite : public testing::TestWithParam<Case> {};
TEST_P(SinkSuite, FindsTheDefect) {
  MemorySinkBench bench(GetParam().defect);
  expect_verdict(GetParam(), record_sink_violations(bench));
}
INSTANTIATE_TEST_SUITE_P(
    Defects, SinkSuite,
    testing::Values(Case{Defect::kNone, ""}, Case{Defect::kKeepsReference, "SINK-COPY"},
                    Case{Defect::kForgets, "SINK-KEEP"}, Case{Defect::kNotCounted, "SINK-COUNT"},
                    Case{Defect::kLosesSilently, "SINK-COUNT"},
                    Case{Defect::kBadForm, "SINK-STATUS"}, Case{Defect::kAllocates, "SINK-HEAP"}));

}  // namespace
}  // namespace surefoot::conformance
