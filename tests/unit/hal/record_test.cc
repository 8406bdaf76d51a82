#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <map>
#include <thread>

#include "core/base/random.h"
#include "hal/record/mcap_format.h"
#include "tests/unit/hal/record_fixture.h"

namespace surefoot::hal {
namespace {

using testing::Bytes;
using testing::load;
using testing::read_all;
using testing::ReadResult;
using testing::save;
using testing::ScratchFolder;
using testing::small_layout;

// Compressible and not, so that chunks have both.
Bytes payload(std::uint64_t index, std::size_t size) {
  Random random(index);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next_u32() & 0x0F);
  return bytes;
}

// A configuration and `ticks` ticks of `size` bytes, one millisecond apart, in chunks of 10 ms.
void write_record(const std::string& path, std::uint64_t ticks, std::size_t size,
                  RecordWriterOptions options = {}) {
  RecordWriter writer;
  if (options.max_chunk_span == milliseconds(1000)) options.max_chunk_span = milliseconds(10);
  ASSERT_EQ(writer.open(path, small_layout(), options), Status::kOk) << writer.error();
  const Bytes configuration = {'a', ':', ' ', '1', '\n'};
  ASSERT_EQ(writer.write(RecordChannel::kConfiguration, {}, configuration), Status::kOk);
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const TimeNs stamp = milliseconds(static_cast<std::int64_t>(i));
    ASSERT_EQ(writer.write(RecordChannel::kTick, stamp, payload(i, size)), Status::kOk);
  }
  ASSERT_EQ(writer.close(), Status::kOk) << writer.error();
  EXPECT_EQ(writer.counters().messages, ticks + 1);
  EXPECT_EQ(writer.counters().dropped, 0u);
}

TEST(Record, EverythingComesBackInOrder) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 500, 300);
  const ReadResult result = read_all(folder.file("a.mcap"));
  EXPECT_TRUE(result.damages.empty()) << result.damages[0].reason;
  ASSERT_EQ(result.before.size(), 501u);
  EXPECT_EQ(result.before[0].channel, RecordChannel::kConfiguration);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const auto& message = result.before[i + 1];
    EXPECT_EQ(message.channel, RecordChannel::kTick);
    EXPECT_EQ(message.sequence, i);
    EXPECT_EQ(message.stamp_ns, static_cast<std::int64_t>(i) * 1'000'000);
    EXPECT_EQ(message.chunk, i / 10);
    EXPECT_EQ(message.bytes, payload(i, 300));
  }
}

TEST(Record, EmptyRecordIsWhole) {
  const ScratchFolder folder;
  RecordWriter writer;
  ASSERT_EQ(writer.open(folder.file("e.mcap"), small_layout()), Status::kOk);
  ASSERT_EQ(writer.close(), Status::kOk);
  ASSERT_EQ(writer.close(), Status::kOk);
  const ReadResult result = read_all(folder.file("e.mcap"));
  EXPECT_EQ(result.opened, Status::kOk);
  EXPECT_TRUE(result.before.empty());
  EXPECT_TRUE(result.damages.empty());
}

TEST(Record, TheSameMessagesGiveTheSameFile) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 200, 100);
  write_record(folder.file("b.mcap"), 200, 100);
  EXPECT_EQ(load(folder.file("a.mcap")), load(folder.file("b.mcap")));
}

