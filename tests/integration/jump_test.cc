// Whole runs that jump: one per height, one over a gap, one that has to refuse.
#include <gtest/gtest.h>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

struct JumpOutcome {
  int code = 0;
  nlohmann::json summary;
};

JumpOutcome jump(const Scratch& scratch, const std::string& world, const std::string& more) {
  const ProgramResult result =
      run_program("surefoot run --robot mini_cheetah --mission platform --seed 9 --quiet --world " +
                  world + " --out " + scratch.text("run") + " " + more);
  return {result.code, read_json(scratch.path("run") / "summary.json")};
}

class JumpRun : public testing::TestWithParam<const char*> {};

TEST_P(JumpRun, LandsOnFourFeetWithinTheMotorsLimitsAndWalksOn) {
  const Scratch scratch;
  const JumpOutcome run = jump(scratch, GetParam(), "--report off");
  EXPECT_EQ(run.code, 0) << run.summary["reason"];
  EXPECT_EQ(run.summary["outcome"], "goal");
  const nlohmann::json& figures = run.summary["jump"];
  EXPECT_EQ(figures["jumps"], 1);
  EXPECT_EQ(figures["landed_feet"], 4);
  EXPECT_LE(figures["max_torque_share"].get<double>(), 1.0);
  EXPECT_GT(figures["flight_s"].get<double>(), 0.2);
  EXPECT_EQ(run.summary["falls"], 0);
  EXPECT_EQ(run.summary["memory"]["heap_calls_after_start"], 0);
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("run/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.error;
}

INSTANTIATE_TEST_SUITE_P(Worlds, JumpRun,
                         testing::Values("platform:height=0.13", "platform:height=0.25",
                                         "gap:length=0.2"));

TEST(JumpRefusal, AWallIsTheEndOfTheWayAndTheReasonIsNamed) {
  const Scratch scratch;
  const JumpOutcome run = jump(scratch, "platform:height=0.4", "--record off --report off");
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(run.summary["outcome"], "no_path");
  EXPECT_EQ(run.summary["jump"]["jumps"], 0);
  EXPECT_EQ(run.summary["jump"]["last_refusal"], "no_motion");
  EXPECT_EQ(run.summary["falls"], 0);
}

}  // namespace
}  // namespace surefoot
