// The parts of the MCAP container format (https://mcap.dev/spec) that Surefoot writes and reads.
// Private to hal/record and its tests.
//
//   file    = magic, records, magic
//   record  = opcode (1 byte), content length (8), content; integers little-endian
//   string  = length (4), bytes; lists and maps likewise carry their length in bytes (4)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::hal::mcap {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr std::string_view kCompression = "zstd";
inline constexpr std::size_t kRecordHead = 1 + 8;           // opcode, length
inline constexpr std::size_t kMessageHead = 2 + 4 + 8 + 8;  // channel, sequence, two times
inline constexpr std::size_t kFooterContent = 8 + 8 + 4;
inline constexpr std::size_t kDataEndContent = 4;
// Content of a chunk record before its compressed bytes: two times, size, CRC, "zstd", length.
inline constexpr std::size_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 4 + 8;

// Appends to a byte vector. Allocates only beyond the vector's capacity.
class Encoder {
 public:
  explicit Encoder(Bytes& out) : out_(out) {}

  void u8(std::uint8_t value) { integer(value, 1); }
  void u16(std::uint16_t value) { integer(value, 2); }
  void u32(std::uint32_t value) { integer(value, 4); }
  void u64(std::uint64_t value) { integer(value, 8); }
  void raw(ByteView bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  void string(std::string_view text);
  // Opens a record or a list whose length is not known yet; close() with the returned position.
  std::size_t open_record(Opcode opcode);
  void close_record(std::size_t position);
  std::size_t open_list();
  void close_list(std::size_t position);

 private:
  void integer(std::uint64_t value, std::size_t size);
  void patch(std::size_t position, std::uint64_t value, std::size_t size);

  Bytes& out_;
};

// Takes a byte range apart. After the first read beyond the end, ok() is false and reads give
// zeros.
class Decoder {
 public:
  explicit Decoder(ByteView bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(integer(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(integer(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(integer(4)); }
  std::uint64_t u64() { return integer(8); }
  std::string_view string();
  ByteView raw(std::uint64_t size);
  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && position_ == bytes_.size(); }
  std::size_t position() const { return position_; }

 private:
  std::uint64_t integer(std::size_t size);

  ByteView bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

// CRC-32 as in zlib; `before` continues an earlier one.
std::uint32_t crc32(ByteView bytes, std::uint32_t before = 0);

// One message record inside the uncompressed bytes of a chunk.
struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  ByteView data;
};

// Reads the message record at `position` and moves position behind it. false: no whole message
// record is there; position is unchanged.
bool read_message(ByteView records, std::size_t& position, Message& out);

// The head of a chunk record's content, and where its compressed bytes lie within the content.
struct ChunkHead {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::uint64_t compressed_size = 0;
};

// Reads kChunkHead bytes. false: the compression is not ours or the lengths do not add up to
// `content_size`.
bool read_chunk_head(ByteView content_begin, std::uint64_t content_size, ChunkHead& out);

// Appends the MessageIndex records of a chunk: one for each channel in it, ascending.
void append_message_indexes(ByteView records, Bytes& out);
// An upper bound of what append_message_indexes() appends for a chunk of so many bytes.
std::size_t message_indexes_bound(std::size_t chunk_bytes);

}  // namespace surefoot::hal::mcap
