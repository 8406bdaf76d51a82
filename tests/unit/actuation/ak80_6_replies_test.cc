// Replies of a real AK80-6 (data/can/MANIFEST): the frames decode to the values its driver logged.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/actuation/motor_protocol.h"

namespace surefoot::actuation {
namespace {

constexpr WireRanges kAk80_6{95.5, 45.0, 500.0, 5.0, 18.0};

struct Row {
  double position_rad;
  double velocity_rad_s;
  double torque_Nm;
};

std::vector<Row> read_measured(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "time,position,velocity,torque");
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    double value[4] = {};
    char comma = 0;
    fields >> value[0] >> comma >> value[1] >> comma >> value[2] >> comma >> value[3];
    EXPECT_FALSE(fields.fail()) << line;
    rows.push_back({value[1], value[2], value[3]});
  }
  return rows;
}

// The bytes after '#': this test does not depend on the log reader it does not test.
std::vector<std::vector<std::uint8_t>> read_payloads(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::vector<std::vector<std::uint8_t>> payloads;
  while (std::getline(file, line)) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = line.find('#') + 1; i + 1 < line.size(); i += 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(line.substr(i, 2), nullptr, 16)));
    }
    payloads.push_back(bytes);
  }
  return payloads;
}

class Ak80_6Replies : public testing::TestWithParam<const char*> {};

TEST_P(Ak80_6Replies, DecodeToTheLoggedValuesAndEncodeToTheSameBytes) {
  const std::string folder = SUREFOOT_SHARED_DATA "/can/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  const std::string name = folder + "ak80_6_" + GetParam();
  const std::vector<Row> rows = read_measured(name + "_measured.csv");
  const auto payloads = read_payloads(name + "_replies_DERIVED.log");
  ASSERT_GT(rows.size(), 1000u);
  ASSERT_EQ(rows.size(), payloads.size());
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Result<Reply> reply = decode_reply(kAk80_6, payloads[i]);
    ASSERT_TRUE(reply.ok()) << i;
    EXPECT_EQ(reply.value().drive_id, 1);
    worst = std::max(worst, std::fabs(reply.value().position_rad - rows[i].position_rad));
    worst = std::max(worst, std::fabs(reply.value().velocity_rad_s - rows[i].velocity_rad_s));
    worst = std::max(worst, std::fabs(reply.value().torque_Nm - rows[i].torque_Nm));
    // And the simulated drive would have sent these very bytes.
    const Result<ReplyBytes> again =
        encode_reply(kAk80_6, {1, rows[i].position_rad, rows[i].velocity_rad_s, rows[i].torque_Nm});
    ASSERT_TRUE(again.ok());
    ASSERT_TRUE(std::equal(payloads[i].begin(), payloads[i].end(), again.value().bytes().begin(),
                           again.value().bytes().end()))
        << i;
  }
  RecordProperty("worst_difference", std::to_string(worst));
  EXPECT_LT(worst, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Runs, Ak80_6Replies, testing::Values("pd_sysid", "energy_shaping"));

}  // namespace
}  // namespace surefoot::actuation
