#include "tests/conformance/clock_rules.h"

#include <string>

namespace surefoot::conformance {
namespace {

class ClockSuite {
 public:
  explicit ClockSuite(const ClockBench& bench) : bench_(bench), clock_(*bench.clock) {}

  Violations run() {
    last_ = clock_.now();
    for (int i = 0; i < 100; ++i) look();
    const TimeNs start = clock_.now();
    for (int tick = 1; tick <= bench_.ticks && !ended_; ++tick) {
      wait(start + bench_.period * tick);
    }
    if (bench_.asks_for_late && !ended_) wait_for_the_past();
    if (ended_) wait_after_the_end();
    return findings_.take();
  }

 private:
  TimeNs look() {
    const TimeNs now = clock_.now();
    findings_.expect(last_ <= now, "CLOCK-MONOTONIC", "now() went back");
    last_ = now;
    return now;
  }

  void wait(TimeNs deadline) {
    const bool passed = deadline < look();
    const Status status = clock_.wait_until(deadline);
    const TimeNs after = look();
    if (status == Status::kEndOfData) {
      ended_ = true;
      return;
    }
    findings_.expect(ok(status) || status == Status::kTimeout, "CLOCK-STATUS", to_string(status));
    if (status == Status::kTimeout) return;
    findings_.expect(deadline <= after, "CLOCK-WAIT", "returned before the deadline");
    findings_.expect(after <= deadline + bench_.allowed_overshoot || passed, "CLOCK-WAIT",
                     std::to_string((after - deadline).ns) + " ns beyond the deadline");
    findings_.expect(!passed || !bench_.asks_for_late, "CLOCK-LATE", "a late tick was kOk");
  }

  void wait_for_the_past() {
    const TimeNs before = look();
    const Status status = clock_.wait_until(before - milliseconds(1));
    const TimeNs after = look();
    findings_.expect(status == Status::kTimeout, "CLOCK-LATE", to_string(status));
    findings_.expect(after <= before + bench_.allowed_overshoot, "CLOCK-LATE",
                     "a deadline in the past was waited for");
  }

  void wait_after_the_end() {
    const TimeNs before = look();
    for (int i = 0; i < 3; ++i) {
      const Status status = clock_.wait_until(before + bench_.period * (i + 1));
      findings_.expect(status == Status::kEndOfData, "CLOCK-END", to_string(status));
    }
    findings_.expect(look() == before, "CLOCK-END", "time went on after the end");
  }

  const ClockBench& bench_;
  hal::Clock& clock_;
  Findings findings_;
  TimeNs last_;
  bool ended_ = false;
};

}  // namespace

Violations clock_violations(const ClockBench& bench) { return ClockSuite(bench).run(); }

}  // namespace surefoot::conformance
