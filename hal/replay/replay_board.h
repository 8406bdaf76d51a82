// A board fed from a record: the executive cannot tell it from a robot. The clock grants exactly
// the recorded ticks, with their late flags, and then answers kEndOfData; the ports deliver exactly
// what was latched at each tick; what is sent goes nowhere (ReplayComparer compares it).
//
// Use: open(); build the autonomy from configuration(); make a RecordedRunner on overruns(); give
// board() to an Executive; call run_tick() until kEndOfData, comparing after each tick; then look
// at end(), damage() and message().
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/status.h"
#include "core/runtime/tick_record.h"
#include "hal/api/board.h"
#include "hal/record/record_reader.h"

namespace surefoot::hal {

enum class ReplayEnd : std::uint8_t {
  kNotYet,
  kComplete,  // the record ends as its writer ended it
  kDamaged,   // a check failed or the file is cut; damage() says where
  kGap,       // the file is intact, but the recorder had dropped a message (disk or buffers full)
};

class ReplayBoard {
 public:
  ReplayBoard();
  ~ReplayBoard();
  ReplayBoard(const ReplayBoard&) = delete;
  ReplayBoard& operator=(const ReplayBoard&) = delete;

  // Reads up to the first tick. kUnavailable: cannot be read. kCorrupt: not a record, or damaged
  // before the configuration; message() says where. A record without a tick opens well and ends at
  // once.
  Status open(const std::string& path);

  // The resolved configuration of the recorded run, as it was written on
  // RecordChannel::kConfiguration.
  const std::string& configuration() const;
  // All ports a tick's inputs can hold. The clock begins one `period` (of a tick, from the
  // configuration) before the first recorded tick. record and stopwatch are null: the caller may
  // add its own.
  Board board(TimeNs period);
  // TickInputs::slow_task_overruns of the tick being replayed, for runtime::RecordedRunner.
  const std::uint32_t& overruns() const;
  // The tick being replayed: what ReplayComparer compares with. Valid after run_tick() returned
  // kOk.
  const runtime::TickRecord& recorded() const;

  std::uint64_t ticks() const;  // granted so far
  ReplayEnd end() const;
  const RecordDamage& damage() const;
  // One line for a person: how the record ended, with byte offset and chunk where it is damaged.
  std::string message() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::hal
