// Where a run's record goes. The executive writes; a backend stores (hal/record) or discards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/base/time.h"

namespace surefoot::hal {

// The channels of a record. Numbers are stored: never reuse one.
enum class RecordChannel : std::uint8_t {
  kConfiguration = 1,  // once, first: the resolved configuration as text
  kTick = 2,           // every tick: inputs, outputs, hash
  kDepth = 3,          // depth frames, before the tick that latched them
  kLidar = 4,
  kStereo = 5,
};

struct RecordCounters {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::uint64_t dropped = 0;  // refused: buffers full or storage failed
};

class RecordSink {
 public:
  // Stores one message; the bytes are copied before the call returns. Allocates nothing.
  // kExhausted: buffers full, message dropped and counted. kUnavailable: storage failed (disk
  // full), dropped and counted.
  Status write(RecordChannel channel, TimeNs stamp, std::span<const std::uint8_t> bytes) {
    return do_write(channel, stamp, bytes);
  }
  RecordCounters counters() const { return do_counters(); }

 protected:
  ~RecordSink() = default;

 private:
  virtual Status do_write(RecordChannel channel, TimeNs stamp,
                          std::span<const std::uint8_t> bytes) = 0;
  virtual RecordCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
