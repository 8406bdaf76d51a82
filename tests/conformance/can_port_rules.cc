#include "tests/conformance/can_port_rules.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace surefoot::conformance {
namespace {

using hal::CanCounters;
using hal::CanFrame;

constexpr std::size_t kSends = 20'000;  // more than any transmit queue holds

bool never_back(const CanCounters& before, const CanCounters& after) {
  return before.received <= after.received && before.sent <= after.sent &&
         before.receive_dropped <= after.receive_dropped &&
         before.send_dropped <= after.send_dropped && before.error_frames <= after.error_frames;
}

CanFrame marked_frame() {
  CanFrame frame;
  frame.id = 0x5A5;
  frame.bus = 0xEE;
  frame.size = 0xDD;
  return frame;
}

bool is_marked(const CanFrame& frame) {
  return frame.id == 0x5A5 && frame.bus == 0xEE && frame.size == 0xDD;
}

class CanSuite {
 public:
  explicit CanSuite(CanBench& bench) : bench_(bench), port_(bench.port()) {}

  Violations run() {
    drain();
    check_empty();
    check_delivery(1);
    check_delivery(3);
    check_delivery(64);
    check_overflow();
    if (bench_.sends()) {
      check_refusals();
      check_sending();
    }
    return findings_.take();
  }

 private:
  std::vector<CanFrame> drain(std::size_t chunk = 64) {
    std::vector<CanFrame> all;
    std::vector<CanFrame> buffer(chunk + 1, marked_frame());
    for (;;) {
      const std::size_t count = port_.receive(std::span(buffer).first(chunk));
      findings_.expect(count <= chunk, "CAN-BOUND", std::to_string(count) + " frames");
      findings_.expect(is_marked(buffer[chunk]), "CAN-BOUND", "wrote beyond the room given");
      if (count == 0 || count > chunk || all.size() > 1'000'000) return all;
      all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
      std::fill(buffer.begin(), buffer.end(), marked_frame());
    }
  }

  std::size_t arrive_on_all(std::size_t count) {
    std::size_t arrived = 0;
    for (std::size_t bus = 0; bus < bench_.bus_count(); ++bus) {
      arrived += bench_.arrive(static_cast<std::uint8_t>(bus), count);
    }
    return arrived;
  }

  void check_empty() {
    std::array<CanFrame, 2> out{marked_frame(), marked_frame()};
    findings_.expect(port_.receive(out) == 0, "CAN-EMPTY", "frames where none arrived");
    findings_.expect(is_marked(out[0]) && is_marked(out[1]), "CAN-EMPTY", "wrote without a frame");
    const std::size_t arrived = bench_.arrive(0, 1);
    findings_.expect(port_.receive({}) == 0, "CAN-EMPTY", "frames into no room");
    const std::size_t got = drain().size();
    findings_.expect(got >= arrived, "CAN-EMPTY", "a receive without room lost a frame");
  }

  void check_form(const CanFrame& frame) {
    const bool wide = (frame.flags & (CanFrame::kExtendedId | CanFrame::kErrorFrame)) != 0;
    const bool flexible = (frame.flags & CanFrame::kFlexibleDataRate) != 0;
    const std::size_t capacity = flexible ? frame.data.size() : 8;
    findings_.expect(frame.id <= (wide ? 0x1FFFFFFFu : 0x7FFu), "CAN-FORM", "id out of range");
    findings_.expect(frame.size <= capacity, "CAN-FORM", "size out of range");
    findings_.expect(frame.bus < hal::kMaxCanBuses, "CAN-FORM", "bus out of range");
    for (std::size_t i = frame.size; i < frame.data.size(); ++i) {
      findings_.expect(frame.data[i] == 0, "CAN-FORM", "bytes beyond the size are not zero");
    }
  }

  void check_order(const std::vector<CanFrame>& frames) {
    std::array<std::int64_t, 256> last{};
    last.fill(-1);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const CanFrame& frame = frames[i];
      const std::int64_t number = bench_.number_of(frame);
      findings_.expect(number < 0 || number > last[frame.bus], "CAN-ORDER",
                       "frames of bus " + std::to_string(frame.bus) + " changed places");
      last[frame.bus] = number;
      if (i == 0) continue;
      const CanFrame& before = frames[i - 1];
      findings_.expect(before.stamp <= frame.stamp, "CAN-ORDER", "a stamp goes back");
      findings_.expect(before.stamp != frame.stamp || before.bus <= frame.bus, "CAN-ORDER",
                       "equal stamps are not ordered by bus");
    }
  }

