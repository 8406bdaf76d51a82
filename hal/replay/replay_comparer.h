// Compares what a replayed tick did with what was recorded and names the first difference.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/runtime/tick_record.h"

namespace surefoot::hal {

struct ReplayDifference {
  std::uint64_t tick = 0;
  std::string field;     // "outputs.telemetry.legs[2].foot_O_m[0]"
  std::string recorded;  // value as text; floating point with 17 digits and its bits
  std::string replayed;
};

class ReplayComparer {
 public:
  // true: identical, inputs, outputs and hash. false: difference() holds the first difference;
  // later calls compare on but keep it. Compares bits: -0 differs from 0. Allocates only on a
  // difference.
  bool compare(const autonomy::TickInputs& inputs, const autonomy::TickOutputs& outputs,
               std::uint64_t hash, const runtime::TickRecord& recorded);

  std::uint64_t ticks_compared() const { return ticks_; }
  bool identical() const { return !different_; }
  const ReplayDifference& difference() const { return difference_; }

 private:
  using TickBytes = std::array<std::uint8_t, runtime::kMaxTickBytes>;

  TickBytes recorded_{};  // canonical bytes of the tick being compared
  TickBytes replayed_{};
  std::uint64_t ticks_ = 0;
  bool different_ = false;
  ReplayDifference difference_;
};

}  // namespace surefoot::hal
