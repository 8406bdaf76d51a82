#include "hal/record/record_writer.h"

#include <fcntl.h>
#include <semaphore.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <thread>
#include <vector>

#include "hal/record/mcap_format.h"
#include "hal/record/mcap_summary.h"

namespace surefoot::hal {
namespace {

constexpr std::size_t kMinChunkBytes = 256;
constexpr std::size_t kMaxChunkBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxChunkBuffers = 1024;
constexpr std::size_t kChannelIds = 256;

struct ChunkBuffer {
  mcap::Bytes records;  // capacity chunk_bytes, never exceeded
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t messages = 0;

  void clear() {
    records.clear();
    start_time = end_time = messages = 0;
  }
};

void wait_for(sem_t& semaphore) {
  while (::sem_wait(&semaphore) != 0 && errno == EINTR) {
  }
}

// errno of the failure, 0 when all was written.
int write_all(int file, mcap::ByteView bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

// Gives a vector its capacity and touches every page of it.
void reserve_touched(mcap::Bytes& bytes, std::size_t size) {
  bytes.assign(size, 0);
  bytes.clear();
}

}  // namespace

// Chunk buffers go round in a ring: the caller's thread fills one, the writer thread stores the
// next. Two semaphores count the free and the full ones, so that neither side ever takes a lock.
struct RecordWriter::Impl {
  Impl() {
    ::sem_init(&free_buffers, 0, 0);
    ::sem_init(&full_buffers, 0, 0);
  }
  ~Impl() {
    ::sem_destroy(&free_buffers);
    ::sem_destroy(&full_buffers);
    ZSTD_freeCCtx(compressor);
  }

  // Set by open().
  std::string path;
  RecordLayout layout;
  RecordWriterOptions options;
  int file = -1;
  std::vector<ChunkBuffer> buffers;
  std::array<bool, kChannelIds> known{};
  ZSTD_CCtx* compressor = nullptr;
  std::thread thread;
  std::string first_error;

  // The caller's thread.
  std::size_t filling = 0;
  bool holds_buffer = false;
  std::array<std::uint32_t, kChannelIds> sequences{};
  RecordCounters counters;

  // The writer thread (and close(), after it has ended).
  mcap::Bytes output;
  std::uint64_t file_size = 0;
  std::uint32_t data_crc = 0;

  // Between the two.
  sem_t free_buffers;
  sem_t full_buffers;
  std::atomic<std::uint64_t> sealed{0};
  std::atomic<int> failure{0};  // errno of the first storage failure
  std::atomic<std::uint64_t> lost_messages{0};
  std::atomic<std::uint64_t> lost_bytes{0};

