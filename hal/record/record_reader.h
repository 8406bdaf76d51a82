// Reads the MCAP files of RecordWriter, also cut or corrupted ones. Every check value is verified:
// a chunk is delivered only when its CRC-32, its framing and its time range agree. Damage is
// reported where it is met; reading may go on after it at the next intact chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/record_sink.h"

namespace surefoot::hal {

struct RecordMessage {
  RecordChannel channel = RecordChannel::kConfiguration;
  TimeNs stamp;
  std::uint32_t sequence = 0;           // counts the messages of the channel from 0
  std::span<const std::uint8_t> bytes;  // valid until the next call
  std::uint64_t chunk = 0;              // index of its chunk, from 0
  std::uint64_t chunk_offset = 0;       // byte in the file where its chunk begins
};

struct RecordDamage {
  std::uint64_t offset = 0;  // byte in the file where the damaged record begins
  std::uint64_t chunk = 0;   // chunks met before it: the index of the damaged chunk, if it is one
  std::string reason;
};

class RecordReader {
 public:
  RecordReader();
  ~RecordReader();
  RecordReader(const RecordReader&) = delete;
  RecordReader& operator=(const RecordReader&) = delete;

  // kUnavailable: cannot be opened or read. kCorrupt: not an MCAP file. damage().reason says why.
  Status open(const std::string& path);

  // kOk: `out` holds the next message. kCorrupt: damage() describes what was met; the next call
  // goes on after it, skipping to the next intact chunk. kEndOfData: nothing more.
  Status next(RecordMessage& out);

  const RecordDamage& damage() const;
  std::uint64_t damages() const;   // met so far
  std::uint64_t messages() const;  // delivered so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::hal
