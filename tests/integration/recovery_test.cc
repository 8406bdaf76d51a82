// Whole runs with a fall: from any pose, and on the way.
#include <gtest/gtest.h>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

nlohmann::json run(const Scratch& scratch, const std::string& arguments) {
  const ProgramResult result =
      run_program("surefoot run --robot mini_cheetah --world flat --report off --quiet --out " +
                  scratch.text("run") + " " + arguments);
  EXPECT_EQ(result.code, 0) << result.out << result.error;
  return read_json(scratch.path("run") / "summary.json");
}

TEST(Recovery, FromAnyPoseItStandsWithinFiveSecondsAndWalks) {
  const Scratch scratch;
  const nlohmann::json summary = run(scratch, "--mission upside_down --seed 4 --record off");
  EXPECT_EQ(summary["outcome"], "goal");
  EXPECT_EQ(summary["recovery"]["stood"], 1);
  EXPECT_LE(summary["recovery"]["time_to_stand_s"].get<double>(), 5.0);
  EXPECT_EQ(summary["falls"], 0);  // it was thrown, it did not fall
  EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
}

// The goal is a place of the world: to stand there it must know where it came to lie.
TEST(Recovery, ShovedOverOnItsWayItGetsUpAndArrives) {
  const Scratch scratch;
  const nlohmann::json summary = run(scratch, "--mission toppled --seed 9");
  EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
  EXPECT_GE(summary["falls"], 1);
  EXPECT_EQ(summary["recovery"]["count"], summary["recovery"]["stood"]);
  EXPECT_GE(summary["counters"]["pose_relocations"], 1);
  EXPECT_LE(summary["estimate"]["end_error_m"].get<double>(), 0.15);
  EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("run/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.error;
}

}  // namespace
}  // namespace surefoot
