#include "core/runtime/statistics.h"

#include <algorithm>
#include <bit>

namespace surefoot::runtime {

std::size_t DurationHistogram::bucket_of(std::uint64_t ns) {
  constexpr std::uint64_t kLargest = (std::uint64_t{1} << kMaxBits) - 1;
  ns = std::min(ns, kLargest);
  if (ns < kSubBuckets) return static_cast<std::size_t>(ns);
  // The leading bit names the octave, the kSubBits below it the bucket within.
  const auto width = static_cast<unsigned>(std::bit_width(ns));
  const unsigned shift = width - 1 - kSubBits;
  const std::uint64_t within = (ns >> shift) - kSubBuckets;
  return static_cast<std::size_t>((shift + 1) * kSubBuckets + within);
}

std::uint64_t DurationHistogram::upper_edge_ns(std::size_t bucket) {
  if (bucket < kSubBuckets) return bucket;
  const auto shift = static_cast<unsigned>(bucket / kSubBuckets - 1);
  const std::uint64_t within = bucket % kSubBuckets;
  return ((kSubBuckets + within + 1) << shift) - 1;
}

void DurationHistogram::add(TimeNs duration) {
  const std::uint64_t ns = duration.ns > 0 ? static_cast<std::uint64_t>(duration.ns) : 0;
  ++buckets_[bucket_of(ns)];
  ++count_;
  maximum_ = std::max(maximum_, duration);
}

TimeNs DurationHistogram::quantile(double q) const {
  if (count_ == 0) return {};
  // The rank-th smallest duration, from 1: at least a share q of all durations is not longer.
  const double wanted = std::clamp(q, 0.0, 1.0) * static_cast<double>(count_);
  auto rank = static_cast<std::uint64_t>(wanted);
  if (static_cast<double>(rank) < wanted || rank == 0) ++rank;
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kBuckets; ++i) {
    seen += buckets_[i];
    if (seen >= rank) {
      return std::min(maximum_, TimeNs{static_cast<std::int64_t>(upper_edge_ns(i))});
    }
  }
  return maximum_;
}

}  // namespace surefoot::runtime
