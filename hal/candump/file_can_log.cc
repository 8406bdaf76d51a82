#include "hal/candump/file_can_log.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace surefoot::hal {
namespace {

constexpr std::size_t kBufferBytes = 256 * 1024;

}  // namespace

FileCanLog::FileCanLog(const std::string& path, BusNames names)
    : names_(std::move(names)), buffer_(kBufferBytes), file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) throw std::runtime_error(path + ": " + std::strerror(errno));
  // Fails only for a wrong mode.
  static_cast<void>(std::setvbuf(file_, buffer_.data(), _IOFBF, buffer_.size()));
}

FileCanLog::~FileCanLog() {
  // Whoever wants to know whether all was stored calls flush() before.
  static_cast<void>(std::fclose(file_));
}

Status FileCanLog::write(const CanFrame& frame, TimeNs stamp) {
  std::array<char, kMaxCandumpLine> line;
  CandumpEntry entry;
  entry.frame = frame;
  entry.frame.stamp = stamp;
  if (frame.bus < names_.size()) entry.interface_name = names_[frame.bus];
  std::size_t size = format_candump_line(entry, line);
  if (size == 0) {
    ++counters_.dropped;
    return Status::kInvalid;
  }
  line[size++] = '\n';
  if (failed_ || std::fwrite(line.data(), 1, size, file_) != size) {
    failed_ = true;
    ++counters_.dropped;
    return Status::kUnavailable;
  }
  ++counters_.frames;
  return Status::kOk;
}

Status FileCanLog::flush() {
  if (std::fflush(file_) != 0) failed_ = true;
  return failed_ ? Status::kUnavailable : Status::kOk;
}

std::size_t LoggedCanPort::do_receive(std::span<CanFrame> out) {
  const std::size_t count = port_.receive(out);
  // A log that fails counts its losses and must not stop the robot.
  for (const CanFrame& frame : out.first(count)) static_cast<void>(log_.write(frame, frame.stamp));
  return count;
}

Status LoggedCanPort::do_send(const CanFrame& frame) {
  const Status status = port_.send(frame);
  if (ok(status)) static_cast<void>(log_.write(frame, clock_.now()));
  return status;
}

}  // namespace surefoot::hal
