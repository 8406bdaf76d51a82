// A body without legs finds its way through worlds it sees with its own scanner and camera: the
// whole path from scans to velocities, recorded and replayed.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

ProgramResult navigate(const std::string& world, const std::string& more, const Scratch& scratch) {
  return run_program(
      "surefoot run --robot mini_cheetah --mission forest --set plant=fast --quiet "
      "--world " +
      world + " " + more + " --out " + scratch.text("run"));
}

TEST(Navigation, GoesThroughAForestAndReplays) {
  const Scratch scratch;
  const ProgramResult result = navigate("forest:length=12", "--seed 4", scratch);
  ASSERT_EQ(result.code, 0) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
  EXPECT_EQ(summary["collisions"], 0);
  EXPECT_GE(summary["mean_speed_m_s"].get<double>(), 0.25);
  EXPECT_GE(summary["navigation"]["scans"], 400);
  EXPECT_GE(summary["navigation"]["plans"], 20);
  EXPECT_EQ(summary["navigation"]["scans_refused"], 0);
  EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
  EXPECT_EQ(summary["memory"]["page_faults_after_start"], 0);
  EXPECT_TRUE(std::filesystem::exists(scratch.path("run") / "navigation.png"));
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("run/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.error;
}

TEST(Navigation, SaysThatThereIsNoWayOut) {
  const Scratch scratch;
  const ProgramResult result = navigate("wall:enclosed=true", "--seed 2 --report off", scratch);
  EXPECT_EQ(result.code, 1) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "no_path") << summary["reason"];
  EXPECT_LE(summary["sim_time_s"].get<double>(), 60.0);
}

TEST(Navigation, StandsWhileItsScannerIsSilent) {
  const Scratch scratch;
  const ProgramResult result =
      navigate("forest:length=12",
               "--seed 4 --report off --record off --set mission.timeout_s=20 "
               "--set sim.faults.lidar_off_from_s=6 --set sim.faults.lidar_off_until_s=1000",
               scratch);
  EXPECT_EQ(result.code, 1) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "timeout") << summary["reason"];
  EXPECT_LE(summary["path_length_m"].get<double>(), 2.0);
}

TEST(Navigation, NeedsAScanner) {
  const Scratch scratch;
  const ProgramResult result =
      run_program("surefoot run --robot littledog --world flat --mission forest --quiet --out " +
                  scratch.text("run"));
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.error.find("navigation"), std::string::npos) << result.error;
}

}  // namespace
}  // namespace surefoot