TEST(Record, ChunksEndWhenFull) {
  const ScratchFolder folder;
  RecordWriterOptions options;
  options.chunk_bytes = 1000;
  options.max_chunk_span = milliseconds(100'000);
  write_record(folder.file("a.mcap"), 30, 300, options);  // 331 bytes each: three to a chunk
  const ReadResult result = read_all(folder.file("a.mcap"));
  ASSERT_EQ(result.before.size(), 31u);
  EXPECT_EQ(result.before[2].chunk, 0u);
  EXPECT_EQ(result.before[3].chunk, 1u);
  EXPECT_TRUE(result.damages.empty());
}

TEST(Record, WrongUseIsRefusedAndCounted) {
  const ScratchFolder folder;
  RecordWriter writer;
  const Bytes byte = {1};
  EXPECT_EQ(writer.write(RecordChannel::kTick, {}, byte), Status::kUnavailable);
  RecordWriterOptions options;
  options.chunk_bytes = 1000;
  ASSERT_EQ(writer.open(folder.file("a.mcap"), small_layout(), options), Status::kOk);
  EXPECT_EQ(writer.write(RecordChannel::kLidar, {}, byte), Status::kInvalid);
  EXPECT_EQ(writer.write(RecordChannel::kTick, {}, Bytes(1000)), Status::kInvalid);
  EXPECT_EQ(writer.write(RecordChannel::kTick, {}, byte), Status::kOk);
  EXPECT_EQ(writer.counters().dropped, 2u);
  EXPECT_EQ(writer.counters().messages, 1u);
  options.chunk_buffers = 1;
  EXPECT_EQ(writer.open(folder.file("a.mcap"), small_layout(), options), Status::kInvalid);
  auto twice = small_layout();
  twice.push_back(twice[0]);
  EXPECT_EQ(writer.open(folder.file("a.mcap"), twice), Status::kInvalid);
  EXPECT_NE(writer.error(), "");
  EXPECT_EQ(writer.open(folder.file("no/such/folder"), small_layout()), Status::kUnavailable);
}

// Walks the file with an independent reading of the specification.
TEST(Record, TheFileFollowsTheMcapSpecification) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 25, 40);
  const Bytes file = load(folder.file("a.mcap"));
  const auto u = [&](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= static_cast<std::uint64_t>(file.at(at + i)) << (8 * i);
    }
    return value;
  };
  const Bytes magic = {0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};
  ASSERT_TRUE(std::equal(magic.begin(), magic.end(), file.begin()));
  ASSERT_TRUE(std::equal(magic.begin(), magic.end(), file.end() - 8));

  std::vector<std::pair<int, std::size_t>> records;  // opcode, offset
  std::map<std::size_t, std::size_t> lengths;
  for (std::size_t at = 8; at < file.size() - 8; at += 9 + lengths[at]) {
    records.emplace_back(file[at], at);
    lengths[at] = u(at + 1, 8);
  }
  std::vector<int> opcodes;
  for (const auto& record : records) opcodes.push_back(record.first);
  // Header; two schemas, three channels; three chunks with their indexes (the first has two
  // channels); data end; summary; offsets; footer.
  EXPECT_EQ(opcodes, (std::vector<int>{1, 3, 3, 4, 4, 4, 6, 7, 7,  6,  7,  6,  7,  15,
                                       3, 3, 4, 4, 4, 8, 8, 8, 11, 14, 14, 14, 14, 2}));

  // A channel of our own reading: id, schema, topic.
  const std::size_t channel = records[4].second + 9;
  EXPECT_EQ(u(channel, 2), 2u);
  EXPECT_EQ(u(channel + 2, 2), 2u);
  EXPECT_EQ(std::string(file.begin() + static_cast<std::ptrdiff_t>(channel) + 8,
                        file.begin() + static_cast<std::ptrdiff_t>(channel) + 13),
            "/tick");
  EXPECT_EQ(u(records[3].second + 9 + 2, 2), 0u);  // the configuration has no schema

  // The second chunk: ticks 10 to 19.
  const std::size_t chunk = records[9].second + 9;
  EXPECT_EQ(u(chunk, 8), 10'000'000u);
  EXPECT_EQ(u(chunk + 8, 8), 19'000'000u);
  const std::uint64_t size = u(chunk + 16, 8);
  EXPECT_EQ(size, 10u * (9 + 22 + 40));
  EXPECT_EQ(u(chunk + 28, 4), 4u);
  EXPECT_EQ(std::memcmp(&file[chunk + 32], "zstd", 4), 0);
  const std::uint64_t packed = u(chunk + 36, 8);
  EXPECT_EQ(lengths[records[9].second], 44 + packed);
  Bytes raw(size);
  ASSERT_EQ(ZSTD_decompress(raw.data(), raw.size(), &file[chunk + 44], packed), size);
  EXPECT_EQ(u(chunk + 24, 4), ::crc32(0, raw.data(), static_cast<uInt>(raw.size())));
  EXPECT_EQ(raw[0], 5);  // a message: channel, sequence, two times, data
  EXPECT_EQ(raw[9], 2);
  EXPECT_EQ(raw[11], 10);
  EXPECT_TRUE(std::equal(raw.begin() + 31, raw.begin() + 71, payload(10, 40).begin()));

  // Its index points at every message.
  const std::size_t index = records[10].second + 9;
  EXPECT_EQ(u(index, 2), 2u);
  ASSERT_EQ(u(index + 2, 4), 160u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(u(index + 6 + 16 * i, 8), (10 + i) * 1'000'000);
    EXPECT_EQ(u(index + 14 + 16 * i, 8), 71 * i);
  }

  // Data end.
  const std::size_t data_end = records[13].second;
  EXPECT_EQ(u(data_end + 9, 4), ::crc32(0, file.data(), static_cast<uInt>(data_end)));

  // Chunk index of the second chunk.
  const std::size_t entry = records[20].second + 9;
  EXPECT_EQ(u(entry, 8), 10'000'000u);
  EXPECT_EQ(u(entry + 8, 8), 19'000'000u);
  EXPECT_EQ(u(entry + 16, 8), records[9].second);
  EXPECT_EQ(u(entry + 24, 8), 9 + lengths[records[9].second]);
  EXPECT_EQ(u(entry + 32, 4), 10u);
  EXPECT_EQ(u(entry + 36, 2), 2u);
  EXPECT_EQ(u(entry + 38, 8), records[10].second);
  EXPECT_EQ(u(entry + 46, 8), 9 + lengths[records[10].second]);
  EXPECT_EQ(u(entry + 62, 8), packed);
  EXPECT_EQ(u(entry + 70, 8), size);

  // Statistics.
  const std::size_t statistics = records[22].second + 9;
  EXPECT_EQ(u(statistics, 8), 26u);
  EXPECT_EQ(u(statistics + 8, 2), 2u);
  EXPECT_EQ(u(statistics + 10, 4), 3u);
  EXPECT_EQ(u(statistics + 22, 4), 3u);
  EXPECT_EQ(u(statistics + 26, 8), 0u);
  EXPECT_EQ(u(statistics + 34, 8), 24'000'000u);

  // Offsets point at their groups; the footer at the summary.
  for (std::size_t i = 23; i < 27; ++i) {
    const std::size_t offset = records[i].second + 9;
    const std::size_t group = u(offset + 1, 8);
    EXPECT_EQ(file.at(offset), file.at(group));
    const std::size_t end = group + u(offset + 9, 8);
    EXPECT_NE(file.at(end), file.at(group));
  }
  const std::size_t footer = records[27].second;
  EXPECT_EQ(u(footer + 9, 8), records[14].second);
  EXPECT_EQ(u(footer + 17, 8), records[23].second);
  EXPECT_EQ(u(footer + 25, 4), ::crc32(0, &file[records[14].second],
                                       static_cast<uInt>(footer + 25 - records[14].second)));
  EXPECT_EQ(footer + 29 + 8, file.size());
}

