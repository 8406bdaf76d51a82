// The rules of hal/api/record_sink.h, once for all backends.
//
//   SINK-COPY    the bytes are copied before write() returns
//   SINK-KEEP    what was accepted is stored, per channel in the order of writing, with its stamp
//   SINK-COUNT   messages and bytes count what was accepted, dropped what was refused
//   SINK-STATUS  kOk, kExhausted or kUnavailable for a message of a channel; nothing else
//   SINK-HEAP    write() allocates nothing (operator new of the calling thread)
#pragma once

#include <cstdint>
#include <vector>

#include "hal/api/record_sink.h"
#include "tests/conformance/violations.h"

namespace surefoot::conformance {

struct StoredMessage {
  hal::RecordChannel channel = hal::RecordChannel::kTick;
  TimeNs stamp;
  std::vector<std::uint8_t> bytes;
  bool operator==(const StoredMessage&) const = default;
};

class RecordSinkBench {
 public:
  virtual ~RecordSinkBench() = default;
  virtual hal::RecordSink& sink() = 0;
  // Ends the record and reads it back. Called once, at the end.
  virtual std::vector<StoredMessage> stored() = 0;
};

Violations record_sink_violations(RecordSinkBench& bench);

// Calls of operator new by this thread so far (this program replaces operator new).
std::uint64_t heap_calls_of_this_thread();

}  // namespace surefoot::conformance
