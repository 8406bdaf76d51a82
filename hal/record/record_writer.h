// RecordSink that stores an MCAP file (https://mcap.dev/spec): messages in chunks compressed with
// zstd, each with a CRC-32 and a message index, a summary at the end. A file without its end (power
// cut, full disk) is readable up to its last complete chunk.
//
// The thread that calls write() copies the message into a chunk buffer from a fixed pool; a writer
// thread compresses full chunks and writes them to the file. Nothing is allocated between open()
// and close(). A chunk is also closed when it spans more than max_chunk_span of message time, which
// bounds what a power cut can take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/record_sink.h"
#include "hal/record/record_layout.h"

namespace surefoot::hal {

// What write() does when every chunk buffer waits for the disk.
enum class WhenFull : std::uint8_t {
  kBlock,  // wait: simulation, where no message may be missing and time can stand still
  kDrop,   // refuse the message and count it: robot
};

struct RecordWriterOptions {
  std::size_t chunk_bytes = std::size_t{2}
                            << 20;  // capacity of one chunk buffer before compression
  std::size_t chunk_buffers = 6;    // at least 2
  TimeNs max_chunk_span = milliseconds(1000);
  int compression_level = 1;  // zstd
  WhenFull when_full = WhenFull::kBlock;
};

class RecordWriter final : public RecordSink {
 public:
  RecordWriter();
  ~RecordWriter();  // closes
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;

  // Creates (or truncates) the file, writes its head, allocates and touches every buffer and starts
  // the writer thread. kUnavailable: the file cannot be created or written. kInvalid: options out
  // of range or a layout with two equal channels; error() says what.
  Status open(const std::string& path, const RecordLayout& layout,
              const RecordWriterOptions& options = {});
  // Writes what is waiting, then index and summary, and closes the file. kUnavailable: something
  // could not be stored, error() says what. Calling again is harmless.
  Status close();

  // kOk as long as every message accepted so far is or will be stored; kUnavailable after the first
  // storage failure.
  Status status() const;
  // Empty, or what went wrong first, for a person. Valid after close() or a failed open().
  std::string error() const;

 private:
  // write(): kInvalid: channel not in the layout or message larger than a chunk; counted as
  // dropped.
  Status do_write(RecordChannel channel, TimeNs stamp,
                  std::span<const std::uint8_t> bytes) override;
  RecordCounters do_counters() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::hal
