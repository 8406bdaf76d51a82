// Whole runs in the simulator: summary, repeatability, replay, memory, faults.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

namespace fs = std::filesystem;

std::string walk(const Scratch& scratch, const std::string& out, const std::string& more = "") {
  return "surefoot run --robot mini_cheetah --world flat --mission cross "
         "--set mission.goal_x_m=0.8 --seed 5 --quiet --out " +
         scratch.text(out) + " " + more;
}

TEST(Run, ShortWalkIsRepeatableReplayableAndLeavesTheHeapAlone) {
  const Scratch scratch;
  const ProgramResult first = run_program(walk(scratch, "a"));
  ASSERT_EQ(first.code, 0) << first.error;
  const nlohmann::json a = read_json(scratch.path("a") / "summary.json");
  ASSERT_FALSE(a.is_discarded());
  EXPECT_EQ(a["outcome"], "goal");
  EXPECT_EQ(a["memory"]["heap_calls_after_start"], 0);
  EXPECT_EQ(a["memory"]["page_faults_after_start"], 0);
  EXPECT_GT(a["memory"]["static_bytes"].get<long>(), 1000000);
  EXPECT_GT(a["mean_speed_m_s"].get<double>(), 0.1);
  EXPECT_LT(a["estimate"]["end_error_m"].get<double>(), 0.2);
  EXPECT_EQ(a["falls"], 0);

  ASSERT_EQ(run_program(walk(scratch, "b", "--record off --report off")).code, 0);
  const nlohmann::json b = read_json(scratch.path("b") / "summary.json");
  EXPECT_EQ(a["hash"], b["hash"]);
  EXPECT_EQ(a["ticks"], b["ticks"]);
  EXPECT_EQ(a["config_hash"], b["config_hash"]);
  EXPECT_FALSE(fs::exists(scratch.path("b") / "record.mcap"));
  EXPECT_FALSE(fs::exists(scratch.path("b") / "report.html"));

  const ProgramResult replay = run_program("surefoot replay " + scratch.text("a/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.error;
  EXPECT_EQ(replay.out, "identical, " + std::to_string(a["ticks"].get<long>()) + " ticks, hash " +
                            a["hash"].get<std::string>() + "\n");
}

TEST(Run, SummaryHasEveryFieldOfTheContractAndPicturesAreThere) {
  const Scratch scratch;
  const ProgramResult result = run_program(
      "surefoot run --robot mini_cheetah --world flat --mission stand --set mission.stand_s=0.2 "
      "--quiet --out " +
      scratch.text("out"));
  ASSERT_EQ(result.code, 0) << result.error;
  const nlohmann::json summary = read_json(scratch.path("out") / "summary.json");
  ASSERT_FALSE(summary.is_discarded());
  for (const char* key : {"/schema",
                          "/robot",
                          "/world",
                          "/mission",
                          "/hal",
                          "/seed",
                          "/config_hash",
                          "/version",
                          "/outcome",
                          "/reason",
                          "/sim_time_s",
                          "/wall_time_s",
                          "/real_time_factor",
                          "/start_to_goal_m",
                          "/path_length_m",
                          "/mean_speed_m_s",
                          "/collisions",
                          "/falls",
                          "/foot_slips",
                          "/terrain/max_step_m",
                          "/terrain/rms_m",
                          "/estimate/end_error_m",
                          "/estimate/drift_percent",
                          "/estimate/rms_error_m",
                          "/map/rmse_m",
                          "/map/known_fraction",
                          "/memory/static_bytes",
                          "/memory/heap_calls_after_start",
                          "/memory/page_faults_after_start",
                          "/tasks/0/name",
                          "/tasks/0/period_us",
                          "/tasks/0/budget_us",
                          "/tasks/0/count",
                          "/tasks/0/p50_us",
                          "/tasks/0/p99_us",
                          "/tasks/0/max_us",
                          "/tasks/0/overruns",
                          "/ticks",
                          "/hash"}) {
    EXPECT_TRUE(summary.contains(nlohmann::json::json_pointer(key))) << key;
  }
  EXPECT_EQ(summary["schema"], 1);
  EXPECT_EQ(summary["hash"].get<std::string>().size(), 16u);
  for (const char* file : {"report.html", "terrain.png", "motion.png", "torques.png", "gait.png",
                           "timing.png", "record.mcap"}) {
    EXPECT_GT(fs::file_size(scratch.path("out") / file), 1000u) << file;
  }
  std::ifstream report(scratch.path("out") / "report.html");
  const std::string html((std::istreambuf_iterator<char>(report)), {});
  // Self-contained: no link leads anywhere.
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
  EXPECT_EQ(html.find("href=\"http"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
}

TEST(Run, ASilentDriveIsAFaultAndExitsWithThree) {
  const Scratch scratch;
  const ProgramResult result = run_program(walk(scratch, "out",
                                                "--report off --set sim.faults.silent_joint=4 "
                                                "--set sim.faults.silent_from_s=4.5"));
  EXPECT_EQ(result.code, 3) << result.error;
  const nlohmann::json summary = read_json(scratch.path("out") / "summary.json");
  EXPECT_EQ(summary["outcome"], "fault");
  EXPECT_EQ(summary["reason"], "a drive stopped answering");
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("out/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out;
}

TEST(Run, WalksThroughAnOutageOfTheTrackingCameraAndReplays) {
  const Scratch scratch;
  const ProgramResult result = run_program(walk(
      scratch, "out",
      "--report off --set sim.faults.pose_off_from_s=5.5 --set sim.faults.pose_off_until_s=6.5 "
      "--set sim.tracking.jump_interval_s=0.5 --set sim.tracking.jump_m=0.1"));
  EXPECT_EQ(result.code, 0) << result.error;
  const nlohmann::json counters = read_json(scratch.path("out") / "summary.json")["counters"];
  EXPECT_GT(counters["pose_used"].get<int>(), 100);
  EXPECT_GT(counters["pose_low_confidence"].get<int>(), 50);
  EXPECT_GT(counters["pose_without_stamp"].get<int>(), 100);  // before O has its place
  EXPECT_GT(counters["pose_jumps"].get<int>(), 2);
  EXPECT_EQ(counters["pose_refused"], 0);
  EXPECT_EQ(counters["pose_dropped"], 0);
  const ProgramResult replay = run_program("surefoot replay " + scratch.text("out/record.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.out;
}

TEST(Run, TimeOutExitsWithOne) {
  const Scratch scratch;
  const ProgramResult result =
      run_program(walk(scratch, "out", "--record off --report off --set mission.timeout_s=2"));
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(read_json(scratch.path("out") / "summary.json")["outcome"], "timeout");
}

TEST(Run, ACutRecordReplaysUpToTheDamage) {
  const Scratch scratch;
  run_program(walk(scratch, "out", "--report off --set mission.timeout_s=5"));
  const fs::path record = scratch.path("out") / "record.mcap";
  ASSERT_TRUE(fs::exists(record));
  fs::resize_file(record, fs::file_size(record) * 7 / 10);
  const ProgramResult replay = run_program("surefoot replay " + record.string());
  EXPECT_EQ(replay.code, 1);
  EXPECT_EQ(replay.out.rfind("identical, ", 0), 0u) << replay.out;
  EXPECT_NE(replay.out.find("byte"), std::string::npos) << replay.out;
}

TEST(Run, ScannedBouldersAreCrossedOrEndWithAReason) {
  const std::string scan = SUREFOOT_SHARED_DATA "/terrain/otira_rocks_a_2cm.asc";
  if (!fs::exists(scan)) GTEST_SKIP() << scan << " is not here";
  const Scratch scratch;
  const ProgramResult result = run_program(
      "surefoot run --robot mini_cheetah --world 'heightmap:" + scan +
      ",scale=0.1' --mission cross --set mission.goal_x_m=2 --quiet --record off --report off "
      "--out " +
      scratch.text("out"));
  EXPECT_TRUE(result.code == 0 || result.code == 1) << result.error;
  const nlohmann::json summary = read_json(scratch.path("out") / "summary.json");
  ASSERT_FALSE(summary.is_discarded());
  EXPECT_FALSE(summary["reason"].get<std::string>().empty());
  EXPECT_GT(summary["terrain"]["max_step_m"].get<double>(), 0.0);
}

}  // namespace
}  // namespace surefoot
