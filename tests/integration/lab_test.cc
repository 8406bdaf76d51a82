// Campaigns and exports.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

namespace fs = std::filesystem;

const std::string kStand =
    " --robot mini_cheetah --world flat --mission stand --set mission.stand_s=0.1 ";

TEST(Lab, CampaignCountsAndKeepsTheRecordsOfFailures) {
  const Scratch scratch;
  const ProgramResult good = run_program("surefoot-lab campaign" + kStand +
                                         "--seeds 3..4 --jobs 2 --out " + scratch.text("good"));
  ASSERT_EQ(good.code, 0) << good.error;
  const nlohmann::json json = read_json(scratch.path("good") / "campaign.json");
  ASSERT_EQ(json["runs"].size(), 2u);
  EXPECT_EQ(json["runs"][0]["seed"], 3);
  EXPECT_EQ(json["runs"][1]["seed"], 4);
  EXPECT_EQ(json["outcomes"]["goal"], 2);
  EXPECT_EQ(json["success_rate"], 1.0);
  EXPECT_NEAR(json["wilson95"][0].get<double>(), 0.342, 0.001);
  EXPECT_FALSE(fs::exists(scratch.path("good") / "seed-3" / "record.mcap"));

  const ProgramResult bad =
      run_program("surefoot-lab campaign" + kStand +
                  "--set mission.timeout_s=1 --seeds 1..1 --out " + scratch.text("bad"));
  ASSERT_EQ(bad.code, 0) << bad.error;
  const nlohmann::json failed = read_json(scratch.path("bad") / "campaign.json");
  EXPECT_EQ(failed["outcomes"]["timeout"], 1);
  EXPECT_EQ(failed["success_rate"], 0.0);
  EXPECT_TRUE(fs::exists(scratch.path("bad") / "seed-1" / "record.mcap"));
}

TEST(Lab, RegistrationOfBoardsIsMeasuredFromBothStarts) {
  const Scratch scratch;
  const ProgramResult result =
      run_program("surefoot-lab eval registration --seeds 1..3 --out " + scratch.text("boards"));
  ASSERT_EQ(result.code, 0) << result.error;
  const nlohmann::json json = read_json(scratch.path("boards") / "registration.json");
  for (const char* start : {"near", "far"}) {
    EXPECT_EQ(json["starts"][start]["runs"], 3);
    EXPECT_EQ(json["starts"][start]["failed"], 0);
    EXPECT_LT(json["starts"][start]["worst_error_m"].get<double>(), 0.005);
  }
  EXPECT_TRUE(fs::exists(scratch.path("boards") / "registration.png"));
  EXPECT_EQ(run_program("surefoot-lab eval registration --seeds 3..1").code, 2);
  EXPECT_EQ(run_program("surefoot-lab eval registration --points 1").code, 2);
}

// Few rocks and large cells: what is written, and that it is the same again with other threads.
TEST(Lab, FillsOfUnseenRocksAreCompared) {
  const Scratch scratch;
  const std::string command =
      "surefoot-lab eval terrain-fill --library-seeds 1..2 --test-seeds 3..4 --bodies 40 "
      "--resolution 0.02 --cache " +
      scratch.text("rocks");
  std::vector<nlohmann::json> results;
  for (const std::string jobs : {"2", "1"}) {
    const ProgramResult result =
        run_program(command + " --jobs " + jobs + " --out " + scratch.text(jobs.c_str()));
    ASSERT_EQ(result.code, 0) << result.error;
    results.push_back(read_json(scratch.path(jobs.c_str()) / "terrain-fill.json"));
    EXPECT_TRUE(fs::exists(scratch.path(jobs.c_str()) / "terrain.png"));
    EXPECT_TRUE(fs::exists(scratch.path(jobs.c_str()) / "fills.png"));
  }
  const nlohmann::json& json = results[0];
  EXPECT_EQ(json["resolution_m"], 0.02);
  for (const char* method : {"paper_literal", "paper", "improved", "ignore_missing",
                             "constraints_as_heights", "unconstrained", "best_constant",
                             "clipped_inpainting", "minimum_spread", "smoothed_minimum_spread"}) {
    const nlohmann::json& of = json["methods"][method];
    EXPECT_GT(of["cost_rmse_visible"].get<double>(), 0) << method;
    EXPECT_EQ(of["cost_rmse_occluded"].is_null(), std::string(method) == "ignore_missing");
    EXPECT_EQ(of["height_rmse_occluded_m"].is_null(), std::string(method) == "ignore_missing");
    EXPECT_TRUE(of["us_per_cell"].is_number());
    for (nlohmann::json& result : results) result["methods"][method].erase("us_per_cell");
  }
  for (const char* method :
       {"paper", "improved", "constraints_as_heights", "minimum_spread", "clipped_inpainting"}) {
    EXPECT_EQ(json["methods"][method]["sight_violations"], 0) << method;
  }
  EXPECT_GT(json["methods"]["unconstrained"]["sight_violations"], 0);
  EXPECT_GT(json["p_value"].get<double>(), 0);
  EXPECT_LE(json["p_value"].get<double>(), 1);
  EXPECT_EQ(json["cells"]["truth_above_ceiling_share"], 0.0);
  EXPECT_EQ(results[0], results[1]);

  EXPECT_EQ(run_program("surefoot-lab eval terrain-fill --library-seeds 3..1").code, 2);
  EXPECT_EQ(run_program("surefoot-lab eval terrain-fill --resolution 0.0123").code, 2);
  EXPECT_EQ(run_program("surefoot-lab eval terrain-fill --terrain nowhere.asc").code, 2);
}