  void check_delivery(std::size_t chunk) {
    const CanCounters before = port_.counters();
    const std::size_t arrived = arrive_on_all(5);
    const std::vector<CanFrame> got = drain(chunk);
    const CanCounters after = port_.counters();
    const std::uint64_t dropped = after.receive_dropped - before.receive_dropped;
    for (const CanFrame& frame : got) check_form(frame);
    check_order(got);
    findings_.expect(got.size() + dropped >= arrived, "CAN-COMPLETE",
                     std::to_string(arrived) + " arrived, " + std::to_string(got.size()) +
                         " delivered, " + std::to_string(dropped) + " dropped");
    findings_.expect(never_back(before, after), "CAN-COUNT", "a counter went back");
    findings_.expect(after.received - before.received == got.size(), "CAN-COUNT",
                     "received " + std::to_string(after.received - before.received) + ", not " +
                         std::to_string(got.size()));
  }

  void check_overflow() {
    if (bench_.receive_capacity() == 0) return;
    const CanCounters before = port_.counters();
    const std::size_t arrived = bench_.arrive(0, bench_.receive_capacity() + 10);
    const std::vector<CanFrame> got = drain();
    const std::uint64_t dropped = port_.counters().receive_dropped - before.receive_dropped;
    check_order(got);
    findings_.expect(got.size() + dropped == arrived, "CAN-COMPLETE",
                     "overflow: " + std::to_string(arrived) + " arrived, " +
                         std::to_string(got.size()) + " delivered, " + std::to_string(dropped) +
                         " dropped");
  }

  void check_refusals() {
    std::vector<CanFrame> bad(4);
    bad[0].size = 65;
    bad[0].flags = CanFrame::kFlexibleDataRate;
    bad[1].size = 9;  // classic
    bad[2].id = 0x800;
    bad[3].id = 0x20000000;
    bad[3].flags = CanFrame::kExtendedId;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      const CanCounters before = port_.counters();
      const Status status = port_.send(bad[i]);
      findings_.expect(status == Status::kInvalid, "CAN-REFUSE",
                       "frame " + std::to_string(i) + ": " + to_string(status));
      findings_.expect(port_.counters().sent == before.sent, "CAN-REFUSE", "counted as sent");
    }
    for (const std::size_t bus : {bench_.bus_count(), hal::kMaxCanBuses, std::size_t{255}}) {
      CanFrame frame;
      frame.bus = static_cast<std::uint8_t>(bus);
      const CanCounters before = port_.counters();
      const Status status = port_.send(frame);
      const CanCounters after = port_.counters();
      findings_.expect(status == Status::kUnavailable, "CAN-NO-BUS", to_string(status));
      findings_.expect(after.send_dropped == before.send_dropped + 1 && after.sent == before.sent,
                       "CAN-NO-BUS", "not counted as dropped");
    }
  }

  void check_sending() {
    const CanCounters before = port_.counters();
    std::uint64_t accepted = 0;
    for (std::size_t i = 0; i < kSends; ++i) {
      CanFrame frame;
      frame.id = 0x7FF;  // nobody answers to it
      frame.size = 8;
      const Status status = port_.send(frame);
      if (ok(status)) ++accepted;
      const bool documented =
          ok(status) || status == Status::kExhausted || status == Status::kUnavailable;
      findings_.expect(documented, "CAN-SEND", to_string(status));
    }
    const CanCounters after = port_.counters();
    findings_.expect(accepted > 0, "CAN-SEND", "no frame was accepted");
    findings_.expect(after.sent - before.sent == accepted, "CAN-SEND", "sent does not add up");
    findings_.expect(after.send_dropped - before.send_dropped == kSends - accepted, "CAN-SEND",
                     "refusals were not counted");
    findings_.expect(never_back(before, after), "CAN-COUNT", "a counter went back");
  }

  CanBench& bench_;
  hal::CanPort& port_;
  Findings findings_;
};

}  // namespace

Violations can_port_violations(CanBench& bench) { return CanSuite(bench).run(); }

}  // namespace surefoot::conformance
