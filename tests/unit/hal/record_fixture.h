// Small records and ways to spoil them.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "hal/record/record_layout.h"
#include "hal/record/record_reader.h"
#include "hal/record/record_writer.h"

namespace surefoot::testing {

using Bytes = std::vector<std::uint8_t>;

// A folder that is gone after the test.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = std::filesystem::temp_directory_path() / "surefoot_test_XXXXXX";
    const char* made = ::mkdtemp(pattern.data());
    EXPECT_NE(made, nullptr);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

inline Bytes load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void save(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

inline hal::RecordLayout small_layout() {
  return {
      {hal::RecordChannel::kConfiguration, "/configuration", "x-text", "", "", ""},
      {hal::RecordChannel::kTick, "/tick", "x-test", "test.Tick", "x-test", "value uint64\n"},
      {hal::RecordChannel::kDepth, "/depth", "x-test", "test.Depth", "x-test", "pixels\n"},
  };
}

struct ReadMessage {
  hal::RecordChannel channel;
  std::int64_t stamp_ns;
  std::uint32_t sequence;
  std::uint64_t chunk;
  Bytes bytes;
  bool operator==(const ReadMessage&) const = default;
};

struct ReadResult {
  Status opened = Status::kOk;
  std::vector<ReadMessage> before;  // up to the first damage
  std::vector<ReadMessage> after;   // what could be read beyond it
  std::vector<hal::RecordDamage> damages;
};

inline ReadResult read_all(const std::string& path) {
  ReadResult result;
  hal::RecordReader reader;
  result.opened = reader.open(path);
  if (!ok(result.opened)) {
    result.damages.push_back(reader.damage());
    return result;
  }
  hal::RecordMessage message;
  while (true) {
    const Status status = reader.next(message);
    if (status == Status::kEndOfData) break;
    if (status == Status::kCorrupt) {
      result.damages.push_back(reader.damage());
      if (result.damages.size() > 1000) break;  // a reader that never ends fails the test
      continue;
    }
    auto& list = result.damages.empty() ? result.before : result.after;
    list.push_back({message.channel,
                    message.stamp.ns,
                    message.sequence,
                    message.chunk,
                    {message.bytes.begin(), message.bytes.end()}});
  }
  return result;
}

}  // namespace surefoot::testing