// Every prefix of a file: what precedes the cut is delivered, the cut is reported, nothing is
// invented.
TEST(Record, CutAtEveryByte) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 45, 20);
  const Bytes file = load(folder.file("a.mcap"));
  const ReadResult whole = read_all(folder.file("a.mcap"));
  ASSERT_TRUE(whole.damages.empty());
  std::filesystem::copy_file(folder.file("a.mcap"), folder.file("cut.mcap"));
  std::size_t delivered_before = whole.before.size();
  for (std::size_t size = file.size(); size-- > 0;) {
    std::filesystem::resize_file(folder.file("cut.mcap"), size);
    const ReadResult result = read_all(folder.file("cut.mcap"));
    ASSERT_EQ(result.damages.size(), 1u) << size;
    EXPECT_LE(result.damages[0].offset, size);
    EXPECT_FALSE(result.damages[0].reason.empty());
    ASSERT_LE(result.before.size(), whole.before.size());
    EXPECT_TRUE(std::equal(result.before.begin(), result.before.end(), whole.before.begin()));
    EXPECT_TRUE(result.after.empty());
    // A cut after the data takes nothing; a cut in a chunk takes what is from that chunk on.
    EXPECT_LE(result.before.size(), delivered_before) << size;
    EXPECT_GE(result.before.size() + 11, delivered_before) << size;
    delivered_before = result.before.size();
  }
  EXPECT_EQ(delivered_before, 0u);
}

