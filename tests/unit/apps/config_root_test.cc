// Names to files, world parameters, and the files under config/ themselves.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "apps/common/config_root.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(SUREFOOT_SOURCE_DIR) / "config";

RunRequest cross(const std::string& world = "flat") {
  RunRequest request;
  request.robot = "mini_cheetah";
  request.world = world;
  request.mission = "cross";
  return request;
}

Config loaded(const RunRequest& request) {
  ConfigIssues issues;
  Config config = load_config(request, kFolder, issues);
  EXPECT_EQ(to_string(issues), "");
  return config;
}

std::string issues_of(const RunRequest& request) {
  ConfigIssues issues;
  load_config(request, kFolder, issues);
  return to_string(issues);
}

std::vector<std::string> names(const char* kind) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(kFolder / kind)) {
    if (entry.path().extension() == ".yaml") found.push_back(entry.path().stem().string());
  }
  return found;
}

TEST(ConfigFiles, EveryFileLoads) {
  for (const std::string& robot : names("robots")) {
    RunRequest request;
    request.robot = robot;
    ConfigIssues issues;
    load_config_parts(request, kFolder, issues);
    EXPECT_EQ(to_string(issues), "");
  }
  EXPECT_GE(names("worlds").size(), 5u);
  for (const std::string& world : names("worlds")) EXPECT_EQ(issues_of(cross(world)), "");
  EXPECT_GE(names("missions").size(), 2u);
  for (const std::string& mission : names("missions")) {
    RunRequest request = cross();
    request.mission = mission;
    EXPECT_EQ(issues_of(request), "");
  }
}

TEST(ConfigRoot, WorldParametersByShortName) {
  const Config config = loaded(cross("clutter:height=0.07,cover=0.3,friction=0.4"));
  EXPECT_EQ(config.world.generator, sim::Generator::kClutter);
  EXPECT_EQ(config.world.height_m, 0.07);
  EXPECT_EQ(config.world.cover, 0.3);
  EXPECT_EQ(config.world.friction, 0.4);
}

TEST(ConfigRoot, HeightMapTakesAFileAndAScale) {
  const Config config = loaded(cross("heightmap:../a b/rocks.asc,scale=0.1"));
  EXPECT_EQ(config.world.generator, sim::Generator::kHeightMap);
  EXPECT_EQ(config.world.file, "../a b/rocks.asc");
  EXPECT_EQ(config.world.scale, 0.1);
}

TEST(ConfigRoot, ARobotThatWalksOneLegAtATimeDoesNotJump) {
  RunRequest request = cross("flat");
  request.robot = "littledog";
  EXPECT_EQ(issues_of(request), "");
  request.sets = {"mission.jump=true"};
  EXPECT_EQ(issues_of(request),
            "--mission: mission.jump: true, but the robot walks one leg at a time "
            "(control.static_walk.enabled)\n");
}

TEST(ConfigRoot, AValueWithoutANameIsThatOfTheFirstParameter) {
  const Config config = loaded(cross("rocks:flat,height=0.04"));
  EXPECT_EQ(config.world.generator, sim::Generator::kRocks);
  EXPECT_EQ(config.world.style, sim::RockStyle::kFlat);
  EXPECT_EQ(loaded(cross("rocks:jagged")).world.style, sim::RockStyle::kJagged);
  EXPECT_EQ(config.world.height_m, 0.04);
  EXPECT_EQ(issues_of(cross("rocks:round")).rfind("--world: world.style: ", 0), 0U);
}

TEST(ConfigRoot, AMissionThatCrossesGoesToTheGoalOfItsWorldUnlessItHasOne) {
  EXPECT_EQ(loaded(cross("flat")).autonomy.mission.goal_x_m, 3.0);
  EXPECT_EQ(loaded(cross("rocks:flat")).autonomy.mission.goal_x_m, 2.2);
  RunRequest request = cross("rocks:flat");
  request.sets = {"mission.goal_x_m=1.0"};
  EXPECT_EQ(loaded(request).autonomy.mission.goal_x_m, 1.0);
}

TEST(ConfigRoot, AForestHasItsGoalWhereTheSeedDrewItOrAsFarAsAskedFor) {
  RunRequest request = cross("forest");
  request.seed = 7;
  const Config config = loaded(request);
  EXPECT_EQ(config.autonomy.mission.goal_x_m, sim::goal_of(config.world, 7));
  EXPECT_EQ(config.world.goal_x_m, config.autonomy.mission.goal_x_m);
  EXPECT_EQ(loaded(cross("forest:length=40")).autonomy.mission.goal_x_m, 40.0);
  EXPECT_TRUE(loaded(cross("wall:enclosed=true")).world.enclosed);
}