// Three levels: ground, a ledge of one step too many, a wall; and a corner without data.
fs::path write_ledges(const fs::path& file, double cell_m) {
  std::ofstream grid(file);
  grid << "ncols 60\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize " << cell_m
       << "\nNODATA_value -9999\n";
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 60; ++column) {
      const bool missing = row < 10 && column < 10;
      grid << (missing ? -9999.0 : column < 20 ? 0.0 : column < 40 ? 0.2 : 0.8) << ' ';
    }
    grid << '\n';
  }
  return file;
}

TEST(Lab, TraversabilityOfAGridCountsTheSeamsOfItsLedges) {
  const Scratch scratch;
  const fs::path file = write_ledges(scratch.path("ledges.asc"), 0.02);
  const ProgramResult result =
      run_program("surefoot-lab eval traversability " + file.string() +
                  " --robot mini_cheetah --scale 0.75 --out " + scratch.text("eval"));
  ASSERT_EQ(result.code, 0) << result.error;
  const nlohmann::json json = read_json(scratch.path("eval") / "traversability.json");
  EXPECT_NEAR(json["cell_m"].get<double>(), 0.015, 1e-12);
  EXPECT_EQ(json["cells"], 2400);
  EXPECT_EQ(json["known"], 2300);
  // A ledge of 0.15 m and a wall of 0.45 m, each with two cells of seam above and two below. Of the
  // outermost row too little is known: 6 of its patch of 17 lie outside.
  EXPECT_EQ(json["classes"]["jump_only"]["cells"], 4 * 38);
  EXPECT_EQ(json["classes"]["impassable"]["cells"], 4 * 38);
  EXPECT_EQ(json["classes"]["unsteppable"]["cells"], 0);
  EXPECT_GT(json["classes"]["steppable"]["cells"], 38 * 58 - 2 * 4 * 38 - 11 * 11);
  EXPECT_TRUE(fs::exists(scratch.path("eval") / "traversability.png"));
}

TEST(Lab, TraversabilityRefusesWhatItCannotClassify) {
  const Scratch scratch;
  const std::string robot = " --robot mini_cheetah --out " + scratch.text("eval");
  const ProgramResult absent =
      run_program("surefoot-lab eval traversability /nonexistent/a.asc" + robot);
  EXPECT_EQ(absent.code, 2);
  EXPECT_NE(absent.error.find("/nonexistent/a.asc"), std::string::npos) << absent.error;
  const fs::path file = write_ledges(scratch.path("ledges.asc"), 0.02);
  const ProgramResult coarse =
      run_program("surefoot-lab eval traversability " + file.string() + " --scale 20" + robot);
  EXPECT_EQ(coarse.code, 2);
  EXPECT_NE(coarse.error.find("cells of 0.4 m"), std::string::npos) << coarse.error;
}

TEST(Lab, ExportedCanLogEqualsTheOneOfTheRun) {
  const Scratch scratch;
  ASSERT_EQ(run_program("surefoot run" + kStand + "--can-log --report off --quiet --out " +
                        scratch.text("run"))
                .code,
            0);
  const std::string record = scratch.text("run/record.mcap");
  for (const char* format : {"candump", "csv", "html"}) {
    const ProgramResult result = run_program("surefoot-lab export " + record + " --to " + format +
                                             " --out " + scratch.text("export"));
    EXPECT_EQ(result.code, 0) << format << result.error;
  }
  const auto text = [](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(in)), {});
  };
  const std::string log = text(scratch.path("run") / "can.log");
  EXPECT_GT(log.size(), 100000u);
  EXPECT_EQ(log, text(scratch.path("export") / "can.log"));
  EXPECT_TRUE(fs::exists(scratch.path("export") / "report.html"));

  std::ifstream csv(scratch.path("export") / "ticks.csv");
  std::string head;
  std::string row;
  std::getline(csv, head);
  std::getline(csv, row);
  EXPECT_EQ(head.rfind("tick,time_s,phase,stop_reason,p_OB_m.0,p_OB_m.1,", 0), 0u) << head;
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(row.begin(), row.end(), ','));
}

}  // namespace
}  // namespace surefoot
