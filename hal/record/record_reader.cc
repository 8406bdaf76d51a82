#include "hal/record/record_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "hal/record/mcap_format.h"

namespace surefoot::hal {
namespace {

using mcap::ByteView;
using mcap::Opcode;

// A chunk that claims more than this when unpacked is damaged: the writer's limit is a quarter of
// it.
constexpr std::uint64_t kMaxUncompressed = std::uint64_t{256} << 20;
constexpr std::size_t kScanBlock = std::size_t{1} << 20;

constexpr const char* kCutInRecord = "the file is cut inside a record";
constexpr const char* kCutBetween = "the file ends without its end mark";

// The text that stands at a fixed place in every chunk record: length and name of the compression.
constexpr std::array<std::uint8_t, 8> kChunkMark = {4, 0, 0, 0, 'z', 's', 't', 'd'};
constexpr std::size_t kChunkMarkAt = mcap::kRecordHead + 8 + 8 + 8 + 4;

}  // namespace

struct RecordReader::Impl {
  Impl() : decompressor(ZSTD_createDCtx()) {}
  ~Impl() {
    ZSTD_freeDCtx(decompressor);
    if (file >= 0) ::close(file);
  }

  int file = -1;
  std::uint64_t file_size = 0;
  std::uint64_t offset = 0;  // of the next record
  std::uint64_t chunks = 0;  // met so far
  std::uint64_t damages = 0;
  std::uint64_t messages = 0;
  bool done = false;
  bool skip_indexes = false;  // the chunk before was damaged, its indexes cannot be checked
  std::uint32_t crc = 0;      // of everything before `offset`, while nothing was damaged
  RecordDamage damage;

  ZSTD_DCtx* decompressor;
  mcap::Bytes content;             // of the present record
  mcap::Bytes records;             // of the present chunk, verified
  std::uint64_t chunk_offset = 0;  // of the present chunk
  std::size_t position = 0;        // in records
  mcap::Bytes expected_indexes;    // that must follow the present chunk
  bool in_chunk = false;

