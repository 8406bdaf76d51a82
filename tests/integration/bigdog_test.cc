// A machine of 109 kg: the same software, another robot's file.
#include <gtest/gtest.h>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

TEST(BigDog, TrotsOnFlatGround) {
  const Scratch scratch;
  const ProgramResult result = run_program(
      "surefoot run --robot bigdog --world flat --mission cross --seed 1 --quiet "
      "--record off --report off --out " +
      scratch.text("run"));
  ASSERT_EQ(result.code, 0) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
  EXPECT_EQ(summary["falls"], 0);
  EXPECT_GE(summary["path_length_m"].get<double>(), 2.8);
  EXPECT_GE(summary["mean_speed_m_s"].get<double>(), 0.4);
  EXPECT_LE(summary["estimate"]["end_error_m"].get<double>(), 0.06);
  EXPECT_EQ(summary["memory"]["heap_calls_after_start"], 0);
}

TEST(BigDog, GoesThroughAForestWithoutLegs) {
  const Scratch scratch;
  const ProgramResult result = run_program(
      "surefoot run --robot bigdog --world forest:length=12 --mission forest "
      "--set plant=fast --seed 4 --quiet --record off --report off --out " +
      scratch.text("run"));
  ASSERT_EQ(result.code, 0) << result.out << result.error;
  const nlohmann::json summary = read_json(scratch.path("run") / "summary.json");
  EXPECT_EQ(summary["outcome"], "goal") << summary["reason"];
  EXPECT_EQ(summary["collisions"], 0);
  EXPECT_GE(summary["mean_speed_m_s"].get<double>(), 0.4);
  EXPECT_EQ(summary["navigation"]["scans_refused"], 0);
}

}  // namespace
}  // namespace surefoot