// One flipped byte anywhere: reported, everything before it delivered as it was, everything
// delivered after it was written.
TEST(Record, OneDamagedByteAnywhere) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 45, 20);
  const Bytes file = load(folder.file("a.mcap"));
  const ReadResult whole = read_all(folder.file("a.mcap"));
  Random random(1);
  save(folder.file("bad.mcap"), file);
  std::fstream spoiled(folder.file("bad.mcap"), std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](std::size_t at, std::uint8_t value) {
    spoiled.seekp(static_cast<std::streamoff>(at));
    spoiled.put(static_cast<char>(value));
    spoiled.flush();
  };
  for (std::size_t at = 0; at < file.size(); ++at) {
    if (at > 0) put(at - 1, file[at - 1]);
    const std::uint32_t bit = random.below(9);  // a single bit, or all of them
    put(at, file[at] ^ static_cast<std::uint8_t>(bit == 8 ? 0xFF : 1u << bit));
    const ReadResult result = read_all(folder.file("bad.mcap"));
    ASSERT_FALSE(result.damages.empty()) << at;
    if (!ok(result.opened)) continue;
    ASSERT_LE(result.before.size(), whole.before.size()) << at;
    EXPECT_TRUE(std::equal(result.before.begin(), result.before.end(), whole.before.begin())) << at;
    // At most the damaged chunk is lost (11 messages), whatever the damage.
    EXPECT_GE(result.before.size() + result.after.size() + 11, whole.before.size()) << at;
    for (const auto& message : result.after) {
      const auto same = std::find_if(whole.before.begin(), whole.before.end(), [&](const auto& m) {
        return m.channel == message.channel && m.sequence == message.sequence;
      });
      ASSERT_NE(same, whole.before.end()) << at;
      EXPECT_EQ(same->bytes, message.bytes) << at;
    }
  }
}

TEST(Record, DamageInsideAChunkNamesItsChunkAndByte) {
  const ScratchFolder folder;
  write_record(folder.file("a.mcap"), 45, 20);
  Bytes file = load(folder.file("a.mcap"));
  // Chunk records by walking.
  std::vector<std::size_t> chunks;
  for (std::size_t at = 8; at < file.size() - 8;) {
    if (file[at] == 6) chunks.push_back(at);
    std::uint64_t length = 0;
    std::memcpy(&length, &file[at + 1], 8);
    at += 9 + length;
  }
  ASSERT_EQ(chunks.size(), 5u);
  file[chunks[2] + 9 + 44 + 15] ^= 0x10;
  save(folder.file("bad.mcap"), file);
  const ReadResult result = read_all(folder.file("bad.mcap"));
  ASSERT_EQ(result.damages.size(), 1u);
  EXPECT_EQ(result.damages[0].offset, chunks[2]);
  EXPECT_EQ(result.damages[0].chunk, 2u);
  EXPECT_EQ(result.before.size(), 21u);
  EXPECT_EQ(result.after.size(), 15u);
}

TEST(Record, GarbageIsRefused) {
  const ScratchFolder folder;
  EXPECT_EQ(read_all(folder.file("none")).opened, Status::kUnavailable);
  EXPECT_EQ(read_all("/dev/null").opened, Status::kUnavailable);
  save(folder.file("empty"), {});
  EXPECT_EQ(read_all(folder.file("empty")).opened, Status::kCorrupt);
  save(folder.file("text"), payload(1, 5000));
  EXPECT_EQ(read_all(folder.file("text")).opened, Status::kCorrupt);
  // The right first bytes, then noise.
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Bytes bytes(mcap::kMagic.begin(), mcap::kMagic.end());
    Random random(seed);
    for (int i = 0; i < 4000; ++i) bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
    save(folder.file("noise"), bytes);
    const ReadResult result = read_all(folder.file("noise"));
    EXPECT_TRUE(result.before.empty());
    EXPECT_FALSE(result.damages.empty());
  }
}

