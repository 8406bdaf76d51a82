// Writes CAN traffic to a `candump -L` file while a run goes on (`surefoot run --can-log`).
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "hal/api/can_port.h"
#include "hal/api/clock.h"
#include "hal/candump/candump_reader.h"

namespace surefoot::hal {

struct CanLogCounters {
  std::uint64_t frames = 0;
  std::uint64_t dropped = 0;  // not a frame, or the storage failed
};

// Opens at construction, closes at destruction. write() neither allocates nor throws; it may block
// while the system writes a full buffer (256 KiB, some 5000 frames) to the disk.
class FileCanLog {
 public:
  // Throws std::runtime_error with path and reason when the file cannot be made.
  explicit FileCanLog(const std::string& path, BusNames names = default_bus_names());
  ~FileCanLog();
  FileCanLog(const FileCanLog&) = delete;
  FileCanLog& operator=(const FileCanLog&) = delete;

  // `stamp` is the time of the line: frames that are sent carry none.
  // kInvalid: not a frame or no such bus. kUnavailable: the storage failed, as every write after
  // it.
  Status write(const CanFrame& frame, TimeNs stamp);
  // Hands everything to the system. kUnavailable: the storage failed.
  Status flush();
  CanLogCounters counters() const { return counters_; }

 private:
  BusNames names_;
  std::vector<char> buffer_;
  std::FILE* file_ = nullptr;
  bool failed_ = false;
  CanLogCounters counters_;
};

// A CAN port that logs what passes through it: received frames with their own stamps, accepted sent
// frames with the clock's time. Port, clock and log must outlive it.
class LoggedCanPort final : public CanPort {
 public:
  LoggedCanPort(CanPort& port, const Clock& clock, FileCanLog& log)
      : port_(port), clock_(clock), log_(log) {}

 private:
  std::size_t do_receive(std::span<CanFrame> out) override;
  Status do_send(const CanFrame& frame) override;
  CanCounters do_counters() const override { return port_.counters(); }

  CanPort& port_;
  const Clock& clock_;
  FileCanLog& log_;
};

}  // namespace surefoot::hal
