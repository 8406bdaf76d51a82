#include "hal/candump/candump_reader.h"

#include <utility>

namespace surefoot::hal {
namespace {

std::uint8_t bus_of(const BusNames& names, std::string_view interface_name) {
  std::uint8_t bus = 0;
  while (bus < names.size() && names[bus] != interface_name) ++bus;
  return bus;
}

}  // namespace

CandumpReader::CandumpReader(std::istream& in, BusNames names) : in_(in), names_(std::move(names)) {
  issues_.reserve(kMaxIssues);
}

bool CandumpReader::read_line() {
  using Traits = std::istream::traits_type;
  line_size_ = 0;
  line_too_long_ = false;
  std::streambuf* const buffer = in_.rdbuf();
  Traits::int_type c = buffer->sbumpc();
  if (Traits::eq_int_type(c, Traits::eof())) return false;
  while (!Traits::eq_int_type(c, Traits::eof()) && Traits::to_char_type(c) != '\n') {
    if (line_size_ < line_.size()) {
      line_[line_size_++] = Traits::to_char_type(c);
    } else {
      line_too_long_ = true;
    }
    c = buffer->sbumpc();
  }
  ++counters_.lines;
  return true;
}

void CandumpReader::note_issue(CandumpFault fault) {
  ++counters_.malformed;
  if (issues_.size() < kMaxIssues) issues_.push_back({counters_.lines, fault});
}

void CandumpReader::accept(const CandumpEntry& entry, std::uint8_t bus, CanFrame& out) {
  out = entry.frame;
  out.bus = bus;
  if (counters_.frames > 0 && out.stamp < last_stamp_) ++counters_.backward_steps;
  last_stamp_ = out.stamp;
  ++counters_.frames;
}

Status CandumpReader::next(CanFrame& out) {
  while (read_line()) {
    const std::string_view line(line_.data(), line_size_);
    if (line.find_first_not_of(" \r\t") == std::string_view::npos && !line_too_long_) {
      ++counters_.blank;
      continue;
    }
    CandumpEntry entry;
    const CandumpFault fault =
        line_too_long_ ? CandumpFault::kTooLong : parse_candump_line(line, entry);
    const std::uint8_t bus = bus_of(names_, entry.interface_name);
    if (fault != CandumpFault::kNone) {
      note_issue(fault);
    } else if (bus == names_.size()) {
      ++counters_.other_interfaces;
    } else if (entry.remote) {
      ++counters_.remote;
    } else {
      accept(entry, bus, out);
      return Status::kOk;
    }
  }
  return Status::kEndOfData;
}

}  // namespace surefoot::hal
