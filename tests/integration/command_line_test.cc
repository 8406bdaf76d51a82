// Wrong use and wrong configuration: exit 2 with file, line, key and allowed range, before anything
// moves.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/integration/program.h"

namespace surefoot {
namespace {

const std::string kRun = "surefoot run --robot mini_cheetah --world flat --mission cross";

std::string mission_text() {
  std::ifstream file(SUREFOOT_SOURCE_DIR "/config/missions/cross.yaml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// Writes the cross mission with one text replaced and returns the line it stands in.
int write_wrong_mission(const std::filesystem::path& file, const std::string& from,
                        const std::string& to) {
  std::string text = mission_text();
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  std::ofstream(file) << text;
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

TEST(CommandLine, WrongUseIsTwo) {
  for (const char* command :
       {"surefoot", "surefoot fly", "surefoot run", "surefoot run --robot mini_cheetah",
        "surefoot replay", "surefoot replay /nowhere.mcap", "surefoot check",
        "surefoot can-replay /nowhere.log --robot mini_cheetah", "surefoot-lab",
        "surefoot-lab export /nowhere.mcap --to csv", "surefoot-lab bench nothing",
        "surefoot-lab campaign --robot mini_cheetah --world flat --mission cross --seeds 2..1"}) {
    const ProgramResult result = run_program(command);
    EXPECT_EQ(result.code, 2) << command;
    EXPECT_FALSE(result.error.empty()) << command;
  }
  EXPECT_EQ(run_program(kRun + " --hal moon").code, 2);
  EXPECT_EQ(run_program(kRun + " --seed x").code, 2);
}

TEST(CommandLine, HelpAndInfoAreZero) {
  EXPECT_EQ(run_program("surefoot --help").code, 0);
  EXPECT_EQ(run_program("surefoot-lab --help").code, 0);
  const ProgramResult info = run_program("surefoot info");
  EXPECT_EQ(info.code, 0);
  for (const char* word : {"surefoot 0.", "backends", " sim", "mapping", "total", "bytes"}) {
    EXPECT_NE(info.out.find(word), std::string::npos) << word;
  }
}

TEST(CommandLine, WrongConfigurationNamesFileLineKeyAndRange) {
  const Scratch scratch;
  const struct {
    const char* from;
    const char* to;
    const char* key;
    const char* message;
  } cases[] = {
      {"speed_m_s: 0.5", "speed_m_s: 9.5", "mission.speed_m_s",
       "9.5 is out of range, allowed: 0 to 4"},
      {"speed_m_s: 0.5", "speed_m_s: .nan", "mission.speed_m_s",
       ".nan is not a finite number, allowed: 0 to 4"},
      {"speed_m_s: 0.5", "speed_m_s: quick", "mission.speed_m_s",
       "wrong type: 'quick' is not a real number, allowed: 0 to 4"},
      {"speed_m_s: 0.5", "speed_mps: 0.5", "mission.speed_mps",
       "unknown key; did you mean speed_m_s?"},
  };
  for (const auto& item : cases) {
    const int line = write_wrong_mission(scratch.path("wrong.yaml"), item.from, item.to);
    const ProgramResult result =
        run_program("surefoot run --robot mini_cheetah --world flat --mission " +
                    scratch.text("wrong.yaml") + " --out " + scratch.text("out"));
    EXPECT_EQ(result.code, 2);
    const std::string expected = scratch.text("wrong.yaml") + ":" + std::to_string(line) + ": " +
                                 item.key + ": " + item.message;
    EXPECT_NE(result.error.find(expected), std::string::npos) << result.error << expected;
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
  }
  // The misspelt key is also a missing one: at its group's line, with type and range.
  const ProgramResult missing =
      run_program("surefoot check --mission " + scratch.text("wrong.yaml"));
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.error.find(":2: mission.speed_m_s: missing; expected real number (commanded), "
                               "allowed: 0 to 4"),
            std::string::npos)
      << missing.error;
}

TEST(CommandLine, SetIsCheckedAndNamed) {
  const ProgramResult result = run_program(kRun + " --set control.gaits.trot.period_s=70");
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.error.find("--set: control.gaits.trot.period_s: 70 is out of range"),
            std::string::npos)
      << result.error;
}

TEST(CommandLine, UnknownNamesListWhatThereIs) {
  const ProgramResult result =
      run_program("surefoot run --robot mini_cheetah --world moon --mission cross");
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.error.find("--world: 'moon' is unknown"), std::string::npos);
  for (const char* world : {"clutter", "flat", "heightmap", "platform"}) {
    EXPECT_NE(result.error.find(std::string(" ") + world), std::string::npos) << result.error;
  }
}

TEST(CommandLine, UnreadableWorldFileIsTwo) {
  const ProgramResult result = run_program(
      "surefoot run --robot mini_cheetah --world heightmap:/nowhere.asc --mission cross");
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.error.find("/nowhere.asc"), std::string::npos) << result.error;
}

TEST(CommandLine, EveryShippedConfigurationChecks) {
  const ProgramResult result = run_program(
      "surefoot check --robot mini_cheetah --world clutter:height=0.05 --mission cross");
  EXPECT_EQ(result.code, 0) << result.error;
}

TEST(CommandLine, CanReplayReportsMalformedLinesByNumber) {
  const Scratch scratch;
  std::ofstream(scratch.path("bus.log")) << "(1.000000) can0 000#017FFF7FF7FF\n"
                                            "(1.000500) can0 000#017FFF7FF7F\n"
                                            "nonsense\n"
                                            "(1.002000) can0 000#027FFF7FF7FF\n";
  const ProgramResult result = run_program("surefoot can-replay " + scratch.text("bus.log") +
                                           " --robot mini_cheetah --out " + scratch.text("out"));
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("bus.log:2: malformed"), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("bus.log:3: malformed"), std::string::npos) << result.error;
  std::ifstream csv(scratch.path("out") / "joints.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1].rfind("0.000000,0,FR_abad,", 0), 0u) << lines[1];
  EXPECT_EQ(lines[2].rfind("0.002000,1,FR_hip,", 0), 0u) << lines[2];
}

}  // namespace
}  // namespace surefoot
