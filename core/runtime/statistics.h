// Execution-time statistics in fixed memory. Never part of the hashed state: they depend on the
// machine, the decisions of the autonomy do not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.h"

namespace surefoot::runtime {

// Log-linear histogram of durations: exact below 32 ns, then 32 equal buckets per octave, so that a
// quantile is at most 3.2 % above the true one. Durations from 68 s on share the last bucket.
// Memory: 4 KiB. Cost: add() O(1), quantile() O(buckets).
class DurationHistogram {
 public:
  void add(TimeNs duration);
  std::uint64_t count() const { return count_; }
  TimeNs maximum() const { return maximum_; }
  // Upper edge of the bucket that holds the q-quantile, never above maximum(). Zero when empty.
  TimeNs quantile(double q) const;

 private:
  static constexpr unsigned kSubBits = 5;
  static constexpr std::uint64_t kSubBuckets = 1u << kSubBits;
  static constexpr unsigned kMaxBits = 36;  // 2^36 ns = 68.7 s
  static constexpr std::size_t kBuckets = (kMaxBits - kSubBits + 1) * kSubBuckets;

  static std::size_t bucket_of(std::uint64_t ns);
  static std::uint64_t upper_edge_ns(std::size_t bucket);

  std::array<std::uint32_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  TimeNs maximum_;
};

// One row of a run's timing table.
struct TaskReport {
  const char* name = "";
  std::uint32_t period_us = 0;
  std::uint32_t budget_us = 0;
  std::uint64_t count = 0;
  double p50_us = 0;
  double p99_us = 0;
  double max_us = 0;
  std::uint64_t overruns = 0;        // executions longer than the budget
  std::uint64_t skipped = 0;         // releases skipped: the slow task was still pending
  std::uint64_t late_publishes = 0;  // results published after their due tick
};

}  // namespace surefoot::runtime