  Status start();
  void note(const std::string& what);
  void allocate();
  bool acquire();
  void seal();
  void run();
  void store(const ChunkBuffer& chunk);
  bool store_output();
  void finish();
};

void RecordWriter::Impl::note(const std::string& what) {
  if (first_error.empty()) first_error = path + ": " + what;
}

void RecordWriter::Impl::allocate() {
  buffers.resize(options.chunk_buffers);
  for (ChunkBuffer& buffer : buffers) reserve_touched(buffer.records, options.chunk_bytes);
  const std::size_t compressed = ZSTD_compressBound(options.chunk_bytes);
  reserve_touched(output, mcap::kRecordHead + mcap::kChunkHead + compressed +
                              mcap::message_indexes_bound(options.chunk_bytes));
  compressor = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(compressor, ZSTD_c_compressionLevel, options.compression_level);
  // One chunk of full size makes zstd allocate what it will ever need.
  const mcap::Bytes zeros(options.chunk_bytes, 0);
  output.resize(compressed);
  ZSTD_compress2(compressor, output.data(), output.size(), zeros.data(), zeros.size());
  output.clear();
}

Status RecordWriter::Impl::start() {
  file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) {
    note(std::string("cannot be created: ") + std::strerror(errno));
    return Status::kUnavailable;
  }
  allocate();
  mcap::Bytes head;
  mcap::append_head(layout, head);
  const int error = write_all(file, head);
  if (error != 0) {
    note(std::string("cannot be written: ") + std::strerror(error));
    return Status::kUnavailable;
  }
  file_size = head.size();
  data_crc = mcap::crc32(head);
  for (std::size_t i = 0; i < buffers.size(); ++i) ::sem_post(&free_buffers);
  thread = std::thread([this] { run(); });
  return Status::kOk;
}

// Makes sure that a buffer is being filled. false: all wait for the disk and may not be waited for.
bool RecordWriter::Impl::acquire() {
  if (holds_buffer) return true;
  if (options.when_full == WhenFull::kBlock) {
    wait_for(free_buffers);
  } else if (::sem_trywait(&free_buffers) != 0) {
    return false;
  }
  buffers[filling].clear();
  holds_buffer = true;
  return true;
}

void RecordWriter::Impl::seal() {
  if (!holds_buffer) return;
  holds_buffer = false;
  filling = (filling + 1) % buffers.size();
  sealed.fetch_add(1, std::memory_order_release);
  ::sem_post(&full_buffers);
}

void RecordWriter::Impl::run() {
  for (std::uint64_t stored = 0;; ++stored) {
    wait_for(full_buffers);
    // close() posts once more than there are sealed buffers.
    if (stored == sealed.load(std::memory_order_acquire)) return;
    store(buffers[stored % buffers.size()]);
    ::sem_post(&free_buffers);
  }
}

void RecordWriter::Impl::store(const ChunkBuffer& chunk) {
  output.clear();
  mcap::Encoder encoder(output);
  const std::size_t record = encoder.open_record(mcap::Opcode::kChunk);
  encoder.u64(chunk.start_time);
  encoder.u64(chunk.end_time);
  encoder.u64(chunk.records.size());
  encoder.u32(mcap::crc32(chunk.records));
  encoder.string(mcap::kCompression);
  const std::size_t length_at = output.size();
  encoder.u64(0);
  const std::size_t head = output.size();
  output.resize(head + ZSTD_compressBound(chunk.records.size()));
  const std::size_t compressed =
      ZSTD_compress2(compressor, output.data() + head, output.size() - head, chunk.records.data(),
                     chunk.records.size());
  if (ZSTD_isError(compressed) != 0) {
    failure.store(EIO);
  } else {
    output.resize(head + compressed);
    for (std::size_t i = 0; i < 8; ++i) {
      output[length_at + i] =
          static_cast<std::uint8_t>(static_cast<std::uint64_t>(compressed) >> (8 * i));
    }
    encoder.close_record(record);
    mcap::append_message_indexes(chunk.records, output);
  }
  if (store_output()) return;
  lost_messages.fetch_add(chunk.messages);
  lost_bytes.fetch_add(chunk.records.size());
}

// false: nothing of the output is in the file, which ends with its last whole record.
bool RecordWriter::Impl::store_output() {
  if (failure.load() != 0) return false;
  const int error = write_all(file, output);
  if (error != 0) {
    failure.store(error);
    const int cut = ::ftruncate(file, static_cast<off_t>(file_size));
    static_cast<void>(cut);  // a reader copes with half a chunk as well
    return false;
  }
  file_size += output.size();
  data_crc = mcap::crc32(output, data_crc);
  return true;
}

// After the writer thread has ended.
void RecordWriter::Impl::finish() {
  if (failure.load() == 0) {
    mcap::Bytes tail;
    if (!mcap::append_tail(file, layout, file_size, data_crc, tail)) {
      note("cannot be read back for its index");
    }
    output = tail;
    store_output();
  }
  if (::close(file) != 0 && failure.load() == 0) failure.store(errno);
  file = -1;
  if (failure.load() != 0) {
    note("could not be stored beyond byte " + std::to_string(file_size) + ": " +
         std::strerror(failure.load()) + "; " + std::to_string(lost_messages.load()) +
         " messages lost");
  }
}

RecordWriter::RecordWriter() : impl_(std::make_unique<Impl>()) {}

RecordWriter::~RecordWriter() {
  const Status status = close();
  static_cast<void>(status);  // whoever wants to know calls close()
}

Status RecordWriter::open(const std::string& path, const RecordLayout& layout,
                          const RecordWriterOptions& options) {
  const Status closed = close();
  static_cast<void>(closed);
  impl_ = std::make_unique<Impl>();
  impl_->path = path;
  impl_->layout = layout;
  impl_->options = options;
  if (options.chunk_bytes < kMinChunkBytes || options.chunk_bytes > kMaxChunkBytes ||
      options.chunk_buffers < 2 || options.chunk_buffers > kMaxChunkBuffers ||
      options.max_chunk_span.ns <= 0) {
    impl_->note("record options out of range");
    return Status::kInvalid;
  }
  for (const RecordChannelInfo& info : layout) {
    bool& known = impl_->known[static_cast<std::size_t>(info.channel)];
    if (known || static_cast<std::size_t>(info.channel) == 0) {
      impl_->note("two record channels have the same number, or number 0");
      return Status::kInvalid;
    }
    known = true;
  }
  const Status status = impl_->start();
  if (!ok(status) && impl_->file >= 0) {
    ::close(impl_->file);
    impl_->file = -1;
  }
  return status;
}

Status RecordWriter::close() {
  if (impl_->file >= 0) {
    impl_->seal();
    ::sem_post(&impl_->full_buffers);
    impl_->thread.join();
    impl_->finish();
  }
  return impl_->first_error.empty() ? Status::kOk : Status::kUnavailable;
}

Status RecordWriter::status() const {
  return impl_->failure.load() == 0 && impl_->first_error.empty() ? Status::kOk
                                                                  : Status::kUnavailable;
}

std::string RecordWriter::error() const { return impl_->first_error; }

Status RecordWriter::do_write(RecordChannel channel, TimeNs stamp,
                              std::span<const std::uint8_t> bytes) {
  Impl& impl = *impl_;
  const auto id = static_cast<std::size_t>(channel);
  const std::size_t size = mcap::kRecordHead + mcap::kMessageHead + bytes.size();
  // A refused message takes its number along, so that the gap is visible in the file.
  const std::uint32_t sequence = impl.sequences[id]++;
  const auto refuse = [&](Status why) {
    ++impl.counters.dropped;
    return why;
  };
  if (impl.file < 0 || impl.failure.load() != 0) return refuse(Status::kUnavailable);
  if (!impl.known[id] || size > impl.options.chunk_bytes) return refuse(Status::kInvalid);
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(stamp.ns, 0));
  if (impl.holds_buffer) {
    const ChunkBuffer& chunk = impl.buffers[impl.filling];
    const auto span = static_cast<std::uint64_t>(impl.options.max_chunk_span.ns);
    if (chunk.records.size() + size > impl.options.chunk_bytes || time >= chunk.start_time + span) {
      impl.seal();
    }
  }
  if (!impl.acquire()) return refuse(Status::kExhausted);

  ChunkBuffer& chunk = impl.buffers[impl.filling];
  mcap::Encoder encoder(chunk.records);
  const std::size_t record = encoder.open_record(mcap::Opcode::kMessage);
  encoder.u16(static_cast<std::uint16_t>(channel));
  encoder.u32(sequence);
  encoder.u64(time);
  encoder.u64(time);
  encoder.raw(bytes);
  encoder.close_record(record);
  chunk.start_time = chunk.messages == 0 ? time : std::min(chunk.start_time, time);
  chunk.end_time = std::max(chunk.end_time, time);
  ++chunk.messages;
  ++impl.counters.messages;
  impl.counters.bytes += bytes.size();
  return Status::kOk;
}

RecordCounters RecordWriter::do_counters() const {
  RecordCounters counters = impl_->counters;
  const std::uint64_t lost = impl_->lost_messages.load();
  counters.messages -= lost;
  counters.dropped += lost;
  return counters;
}

}  // namespace surefoot::hal