  bool read_at(std::uint64_t from, std::uint64_t size, mcap::Bytes& out) const;
  Status report(std::uint64_t at, const std::string& reason);
  Status report_and_resynchronise(std::uint64_t at, const std::string& reason);
  bool find_chunk(std::uint64_t from, std::uint64_t& found) const;
  bool plausible_chunk(std::uint64_t at) const;
  Status read_record();
  Status take_record(Opcode opcode, std::uint64_t at);
  Status take_chunk(std::uint64_t at);
  const char* unpack_chunk();
  const char* check_records(const mcap::ChunkHead& head) const;
  Status check_indexes();
  Status finish(std::uint64_t at);
  const char* check_tail(ByteView tail, std::uint64_t at) const;
};

bool RecordReader::Impl::read_at(std::uint64_t from, std::uint64_t size, mcap::Bytes& out) const {
  if (from > file_size || size > file_size - from) return false;
  out.resize(static_cast<std::size_t>(size));
  std::size_t have = 0;
  while (have < out.size()) {
    const ssize_t got =
        ::pread(file, out.data() + have, out.size() - have, static_cast<off_t>(from + have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    have += static_cast<std::size_t>(got);
  }
  return true;
}

Status RecordReader::Impl::report(std::uint64_t at, const std::string& reason) {
  ++damages;
  damage = {at, chunks, reason};
  return Status::kCorrupt;
}

// The record at `at` cannot be trusted, not even its length: go on at the next chunk, if there is
// one.
Status RecordReader::Impl::report_and_resynchronise(std::uint64_t at, const std::string& reason) {
  std::uint64_t found = 0;
  if (find_chunk(at + 1, found)) {
    offset = found;
  } else {
    done = true;
  }
  skip_indexes = true;
  return report(at, reason);
}

bool RecordReader::Impl::plausible_chunk(std::uint64_t at) const {
  mcap::Bytes head;
  if (!read_at(at, mcap::kRecordHead + mcap::kChunkHead, head)) return false;
  mcap::Decoder decoder(head);
  const auto opcode = static_cast<Opcode>(decoder.u8());
  const std::uint64_t length = decoder.u64();
  mcap::ChunkHead chunk;
  return opcode == Opcode::kChunk && length <= file_size - at - mcap::kRecordHead &&
         mcap::read_chunk_head(ByteView(head).subspan(mcap::kRecordHead), length, chunk);
}

bool RecordReader::Impl::find_chunk(std::uint64_t from, std::uint64_t& found) const {
  mcap::Bytes block;
  while (from < file_size) {
    const std::uint64_t size = std::min<std::uint64_t>(kScanBlock, file_size - from);
    if (!read_at(from, size, block)) return false;
    for (auto at = block.begin();;) {
      at = std::search(at, block.end(), kChunkMark.begin(), kChunkMark.end());
      if (at == block.end()) break;
      const std::uint64_t mark = from + static_cast<std::uint64_t>(at - block.begin());
      if (mark >= kChunkMarkAt + from && plausible_chunk(mark - kChunkMarkAt)) {
        found = mark - kChunkMarkAt;
        return true;
      }
      ++at;
    }
    // The next block overlaps by one chunk head, so that a mark is seen whole and far enough in.
    constexpr std::uint64_t kOverlap = mcap::kRecordHead + mcap::kChunkHead;
    if (size <= kOverlap || from + size >= file_size) return false;
    from += size - kOverlap;
  }
  return false;
}

Status RecordReader::Impl::read_record() {
  if (offset == file_size) {
    done = true;
    return report(offset, kCutBetween);
  }
  const std::uint64_t at = offset;
  mcap::Bytes head;
  if (!read_at(at, mcap::kRecordHead, head)) return report_and_resynchronise(at, kCutInRecord);
  mcap::Decoder decoder(head);
  const auto opcode = static_cast<Opcode>(decoder.u8());
  const std::uint64_t length = decoder.u64();
  if (length > file_size - at - mcap::kRecordHead) {
    return report_and_resynchronise(at, kCutInRecord);
  }
  if (!read_at(at + mcap::kRecordHead, length, content)) {
    done = true;
    return report(at, "the file cannot be read");
  }
  if (opcode == Opcode::kDataEnd && length == mcap::kDataEndContent) return finish(at);
  crc = mcap::crc32(content, mcap::crc32(head, crc));
  offset = at + mcap::kRecordHead + length;
  return take_record(opcode, at);
}

// Header, Schema and Channel are taken apart to see that they are whole; their bytes are covered by
// the check value of the data section.
Status RecordReader::Impl::take_record(Opcode opcode, std::uint64_t at) {
  mcap::Decoder decoder(content);
  switch (opcode) {
    case Opcode::kChunk: return take_chunk(at);
    case Opcode::kMessageIndex:
      if (skip_indexes) return Status::kOk;
      return report_and_resynchronise(at, "a message index without its chunk");
    case Opcode::kHeader:
      if (at != mcap::kMagic.size()) break;
      static_cast<void>(decoder.string());
      static_cast<void>(decoder.string());
      break;
    case Opcode::kSchema:
      static_cast<void>(decoder.u16());
      for (int i = 0; i < 3; ++i) static_cast<void>(decoder.string());
      break;
    case Opcode::kChannel:
      static_cast<void>(decoder.u32());
      for (int i = 0; i < 3; ++i) static_cast<void>(decoder.string());
      break;
    default: return report_and_resynchronise(at, "unknown record type");
  }
  if (!decoder.at_end()) return report_and_resynchronise(at, "a record's lengths do not add up");
  return Status::kOk;
}

Status RecordReader::Impl::take_chunk(std::uint64_t at) {
  mcap::ChunkHead head;
  const ByteView view(content);
  const bool framed = view.size() >= mcap::kChunkHead &&
                      mcap::read_chunk_head(view.first(mcap::kChunkHead), view.size(), head);
  if (!framed) {
    const Status status = report_and_resynchronise(at, "a chunk's lengths do not add up");
    ++chunks;
    return status;
  }
  const char* wrong = unpack_chunk();
  if (wrong != nullptr) {
    skip_indexes = true;
    const Status status = report(at, wrong);
    ++chunks;
    return status;
  }
  ++chunks;
  skip_indexes = false;
  in_chunk = true;
  chunk_offset = at;
  position = 0;
  expected_indexes.clear();
  mcap::append_message_indexes(records, expected_indexes);
  return Status::kOk;
}

// nullptr, or what is wrong.
const char* RecordReader::Impl::unpack_chunk() {
  const ByteView view(content);
  mcap::ChunkHead head;
  if (!mcap::read_chunk_head(view.first(mcap::kChunkHead), view.size(), head)) return "chunk head";
  if (head.uncompressed_size > kMaxUncompressed) return "a chunk's size is not possible";
  records.resize(static_cast<std::size_t>(head.uncompressed_size));
  const ByteView packed = view.subspan(mcap::kChunkHead);
  const std::size_t size = ZSTD_decompressDCtx(decompressor, records.data(), records.size(),
                                               packed.data(), packed.size());
  if (ZSTD_isError(size) != 0 || size != records.size()) return "a chunk cannot be decompressed";
  if (mcap::crc32(records) != head.uncompressed_crc) return "a chunk's check value does not match";
  return check_records(head);
}

const char* RecordReader::Impl::check_records(const mcap::ChunkHead& head) const {
  std::uint64_t first = UINT64_MAX;
  std::uint64_t last = 0;
  std::size_t at = 0;
  mcap::Message message;
  while (mcap::read_message(records, at, message)) {
    first = std::min(first, message.log_time);
    last = std::max(last, message.log_time);
  }
  if (at != records.size()) return "a chunk holds more than whole messages";
  const bool times_match = records.empty() || (first == head.start_time && last == head.end_time);
  return times_match ? nullptr : "a chunk's time range does not match its messages";
}

// After the last message of an intact chunk.
Status RecordReader::Impl::check_indexes() {
  in_chunk = false;
  mcap::Bytes& found = content;
  const std::uint64_t at = offset;
  const std::uint64_t size = std::min<std::uint64_t>(expected_indexes.size(), file_size - at);
  if (size == 0 && !expected_indexes.empty()) {
    done = true;
    return report(at, kCutBetween);
  }
  if (!read_at(at, size, found)) {
    done = true;
    return report(at, "the file cannot be read");
  }
  if (found == expected_indexes) {
    crc = mcap::crc32(found, crc);
    offset += size;
    return Status::kOk;
  }
  const bool cut = std::equal(found.begin(), found.end(), expected_indexes.begin());
  return report_and_resynchronise(
      at, cut ? kCutInRecord : "a chunk's message index does not match its messages");
}

Status RecordReader::Impl::finish(std::uint64_t at) {
  done = true;
  mcap::Decoder decoder(content);
  const std::uint32_t stored = decoder.u32();
  if (damages == 0 && stored != crc) {
    return report(at, "the data section's check value does not match: a byte outside the chunks");
  }
  mcap::Bytes tail;
  const std::uint64_t tail_at = at + mcap::kRecordHead + mcap::kDataEndContent;
  if (!read_at(tail_at, file_size - tail_at, tail)) return report(tail_at, "cannot be read");
  const char* wrong = check_tail(tail, tail_at);
  return wrong == nullptr ? Status::kEndOfData : report(tail_at, wrong);
}

// The summary, the footer and the closing magic.
const char* RecordReader::Impl::check_tail(ByteView tail, std::uint64_t at) const {
  constexpr std::size_t kEnd = mcap::kRecordHead + mcap::kFooterContent + mcap::kMagic.size();
  if (tail.size() < kEnd) return "the file is cut after its data";
  const ByteView magic = tail.last(mcap::kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), mcap::kMagic.begin())) {
    return "the file is cut inside its summary or its end mark is damaged";
  }
  mcap::Decoder footer(tail.subspan(tail.size() - kEnd));
  const auto opcode = static_cast<Opcode>(footer.u8());
  const std::uint64_t length = footer.u64();
  if (opcode != Opcode::kFooter || length != mcap::kFooterContent) return "the footer is damaged";
  const std::uint64_t summary_start = footer.u64();
  static_cast<void>(footer.u64());
  const std::uint32_t stored = footer.u32();
  const std::size_t covered = tail.size() - mcap::kMagic.size() - 4;
  const bool starts_here = summary_start == at || (summary_start == 0 && tail.size() == kEnd);
  if (!starts_here || stored != mcap::crc32(tail.first(covered))) {
    return "the summary's check value does not match";
  }
  return nullptr;
}

RecordReader::RecordReader() : impl_(std::make_unique<Impl>()) {}
RecordReader::~RecordReader() = default;

Status RecordReader::open(const std::string& path) {
  impl_ = std::make_unique<Impl>();
  Impl& impl = *impl_;
  impl.done = true;
  impl.file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat info {};
  if (impl.file < 0 || ::fstat(impl.file, &info) != 0 || !S_ISREG(info.st_mode)) {
    impl.damage.reason = "cannot be opened: ";
    impl.damage.reason += impl.file < 0 ? std::strerror(errno) : "not a regular file";
    return Status::kUnavailable;
  }
  impl.file_size = static_cast<std::uint64_t>(info.st_size);
  mcap::Bytes magic;
  const std::uint64_t size = std::min<std::uint64_t>(mcap::kMagic.size(), impl.file_size);
  if (!impl.read_at(0, size, magic)) {
    impl.damage.reason = "cannot be read";
    return Status::kUnavailable;
  }
  if (!std::equal(magic.begin(), magic.end(), mcap::kMagic.begin(), mcap::kMagic.end())) {
    return impl.report(0, "not an MCAP file: wrong first bytes");
  }
  impl.crc = mcap::crc32(magic);
  impl.offset = mcap::kMagic.size();
  impl.done = false;
  return Status::kOk;
}

Status RecordReader::next(RecordMessage& out) {
  Impl& impl = *impl_;
  while (true) {
    mcap::Message message;
    if (impl.in_chunk && mcap::read_message(impl.records, impl.position, message)) {
      out.channel = static_cast<RecordChannel>(message.channel);
      out.stamp = {static_cast<std::int64_t>(message.log_time)};
      out.sequence = message.sequence;
      out.bytes = message.data;
      out.chunk = impl.chunks - 1;
      out.chunk_offset = impl.chunk_offset;
      ++impl.messages;
      return Status::kOk;
    }
    if (impl.done) return Status::kEndOfData;
    const Status status = impl.in_chunk ? impl.check_indexes() : impl.read_record();
    if (!ok(status)) return status;
  }
}

const RecordDamage& RecordReader::damage() const { return impl_->damage; }

std::uint64_t RecordReader::damages() const { return impl_->damages; }

std::uint64_t RecordReader::messages() const { return impl_->messages; }

}  // namespace surefoot::hal
