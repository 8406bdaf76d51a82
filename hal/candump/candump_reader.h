// Reads `candump -L` logs as CAN frames of a robot's buses.
#pragma once

#include <array>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "hal/api/can_port.h"
#include "hal/candump/candump_text.h"

namespace surefoot::hal {

// Interface of each bus, index = bus.
using BusNames = std::array<std::string, kMaxCanBuses>;
inline BusNames default_bus_names() { return {"can0", "can1", "can2", "can3"}; }

struct CandumpCounters {
  std::uint64_t lines = 0;
  std::uint64_t frames = 0;            // delivered
  std::uint64_t blank = 0;             // empty lines
  std::uint64_t malformed = 0;         // skipped, see issues()
  std::uint64_t remote = 0;            // remote frames, skipped: CanFrame has no place for them
  std::uint64_t other_interfaces = 0;  // frames of interfaces that are no bus of ours, skipped
  std::uint64_t backward_steps = 0;    // frames stamped before the one above them, delivered
};

struct CandumpIssue {
  std::uint64_t line = 0;  // counted from 1
  CandumpFault fault = CandumpFault::kNone;
};

class CandumpReader {
 public:
  static constexpr std::size_t kMaxIssues = 100;  // kept; counters().malformed counts all

  // The stream must live as long as the reader.
  explicit CandumpReader(std::istream& in, BusNames names = default_bus_names());

  // The next frame of our buses, its stamp as in the log (usually time since 1970).
  // kEndOfData: none left. Never throws, reads at most one frame ahead.
  Status next(CanFrame& out);

  const CandumpCounters& counters() const { return counters_; }
  const std::vector<CandumpIssue>& issues() const { return issues_; }

 private:
  bool read_line();  // into line_; false at the end of the stream
  void accept(const CandumpEntry& entry, std::uint8_t bus, CanFrame& out);
  void note_issue(CandumpFault fault);

  std::istream& in_;
  BusNames names_;
  std::array<char, kMaxCandumpLine> line_{};
  std::size_t line_size_ = 0;
  bool line_too_long_ = false;
  CandumpCounters counters_;
  std::vector<CandumpIssue> issues_;
  TimeNs last_stamp_;
};

}  // namespace surefoot::hal
