// The terrain model that a robot's file names: put in its place, and what can be wrong with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "apps/common/config_root.h"
#include "tests/support/config_file.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;
using tests::replaced;

const fs::path kFolder = tests::config_folder();

class TerrainModelFile : public testing::Test {
 protected:
  // Issues of LittleDog's file with this name of a model.
  ConfigIssues issues_of(const std::string& name) {
    RunRequest request;
    request.robot = "littledog";
    request.sets = {"terrain.model=" + name};
    ConfigIssues issues;
    config_ = load_config_parts(request, kFolder, issues);
    return issues;
  }
  // With `from` of the model's own file replaced.
  ConfigIssues edited(const std::string& from, const std::string& to) {
    return issues_of(folder_.write("rocks.yaml", replaced(good_, from, to)).string());
  }
  int line_of(const std::string& text) const {
    const auto at = static_cast<std::ptrdiff_t>(good_.find(text));
    return 1 + static_cast<int>(std::count(good_.begin(), good_.begin() + at, '\n'));
  }

  const std::string good_ = tests::text_of(kFolder / "terrain/rocks_1cm.yaml");
  Config config_;

 private:
  tests::ScratchFolder folder_;
};

TEST_F(TerrainModelFile, TakesTheNamesPlace) {
  ASSERT_EQ(to_string(issues_of("../terrain/rocks_1cm.yaml")), "");
  const terrain::TerrainModel& model = config_.autonomy.terrain.model;
  EXPECT_TRUE(config_.autonomy.terrain.present);
  EXPECT_EQ(model.cell_m, config_.autonomy.mapping.cell_size_m);
  EXPECT_EQ(model.rows.size(), terrain::kModelRows);
  EXPECT_EQ(model.rows[0].heights_m[15], 0.0140);
  EXPECT_LT(model.prior_constant, 0.0);
}

TEST_F(TerrainModelFile, OneThatDoesNotExistIsOneIssue) {
  const ConfigIssues issues = issues_of("nowhere.yaml");
  ASSERT_EQ(issues.size(), 1U) << to_string(issues);
  EXPECT_EQ(issues[0].key, "terrain.model");
  EXPECT_EQ(issues[0].message.rfind("'nowhere.yaml' is no terrain model: ", 0), 0U);
  EXPECT_NE(issues[0].message.find("config/robots/nowhere.yaml does not exist"), std::string::npos);
  EXPECT_EQ(issues_of("''").size(), 1U);
}

TEST_F(TerrainModelFile, AWrongNumberIsReportedWithItsLine) {
  const ConfigIssues issues = edited("prior_constant: -", "prior_constant: 1e9  # ");
  ASSERT_EQ(issues.size(), 1U) << to_string(issues);
  EXPECT_EQ(fs::path(issues[0].place.source).filename(), "rocks.yaml");
  EXPECT_EQ(issues[0].place.line, line_of("prior_constant"));
  EXPECT_EQ(issues[0].key, "terrain.model.prior_constant");
  EXPECT_NE(issues[0].message.find("out of range"), std::string::npos) << issues[0].message;
}

TEST_F(TerrainModelFile, WhatIsMissingOrTooMuchIsReportedInItsFile) {
  const struct {
    std::string from;
    std::string to;
    std::string message;
  } cases[] = {
      {"prior_constant", "prior_konstant", "terrain.model.prior_constant: missing"},
      {"heights_m: [0.0000, ", "heights_m: [", "terrain.model.rows.0.heights_m"},
      {"heights_m: [0.0000, ", "heights_m: [nan, ", "terrain.model.rows.0.heights_m"},
      {"rows:\n", "rows:\n  - heights_m: [0.0]\n", "terrain.model.rows"},
      {"cell_m: 0.01", "cell_m: [", "not valid YAML"},
  };
  for (const auto& c : cases) {
    const std::string text = to_string(edited(c.from, c.to));
    EXPECT_NE(text.find(c.message), std::string::npos) << c.from << ": " << text;
    EXPECT_NE(text.find("rocks.yaml"), std::string::npos) << text;
  }
}

TEST_F(TerrainModelFile, TheRecordHoldsItsNumbers) {
  ASSERT_EQ(to_string(issues_of("../terrain/rocks_1cm.yaml")), "");
  RunRequest request;
  ConfigIssues issues;
  Config again;
  read_record_text(record_text(request, config_), request, again, issues);
  EXPECT_EQ(config_text(again), config_text(config_));
  const terrain::TerrainModel& model = again.autonomy.terrain.model;
  ASSERT_EQ(model.rows.size(), config_.autonomy.terrain.model.rows.size());
  EXPECT_EQ(model.rows[99].heights_m, config_.autonomy.terrain.model.rows[99].heights_m);
  EXPECT_EQ(model.prior_heights, config_.autonomy.terrain.model.prior_heights);
}

TEST_F(TerrainModelFile, ARobotWithoutOneKeepsItsText) {
  RunRequest request;
  request.robot = "mini_cheetah";
  ConfigIssues issues;
  const Config config = load_config_parts(request, kFolder, issues);
  EXPECT_FALSE(config.autonomy.terrain.present);
  EXPECT_EQ(config_text(config).find("terrain.model"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::apps
