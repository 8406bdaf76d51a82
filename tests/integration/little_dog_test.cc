// A LittleDog crosses low blocks one leg at a time and sees them through its stereo pair only: the
// whole path with another robot's file.
#include <gtest/gtest.h>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

TEST(LittleDog, CrossesLowBlocksOneLegAtATimeAndReplays) {
  const Scratch scratch;
  const ProgramResult result = run_program(
      "surefoot run --robot littledog --world clutter:height=0.03 --mission cross --seed 3 "
      "--set mission.speed_m_s=0.08 --set mission.goal_x_m=1.0 --set mission.timeout_s=60 "
      "--report off --quiet --out " +
      scratch.text("run"));
  ASSERT_EQ(result.code, 0) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
  EXPECT_EQ(summary["falls"], 0);
  EXPECT_GE(summary["mean_speed_m_s"].get<double>(), 0.04);
  EXPECT_GE(summary["counters"]["static_steps"], 30);
  EXPECT_GE(summary["stereo"]["pairs_matched"], 30);
  EXPECT_LE(summary["stereo"]["pairs_unusable"], 2);
  EXPECT_GE(summary["stereo"]["valid_share"].get<double>(), 0.6);
  EXPECT_LE(summary["map"]["median_m"].get<double>(), 0.003);
  EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
  EXPECT_EQ(summary["memory"]["page_faults_after_start"], 0);
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("run/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.error;
}

// The README's board of slabs, on two of its twenty seeds.
TEST(LittleDog, CrossesABoardOfSlabs) {
  for (const char* seed : {"2", "5"}) {
    const Scratch scratch;
    const ProgramResult result = run_program(
        "surefoot run --robot littledog --world rocks:flat --mission cross --record off "
        "--report off --quiet --seed " +
        std::string(seed) + " --out " + scratch.text("run"));
    ASSERT_EQ(result.code, 0) << result.out << result.error;
    const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
    EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
    EXPECT_GE(summary["mean_speed_m_s"].get<double>(), 0.05);
    EXPECT_LE(summary["map"]["rmse_m"].get<double>(), 0.003);
    EXPECT_GE(summary["localisation"]["registered"], 80);
    EXPECT_GE(summary["fill"]["maps"], 80);
    EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
    EXPECT_EQ(summary["memory"]["page_faults_after_start"], 0);
  }
}

}  // namespace
}  // namespace surefoot
