#include "hal/record/mcap_format.h"

#include <zlib.h>

#include <algorithm>
#include <bitset>

namespace surefoot::hal::mcap {
namespace {

// RecordChannel is one byte wide.
constexpr std::size_t kMaxChannels = 256;

}  // namespace

void Encoder::integer(std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    out_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

void Encoder::patch(std::size_t position, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    out_[position + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

void Encoder::string(std::string_view text) {
  u32(static_cast<std::uint32_t>(text.size()));
  out_.insert(out_.end(), text.begin(), text.end());
}

std::size_t Encoder::open_record(Opcode opcode) {
  u8(static_cast<std::uint8_t>(opcode));
  u64(0);
  return out_.size();
}

void Encoder::close_record(std::size_t position) { patch(position - 8, out_.size() - position, 8); }

std::size_t Encoder::open_list() {
  u32(0);
  return out_.size();
}

void Encoder::close_list(std::size_t position) { patch(position - 4, out_.size() - position, 4); }

std::uint64_t Decoder::integer(std::size_t size) {
  const ByteView bytes = raw(size);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
  }
  return value;
}

ByteView Decoder::raw(std::uint64_t size) {
  if (!ok_ || size > bytes_.size() - position_) {
    ok_ = false;
    return {};
  }
  const ByteView piece = bytes_.subspan(position_, static_cast<std::size_t>(size));
  position_ += piece.size();
  return piece;
}

std::string_view Decoder::string() {
  const std::uint32_t size = u32();
  const ByteView bytes = raw(size);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint32_t crc32(ByteView bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

bool read_message(ByteView records, std::size_t& position, Message& out) {
  if (position > records.size()) return false;
  Decoder decoder(records.subspan(position));
  const auto opcode = static_cast<Opcode>(decoder.u8());
  const std::uint64_t length = decoder.u64();
  if (!decoder.ok() || opcode != Opcode::kMessage || length < kMessageHead) return false;
  out.channel = decoder.u16();
  out.sequence = decoder.u32();
  out.log_time = decoder.u64();
  static_cast<void>(decoder.u64());  // publish time: the same
  out.data = decoder.raw(length - kMessageHead);
  if (!decoder.ok()) return false;
  position += decoder.position();
  return true;
}

bool read_chunk_head(ByteView content_begin, std::uint64_t content_size, ChunkHead& out) {
  Decoder decoder(content_begin);
  out.start_time = decoder.u64();
  out.end_time = decoder.u64();
  out.uncompressed_size = decoder.u64();
  out.uncompressed_crc = decoder.u32();
  const std::string_view compression = decoder.string();
  out.compressed_size = decoder.u64();
  if (!decoder.ok() || compression != kCompression) return false;
  return content_size >= kChunkHead && out.compressed_size == content_size - kChunkHead;
}

void append_message_indexes(ByteView records, Bytes& out) {
  std::bitset<kMaxChannels> present;
  Message message;
  for (std::size_t at = 0; read_message(records, at, message);) {
    if (message.channel < kMaxChannels) present.set(message.channel);
  }
  Encoder encoder(out);
  for (std::size_t channel = 0; channel < kMaxChannels; ++channel) {
    if (!present.test(channel)) continue;
    const std::size_t record = encoder.open_record(Opcode::kMessageIndex);
    encoder.u16(static_cast<std::uint16_t>(channel));
    const std::size_t list = encoder.open_list();
    for (std::size_t at = 0, begin = 0; read_message(records, at, message); begin = at) {
      if (message.channel != channel) continue;
      encoder.u64(message.log_time);
      encoder.u64(begin);
    }
    encoder.close_list(list);
    encoder.close_record(record);
  }
}

std::size_t message_indexes_bound(std::size_t chunk_bytes) {
  // 16 bytes for each message, which takes at least its head; one record head for each channel.
  return 16 * (chunk_bytes / (kRecordHead + kMessageHead)) + kMaxChannels * (kRecordHead + 2 + 4);
}

}  // namespace surefoot::hal::mcap
