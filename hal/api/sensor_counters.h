// What every sensor port counts. Nothing is lost silently.
#pragma once

#include <cstdint>

namespace surefoot::hal {

struct SensorCounters {
  std::uint64_t delivered = 0;
  std::uint64_t dropped = 0;  // arrived at the host, lost in a full queue
  std::uint64_t gaps = 0;     // missing sequence numbers: lost before the host
  std::uint64_t corrupt = 0;  // failed a check value or a range test
};

}  // namespace surefoot::hal