TEST(Record, AFullDiskAtTheStartIsReported) {
  RecordWriter writer;
  EXPECT_EQ(writer.open("/dev/full", small_layout()), Status::kUnavailable);
  EXPECT_NE(writer.error().find("No space left"), std::string::npos) << writer.error();
  const Bytes byte = {1};
  EXPECT_EQ(writer.write(RecordChannel::kTick, {}, byte), Status::kUnavailable);
  EXPECT_EQ(writer.counters().dropped, 1u);
}

// A file size limit stands in for a disk that fills up during the run. In a child process, since
// the limit holds for all of a process.
TEST(Record, ADiskThatFillsUpLosesOnlyWhatCameAfter) {
  const ScratchFolder folder;
  const std::string path = folder.file("a.mcap");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{40'000, 40'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    RecordWriter writer;
    RecordWriterOptions options;
    options.chunk_bytes = 8'000;
    options.chunk_buffers = 3;
    if (!ok(writer.open(path, small_layout(), options))) ::_exit(1);
    Status status = Status::kOk;
    std::uint64_t written = 0;
    for (std::uint64_t i = 0; i < 2'000; ++i) {
      status = writer.write(RecordChannel::kTick, milliseconds(1), payload(i, 300));
      if (ok(status)) ++written;
    }
    if (status != Status::kUnavailable || ok(writer.close()) || ok(writer.status())) ::_exit(2);
    if (writer.counters().messages + writer.counters().dropped != 2'000) ::_exit(3);
    if (writer.counters().messages >= written)
      ::_exit(4);  // the failed chunk is not counted as kept
    if (writer.error().find("messages lost") == std::string::npos) ::_exit(5);
    // What is counted as kept is in the file.
    const ReadResult result = read_all(path);
    ::_exit(result.before.size() == writer.counters().messages && !result.before.empty() ? 0 : 6);
  }
  int state = 0;
  ASSERT_EQ(::waitpid(child, &state, 0), child);
  ASSERT_TRUE(WIFEXITED(state));
  EXPECT_EQ(WEXITSTATUS(state), 0);
  const ReadResult result = read_all(path);
  ASSERT_EQ(result.damages.size(), 1u);
  for (std::size_t i = 0; i < result.before.size(); ++i) {
    EXPECT_EQ(result.before[i].bytes, payload(i, 300));
  }
}

// A pipe that nobody empties stands in for a disk that stalls.
TEST(Record, AStalledDiskDropsAndCountsInsteadOfWaiting) {
  const ScratchFolder folder;
  const std::string path = folder.file("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reading = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reading, 0);
  RecordWriter writer;
  RecordWriterOptions options;
  options.chunk_bytes = 100'000;
  options.chunk_buffers = 2;
  options.when_full = WhenFull::kDrop;
  ASSERT_EQ(writer.open(path, small_layout(), options), Status::kOk) << writer.error();
  std::uint64_t refused = 0;
  for (std::uint64_t i = 0; i < 2'000; ++i) {
    const Status status = writer.write(RecordChannel::kTick, milliseconds(1), payload(i, 1'000));
    if (status == Status::kExhausted) ++refused;
  }
  EXPECT_GT(refused, 0u);
  EXPECT_EQ(writer.counters().dropped, refused);
  // The disk comes back. A pipe cannot be read back for the index, which is reported.
  std::atomic<bool> closed{false};
  std::thread drain([&] {
    Bytes sink(1 << 16);
    while (!closed) {
      if (::read(reading, sink.data(), sink.size()) <= 0) std::this_thread::yield();
    }
  });
  EXPECT_EQ(writer.close(), Status::kUnavailable);
  closed = true;
  drain.join();
  ::close(reading);
  EXPECT_EQ(writer.counters().dropped, refused);
}

}  // namespace
}  // namespace surefoot::hal