TEST(ConfigRoot, ThePlantHasAShortName) {
  RunRequest request = cross();
  EXPECT_EQ(loaded(request).sim.plant, sim::PlantKind::kLegged);
  request.sets = {"plant=fast"};
  EXPECT_EQ(loaded(request).sim.plant, sim::PlantKind::kFast);
  request.sets = {"plant=hover"};
  EXPECT_EQ(issues_of(request).rfind("--set: sim.plant: ", 0), 0U);
}

TEST(ConfigRoot, WrongWorldParameters) {
  EXPECT_EQ(issues_of(cross("flat:height=0.05")),
            "--world: world.height: not a parameter of this world; allowed: friction\n");
  EXPECT_EQ(issues_of(cross("clutter:height=5")),
            "--world: world.height_m: 5 is out of range, allowed: 0 to 0.5\n");
  EXPECT_EQ(
      issues_of(cross("clutter:height=tall")),
      "--world: world.height_m: wrong type: 'tall' is not a real number, allowed: 0 to 0.5\n");
}

TEST(ConfigRoot, UnknownNamesListTheKnownOnes) {
  RunRequest request = cross();
  request.mission = "fly";
  const std::string issues = issues_of(request);
  EXPECT_NE(issues.find("--mission: 'fly' is unknown"), std::string::npos) << issues;
  for (const char* known : {" cross ", " platform ", " push ", " stand "}) {
    EXPECT_NE(issues.find(known), std::string::npos) << issues;
  }
  EXPECT_EQ(std::count(issues.begin(), issues.end(), '\n'), 1) << issues;
}

TEST(ConfigRoot, APathServesAsAName) {
  RunRequest request = cross();
  request.mission = (kFolder / "missions" / "stand.yaml").string();
  request.world = (kFolder / "worlds" / "clutter.yaml").string() + ":height=0.02";
  const Config config = loaded(request);
  EXPECT_EQ(config.autonomy.mission.kind, autonomy::MissionConfig::Kind::kStand);
  EXPECT_EQ(config.world.height_m, 0.02);
}

TEST(ConfigRoot, AGroupThatItsFileLacksIsReportedOnce) {
  const fs::path file = fs::temp_directory_path() / "surefoot_empty_mission.yaml";
  std::ofstream(file) << "other: {}\n";
  RunRequest request = cross();
  request.mission = file.string();
  const std::string issues = issues_of(request);
  fs::remove(file);
  EXPECT_NE(issues.find("--mission: mission: missing"), std::string::npos) << issues;
  EXPECT_NE(issues.find(file.string() + ":1: other: unknown key"), std::string::npos) << issues;
}

TEST(ConfigRoot, SetReachesEveryGroup) {
  RunRequest request = cross();
  request.sets = {"mapping.enabled=false", "mission.goal_x_m=1.5", "robot.wiring.3.can_id=9"};
  const Config config = loaded(request);
  EXPECT_FALSE(config.autonomy.mapping.enabled);
  EXPECT_EQ(config.autonomy.mission.goal_x_m, 1.5);
  EXPECT_EQ(config.robot.wiring[3].can_id, 9);
}

TEST(ConfigRoot, RecordTextRestoresRequestAndConfiguration) {
  RunRequest request = cross("clutter:height=0.033");
  request.seed = 987654321;
  const Config config = loaded(request);
  RunRequest request_again;
  Config config_again;
  ConfigIssues issues;
  read_record_text(record_text(request, config), request_again, config_again, issues);
  EXPECT_EQ(to_string(issues), "");
  EXPECT_EQ(request_again.seed, request.seed);
  EXPECT_EQ(request_again.world, request.world);
  EXPECT_EQ(config_text(config_again), config_text(config));
  EXPECT_EQ(config_hash(config_again), config_hash(config));
}

TEST(ConfigRoot, HashSeesEveryChange) {
  RunRequest request = cross();
  const std::uint64_t before = config_hash(loaded(request));
  request.sets = {"control.gaits.trot.period_s=0.401"};
  EXPECT_NE(config_hash(loaded(request)), before);
  request.sets.clear();
  request.seed = 2;  // a seed is not configuration
  EXPECT_EQ(config_hash(loaded(request)), before);
}

}  // namespace
}  // namespace surefoot::apps
