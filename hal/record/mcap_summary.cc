#include "hal/record/mcap_summary.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>

namespace surefoot::hal::mcap {
namespace {

constexpr std::string_view kProfile = "surefoot";
constexpr std::string_view kLibrary = "surefoot hal/record 1";

struct ChunkEntry {
  ChunkHead head;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::map<std::uint16_t, std::uint64_t> index_offsets;
  std::uint64_t index_length = 0;
};

struct Totals {
  std::map<std::uint16_t, std::uint64_t> channel_counts;
  std::uint64_t messages = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
};

bool read_at(int file, std::uint64_t offset, std::span<std::uint8_t> out) {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got =
        ::pread(file, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

// Takes the record at `offset` into the tables; `length` is its content's.
bool take_record(int file, Opcode opcode, std::uint64_t offset, std::uint64_t length,
                 std::vector<ChunkEntry>& chunks, Totals& totals) {
  std::array<std::uint8_t, kChunkHead> head{};
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(head.size(), length));
  if (!read_at(file, offset + kRecordHead, std::span(head).first(wanted))) return false;
  if (opcode == Opcode::kChunk) {
    ChunkEntry entry;
    if (!read_chunk_head(head, length, entry.head)) return false;
    entry.offset = offset;
    entry.length = kRecordHead + length;
    const bool first = chunks.empty();
    totals.start_time =
        first ? entry.head.start_time : std::min(totals.start_time, entry.head.start_time);
    totals.end_time = std::max(totals.end_time, entry.head.end_time);
    chunks.push_back(entry);
  } else if (opcode == Opcode::kMessageIndex && !chunks.empty()) {
    Decoder decoder(head);
    const std::uint16_t channel = decoder.u16();
    const std::uint64_t count = decoder.u32() / 16;
    chunks.back().index_offsets[channel] = offset;
    chunks.back().index_length += kRecordHead + length;
    totals.channel_counts[channel] += count;
    totals.messages += count;
  }
  return true;
}

bool walk_data(int file, std::uint64_t data_end, std::vector<ChunkEntry>& chunks, Totals& totals) {
  std::uint64_t offset = kMagic.size();
  while (offset < data_end) {
    std::array<std::uint8_t, kRecordHead> head{};
    if (!read_at(file, offset, head)) return false;
    Decoder decoder(head);
    const auto opcode = static_cast<Opcode>(decoder.u8());
    const std::uint64_t length = decoder.u64();
    if (length > data_end - offset - kRecordHead) return false;
    if (!take_record(file, opcode, offset, length, chunks, totals)) return false;
    offset += kRecordHead + length;
  }
  return true;
}

void append_schemas(const RecordLayout& layout, Bytes& out) {
  Encoder encoder(out);
  for (const RecordChannelInfo& info : layout) {
    if (info.schema_encoding.empty()) continue;
    const std::size_t record = encoder.open_record(Opcode::kSchema);
    encoder.u16(static_cast<std::uint16_t>(info.channel));
    encoder.string(info.schema_name);
    encoder.string(info.schema_encoding);
    encoder.string(info.schema_text);
    encoder.close_record(record);
  }
}

void append_channels(const RecordLayout& layout, Bytes& out) {
  Encoder encoder(out);
  for (const RecordChannelInfo& info : layout) {
    const auto id = static_cast<std::uint16_t>(info.channel);
    const std::size_t record = encoder.open_record(Opcode::kChannel);
    encoder.u16(id);
    encoder.u16(info.schema_encoding.empty() ? std::uint16_t{0} : id);
    encoder.string(info.topic);
    encoder.string(info.message_encoding);
    encoder.close_list(encoder.open_list());  // no metadata
    encoder.close_record(record);
  }
}

void append_chunk_indexes(const std::vector<ChunkEntry>& chunks, Bytes& out) {
  Encoder encoder(out);
  for (const ChunkEntry& chunk : chunks) {
    const std::size_t record = encoder.open_record(Opcode::kChunkIndex);
    encoder.u64(chunk.head.start_time);
    encoder.u64(chunk.head.end_time);
    encoder.u64(chunk.offset);
    encoder.u64(chunk.length);
    const std::size_t list = encoder.open_list();
    for (const auto& [channel, offset] : chunk.index_offsets) {
      encoder.u16(channel);
      encoder.u64(offset);
    }
    encoder.close_list(list);
    encoder.u64(chunk.index_length);
    encoder.string(kCompression);
    encoder.u64(chunk.head.compressed_size);
    encoder.u64(chunk.head.uncompressed_size);
    encoder.close_record(record);
  }
}

void append_statistics(const RecordLayout& layout, const Totals& totals, std::size_t chunks,
                       Bytes& out) {
  const auto schemas = std::count_if(
      layout.begin(), layout.end(), [](const auto& info) { return !info.schema_encoding.empty(); });
  Encoder encoder(out);
  const std::size_t record = encoder.open_record(Opcode::kStatistics);
  encoder.u64(totals.messages);
  encoder.u16(static_cast<std::uint16_t>(schemas));
  encoder.u32(static_cast<std::uint32_t>(layout.size()));
  encoder.u32(0);  // attachments
  encoder.u32(0);  // metadata
  encoder.u32(static_cast<std::uint32_t>(chunks));
  encoder.u64(totals.start_time);
  encoder.u64(totals.end_time);
  const std::size_t list = encoder.open_list();
  for (const auto& [channel, count] : totals.channel_counts) {
    encoder.u16(channel);
    encoder.u64(count);
  }
  encoder.close_list(list);
  encoder.close_record(record);
}

struct Group {
  Opcode opcode;
  std::uint64_t begin;
  std::uint64_t length;
};

void append_offsets(const std::vector<Group>& groups, Bytes& out) {
  Encoder encoder(out);
  for (const Group& group : groups) {
    if (group.length == 0) continue;
    const std::size_t record = encoder.open_record(Opcode::kSummaryOffset);
    encoder.u8(static_cast<std::uint8_t>(group.opcode));
    encoder.u64(group.begin);
    encoder.u64(group.length);
    encoder.close_record(record);
  }
}

// The footer's CRC covers the summary and the footer up to the CRC itself.
void append_footer(std::size_t summary_at, std::uint64_t summary_start, std::uint64_t offsets_start,
                   Bytes& out) {
  Encoder encoder(out);
  const std::size_t record = encoder.open_record(Opcode::kFooter);
  encoder.u64(summary_start);
  encoder.u64(offsets_start);
  encoder.u32(0);
  encoder.close_record(record);
  const std::size_t covered_end = out.size() - 4;
  const ByteView covered = ByteView(out).subspan(summary_at, covered_end - summary_at);
  const std::uint32_t crc = crc32(covered);
  out.resize(covered_end);
  encoder.u32(crc);
  encoder.raw(kMagic);
}

}  // namespace

void append_head(const RecordLayout& layout, Bytes& out) {
  Encoder encoder(out);
  encoder.raw(kMagic);
  const std::size_t record = encoder.open_record(Opcode::kHeader);
  encoder.string(kProfile);
  encoder.string(kLibrary);
  encoder.close_record(record);
  append_schemas(layout, out);
  append_channels(layout, out);
}

bool append_tail(int file, const RecordLayout& layout, std::uint64_t data_end,
                 std::uint32_t data_crc, Bytes& out) {
  const std::size_t base = out.size();
  const auto file_offset = [&] { return data_end + (out.size() - base); };
  Encoder encoder(out);
  const std::size_t record = encoder.open_record(Opcode::kDataEnd);
  encoder.u32(data_crc);
  encoder.close_record(record);

  const std::size_t summary_at = out.size();
  const std::uint64_t summary_start = file_offset();
  std::vector<ChunkEntry> chunks;
  Totals totals;
  if (!walk_data(file, data_end, chunks, totals)) {
    append_footer(summary_at, 0, 0, out);
    return false;
  }
  std::vector<Group> groups;
  const auto group = [&](Opcode opcode, const auto& append) {
    const std::uint64_t begin = file_offset();
    append();
    groups.push_back({opcode, begin, file_offset() - begin});
  };
  group(Opcode::kSchema, [&] { append_schemas(layout, out); });
  group(Opcode::kChannel, [&] { append_channels(layout, out); });
  group(Opcode::kChunkIndex, [&] { append_chunk_indexes(chunks, out); });
  group(Opcode::kStatistics, [&] { append_statistics(layout, totals, chunks.size(), out); });
  const std::uint64_t offsets_start = file_offset();
  append_offsets(groups, out);
  append_footer(summary_at, summary_start, offsets_start, out);
  return true;
}

}  // namespace surefoot::hal::mcap
