#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/random.h"
#include "hal/candump/candump_reader.h"
#include "hal/candump/candump_text.h"
#include "hal/candump/file_can_log.h"

namespace surefoot::hal {
namespace {

CandumpFault fault_of(std::string_view line) {
  CandumpEntry entry;
  return parse_candump_line(line, entry);
}

CandumpEntry entry_of(std::string_view line) {
  CandumpEntry entry;
  EXPECT_EQ(parse_candump_line(line, entry), CandumpFault::kNone) << line;
  return entry;
}

std::string text_of(const CandumpEntry& entry) {
  std::array<char, kMaxCandumpLine> line{};
  return std::string(line.data(), format_candump_line(entry, line));
}

TEST(CandumpText, ClassicFrame) {
  const CandumpEntry e = entry_of("(1398128223.803317) can0 166#D0320009");
  EXPECT_EQ(e.frame.stamp.ns, 1398128223803317000);
  EXPECT_EQ(e.interface_name, "can0");
  EXPECT_EQ(e.frame.id, 0x166u);
  EXPECT_EQ(e.frame.flags, 0);
  EXPECT_EQ(e.frame.size, 4);
  EXPECT_EQ(e.frame.data[0], 0xD0);
  EXPECT_EQ(e.frame.data[3], 0x09);
  EXPECT_EQ(e.frame.data[4], 0);
}

TEST(CandumpText, EveryKindOfFrame) {
  EXPECT_EQ(entry_of("(0000000001.000002) vcan0 7FF#").frame.size, 0);
  const CandumpEntry extended = entry_of("(1.000000) can1 1FFFFFFF#ff");
  EXPECT_EQ(extended.frame.flags, CanFrame::kExtendedId);
  EXPECT_EQ(extended.frame.id, 0x1FFFFFFFu);
  EXPECT_EQ(extended.frame.data[0], 0xFF);
  const CandumpEntry small_extended = entry_of("(1.000000) can1 00000123#");
  EXPECT_EQ(small_extended.frame.flags, CanFrame::kExtendedId);
  const CandumpEntry error = entry_of("(1.000000) can1 20000040#0000000000000000");
  EXPECT_EQ(error.frame.flags, CanFrame::kErrorFrame);
  EXPECT_EQ(error.frame.id, 0x40u);
  const CandumpEntry remote = entry_of("(1.000000) can1 123#R");
  EXPECT_TRUE(remote.remote);
  EXPECT_EQ(remote.frame.size, 0);
  EXPECT_EQ(entry_of("(1.000000) can1 123#R5").frame.size, 5);
  const CandumpEntry fd = entry_of("(1.000000) can1 123##1001122334455667788990011");
  EXPECT_EQ(fd.frame.flags, CanFrame::kFlexibleDataRate | CanFrame::kBitRateSwitch);
  EXPECT_EQ(fd.frame.size, 12);
  EXPECT_EQ(fd.frame.data[11], 0x11);
  EXPECT_EQ(entry_of("(1.000000) can1 123##0").frame.flags, CanFrame::kFlexibleDataRate);
  EXPECT_EQ(entry_of("(1.000000) can1 12345678##4" + std::string(128, 'A')).frame.size, 64);
  EXPECT_EQ(entry_of("(1.000000) can1 123#1122334455667788_E").frame.size, 8);
  EXPECT_EQ(entry_of("(1.123456789) can1 123#11").frame.stamp.ns, 1123456789);
  EXPECT_EQ(entry_of("(1.000000) can1 123#11 R\r").frame.size, 1);
  EXPECT_EQ(entry_of("(1.000000) can1 123#11 T").frame.size, 1);
}

TEST(CandumpText, FaultsAreNamed) {
  const std::map<std::string, CandumpFault> lines = {
      {"", CandumpFault::kStamp},
      {"can0 123#00", CandumpFault::kStamp},
      {"(1.00) can0 123#00", CandumpFault::kStamp},
      {"(-1.000000) can0 123#00", CandumpFault::kStamp},
      {"(99999999999.000000) can0 123#00", CandumpFault::kStamp},
      {"(9999999999.000000) can0 123#00", CandumpFault::kStamp},
      {"(1.000000)", CandumpFault::kStamp},
      {"(1.000000)  123#00", CandumpFault::kInterface},
      {"(1.000000) can0", CandumpFault::kInterface},
      {"(1.000000) abcdefghijklmnop 123#00", CandumpFault::kInterface},
      {"(1.000000) can0 12#00", CandumpFault::kId},
      {"(1.000000) can0 800#00", CandumpFault::kId},
      {"(1.000000) can0 1234#00", CandumpFault::kId},
      {"(1.000000) can0 80000000#00", CandumpFault::kId},
      {"(1.000000) can0 4000000F#00", CandumpFault::kId},
      {"(1.000000) can0 12G#00", CandumpFault::kId},
      {"(1.000000) can0 123", CandumpFault::kSeparator},
      {"(1.000000) can0 123#0", CandumpFault::kData},
      {"(1.000000) can0 123#0G", CandumpFault::kData},
      {"(1.000000) can0 123#G", CandumpFault::kData},
      {"(1.000000) can0 123#112233445566778899", CandumpFault::kData},
      {"(1.000000) can0 123#R9", CandumpFault::kData},
      {"(1.000000) can0 123#1122334455667788_8", CandumpFault::kData},
      {"(1.000000) can0 123##", CandumpFault::kFlags},
      {"(1.000000) can0 20000001##0", CandumpFault::kFlags},
      {"(1.000000) can0 123##0112233445566778899", CandumpFault::kData},
      {"(1.000000) can0 123##0" + std::string(130, 'A'), CandumpFault::kData},
      {"(1.000000) can0 123#00 x", CandumpFault::kTrailing},
      {"(1.000000) can0 123#00  R", CandumpFault::kTrailing},
      {std::string(193, '('), CandumpFault::kTooLong},
  };
  for (const auto& [line, fault] : lines) {
    EXPECT_EQ(fault_of(line), fault) << line << ": " << to_string(fault_of(line));
  }
}

CandumpEntry random_entry(Random& random) {
  static const std::array<std::uint8_t, 16> kLengths{0, 1,  2,  3,  4,  5,  6,  7,
                                                     8, 12, 16, 20, 24, 32, 48, 64};
  CandumpEntry entry;
  CanFrame& frame = entry.frame;
  const std::uint32_t kind = random.below(6);
  const std::int64_t seconds = random.next_u32();
  const std::int64_t microseconds = random.below(1'000'000);
  frame.stamp = {seconds * 1'000'000'000 + microseconds * 1000};
  entry.interface_name = kind % 2 == 0 ? "can0" : "abcdefghijklmno";
  frame.id = random.next_u32() & 0x7FFu;
  if (kind == 1 || kind == 4) {
    frame.flags |= CanFrame::kExtendedId;
    frame.id = random.next_u32() & 0x1FFFFFFFu;
  }
  if (kind == 2) frame.flags |= CanFrame::kErrorFrame;
  if (kind >= 4) frame.flags |= CanFrame::kFlexibleDataRate;
  if (kind == 5) frame.flags |= CanFrame::kBitRateSwitch;
  entry.remote = kind == 3;
  frame.size = kLengths[random.below(kind >= 4 ? 16 : 9)];
  for (std::size_t i = 0; i < frame.size && !entry.remote; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(random.next_u32());
  }
  return entry;
}

bool same(const CandumpEntry& a, const CandumpEntry& b) {
  return a.frame.stamp == b.frame.stamp && a.frame.id == b.frame.id &&
         a.frame.flags == b.frame.flags && a.frame.size == b.frame.size &&
         a.frame.data == b.frame.data && a.remote == b.remote &&
         a.interface_name == b.interface_name;
}

TEST(CandumpText, WhatIsWrittenIsReadBack) {
  Random random(1);
  for (int i = 0; i < 50'000; ++i) {
    const CandumpEntry entry = random_entry(random);
    const std::string line = text_of(entry);
    ASSERT_FALSE(line.empty());
    ASSERT_TRUE(same(entry_of(line), entry)) << line;
  }
}

TEST(CandumpText, WhatIsNotAFrameIsNotWritten) {
  CandumpEntry entry;
  EXPECT_EQ(text_of(entry), "");  // no name
  entry.interface_name = "can0";
  EXPECT_EQ(text_of(entry), "(0000000000.000000) can0 000#");
  entry.frame.stamp = {-1};
  EXPECT_EQ(text_of(entry), "(0000000000.000000) can0 000#");
  entry.frame.id = 0x800;
  EXPECT_EQ(text_of(entry), "");
  entry.frame.id = 1;
  entry.frame.size = 9;
  EXPECT_EQ(text_of(entry), "");
  entry.frame.flags = CanFrame::kFlexibleDataRate;
  EXPECT_EQ(text_of(entry), "");
  entry.frame.size = 65;
  EXPECT_EQ(text_of(entry), "");
  entry.frame.size = 12;
  EXPECT_NE(text_of(entry), "");
  entry.interface_name = "can 0";
  EXPECT_EQ(text_of(entry), "");
}

// Damaged lines never crash, and what is still accepted is a frame that writes and reads back.
TEST(CandumpText, MutatedLinesAreReadOrRefused) {
  Random random(2);
  constexpr std::string_view kAlphabet = "()#.R_ T0189AFafGz\r\n\t\0\xFF";
  int accepted = 0;
  for (int i = 0; i < 300'000; ++i) {
    std::string line = text_of(random_entry(random));
    const std::uint32_t mutations = 1 + random.below(4);
    for (std::uint32_t m = 0; m < mutations && !line.empty(); ++m) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(line.size()));
      const char c = kAlphabet[random.below(static_cast<std::uint32_t>(kAlphabet.size()))];
      switch (random.below(4)) {
        case 0: line[at] = c; break;
        case 1: line.insert(at, 1, c); break;
        case 2: line.erase(at, 1 + random.below(3)); break;
        default: line.resize(at); break;
      }
    }
    CandumpEntry entry;
    if (parse_candump_line(line, entry) != CandumpFault::kNone) continue;
    ++accepted;
    ASSERT_LE(entry.frame.size, entry.frame.data.size());
    const std::string again = text_of(entry);
    ASSERT_FALSE(again.empty()) << line;
    CandumpEntry expected = entry;
    expected.frame.stamp = {entry.frame.stamp.ns / 1000 * 1000};
    ASSERT_TRUE(same(entry_of(again), expected)) << line;
  }
  EXPECT_GT(accepted, 1000);  // or the loop proves little
}

TEST(CandumpReader, SkipsAndCountsWithLineNumbers) {
  std::istringstream in(
      "(1.000000) can0 123#00\n"
      "\n"
      "rubbish\n"
      "(2.000000) can9 123#00\n"
      "(3.000000) can2 123#R\n"
      "(0.500000) can2 123#0011\n" +
      std::string(5000, 'x') + "\n(4.000000) can1 123#0");
  CandumpReader reader(in);
  CanFrame frame;
  ASSERT_TRUE(ok(reader.next(frame)));
  EXPECT_EQ(frame.bus, 0);
  ASSERT_TRUE(ok(reader.next(frame)));
  EXPECT_EQ(frame.bus, 2);
  EXPECT_EQ(frame.size, 2);
  EXPECT_EQ(reader.next(frame), Status::kEndOfData);
  EXPECT_EQ(reader.next(frame), Status::kEndOfData);
  const CandumpCounters& c = reader.counters();
  EXPECT_EQ(c.lines, 8u);
  EXPECT_EQ(c.frames, 2u);
  EXPECT_EQ(c.blank, 1u);
  EXPECT_EQ(c.malformed, 3u);
  EXPECT_EQ(c.remote, 1u);
  EXPECT_EQ(c.other_interfaces, 1u);
  EXPECT_EQ(c.backward_steps, 1u);
  ASSERT_EQ(reader.issues().size(), 3u);
  EXPECT_EQ(reader.issues()[0].line, 3u);
  EXPECT_EQ(reader.issues()[0].fault, CandumpFault::kStamp);
  EXPECT_EQ(reader.issues()[1].line, 7u);
  EXPECT_EQ(reader.issues()[1].fault, CandumpFault::kTooLong);
  EXPECT_EQ(reader.issues()[2].line, 8u);
  EXPECT_EQ(reader.issues()[2].fault, CandumpFault::kData);
}

TEST(CandumpReader, KeepsABoundedListOfIssuesAndCountsAll) {
  std::istringstream in(std::string(2000, '\xFE') + std::string(3000, '\n') + [] {
    std::string rubbish;
    for (int i = 0; i < 500; ++i) rubbish += "(1.0) can0\n";
    return rubbish;
  }());
  CandumpReader reader(in);
  CanFrame frame;
  EXPECT_EQ(reader.next(frame), Status::kEndOfData);
  EXPECT_EQ(reader.counters().malformed, 501u);
  EXPECT_EQ(reader.issues().size(), CandumpReader::kMaxIssues);
}

// What the MANIFEST of the recordings says of them.
struct Capture {
  const char* name;
  const char* interface_name;
  std::uint64_t frames;
  std::size_t ids;
  double seconds;
};

// For the test's name in lists: the bytes of the struct would be different in every process.
void PrintTo(const Capture& capture, std::ostream* out) { *out << capture.name; }

class CandumpCaptures : public testing::TestWithParam<Capture> {};

TEST_P(CandumpCaptures, AreReadWholeAndWrittenBackByteForByte) {
  const std::string path = std::string(SUREFOOT_SHARED_DATA "/can/") + GetParam().name;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recording at " << path;
  std::ifstream in(path);
  const BusNames names{GetParam().interface_name, "", "", ""};
  CandumpReader reader(in, names);
  std::ifstream original(path);
  std::map<std::uint32_t, int> ids;
  CanFrame frame;
  TimeNs first;
  TimeNs last;
  while (ok(reader.next(frame))) {
    if (ids.empty()) first = frame.stamp;
    last = frame.stamp;
    ++ids[frame.id];
    CandumpEntry entry;
    entry.frame = frame;
    entry.interface_name = names[frame.bus];
    std::string line;
    ASSERT_TRUE(std::getline(original, line));
    ASSERT_EQ(text_of(entry), line);
  }
  EXPECT_EQ(reader.counters().frames, GetParam().frames);
  EXPECT_EQ(reader.counters().lines, GetParam().frames);
  EXPECT_EQ(reader.counters().malformed, 0u);
  EXPECT_EQ(reader.counters().backward_steps, 0u);
  EXPECT_EQ(ids.size(), GetParam().ids);
  EXPECT_NEAR((last - first).seconds(), GetParam().seconds, 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    Real, CandumpCaptures,
    testing::Values(Capture{"icsim_sample.log", "can0", 6158, 34, 3.26},
                    Capture{"veloz_amarillo.log", "vcan0", 11171, 75, 7.17},
                    Capture{"veloz_camera_off_connection.log", "can1", 568, 3, 16.04},
                    Capture{"ak80_6_pd_sysid_replies_DERIVED.log", "can0", 1170, 1, 3.90},
                    Capture{"ak80_6_energy_shaping_replies_DERIVED.log", "can0", 4000, 1, 20.00}),
    [](const testing::TestParamInfo<Capture>& capture) {
      std::string name = capture.param.name;
      std::replace(name.begin(), name.end(), '.', '_');
      return name;
    });

class TemporaryFile {
 public:
  explicit TemporaryFile(const char* name)
      : path_(testing::TempDir() + "surefoot_" + name + "_" + std::to_string(::getpid())) {}
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(FileCanLog, WritesWhatTheReaderReads) {
  const TemporaryFile file("can_log");
  std::vector<CanFrame> frames;
  {
    FileCanLog log(file.path());
    Random random(3);
    for (int i = 0; i < 20'000; ++i) {
      CandumpEntry entry = random_entry(random);
      if (entry.remote) continue;
      entry.frame.bus = static_cast<std::uint8_t>(random.below(4));
      frames.push_back(entry.frame);
      ASSERT_TRUE(ok(log.write(entry.frame, entry.frame.stamp)));
    }
    CanFrame bad;
    bad.bus = 4;
    EXPECT_EQ(log.write(bad, {}), Status::kInvalid);
    EXPECT_EQ(log.counters().frames, frames.size());
    EXPECT_EQ(log.counters().dropped, 1u);
    EXPECT_TRUE(ok(log.flush()));
  }
  std::ifstream in(file.path());
  CandumpReader reader(in);
  for (const CanFrame& expected : frames) {
    CanFrame frame;
    ASSERT_TRUE(ok(reader.next(frame)));
    ASSERT_EQ(frame.stamp, expected.stamp);
    ASSERT_EQ(frame.bus, expected.bus);
    ASSERT_EQ(frame.id, expected.id);
    ASSERT_EQ(frame.flags, expected.flags);
    ASSERT_EQ(frame.data, expected.data);
  }
  CanFrame frame;
  EXPECT_EQ(reader.next(frame), Status::kEndOfData);
}

TEST(FileCanLog, SaysWhyItCannotBeMade) {
  try {
    FileCanLog log("/nowhere/can.log");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/can.log: No such file"), std::string::npos);
  }
}

TEST(FileCanLog, AFullDiskIsReportedAndCounted) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  FileCanLog log("/dev/full");
  CanFrame frame;
  frame.size = 8;
  Status status = Status::kOk;
  for (int i = 0; i < 20'000 && ok(status); ++i) status = log.write(frame, {});
  EXPECT_EQ(status, Status::kUnavailable);
  EXPECT_EQ(log.write(frame, {}), Status::kUnavailable);
  EXPECT_GE(log.counters().dropped, 2u);
  EXPECT_EQ(log.flush(), Status::kUnavailable);
}

// A bus with one waiting frame, and a clock that stands still.
class OneFramePort final : public CanPort {
 private:
  std::size_t do_receive(std::span<CanFrame> out) override {
    if (delivered_ || out.empty()) return 0;
    delivered_ = true;
    out[0].stamp = milliseconds(5);
    out[0].id = 0x11;
    return 1;
  }
  Status do_send(const CanFrame& frame) override {
    return frame.id == 0x99 ? Status::kUnavailable : Status::kOk;
  }
  CanCounters do_counters() const override { return {.received = 7}; }
  bool delivered_ = false;
};
class StandingClock final : public Clock {
 private:
  TimeNs do_now() const override { return milliseconds(6); }
  Status do_wait_until(TimeNs) override { return Status::kEndOfData; }
};

TEST(LoggedCanPort, LogsBothDirectionsAndChangesNothing) {
  const TemporaryFile file("logged_port");
  OneFramePort bus;
  const StandingClock clock;
  {
    FileCanLog log(file.path());
    LoggedCanPort logged(bus, clock, log);
    CanPort& port = logged;
    std::array<CanFrame, 4> frames;
    EXPECT_EQ(port.receive(frames), 1u);
    CanFrame sent;
    sent.id = 0x22;
    sent.bus = 3;
    EXPECT_EQ(port.send(sent), Status::kOk);
    sent.id = 0x99;
    EXPECT_EQ(port.send(sent), Status::kUnavailable);
    EXPECT_EQ(port.counters().received, 7u);
  }
  std::ifstream in(file.path());
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str(),
            "(0000000000.005000) can0 011#\n"
            "(0000000000.006000) can3 022#\n");
}

}  // namespace
}  // namespace surefoot::hal
