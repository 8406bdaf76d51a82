// Every way a configuration can be wrong is reported with file, line, key and what is allowed.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

#include "apps/common/config_node.h"
#include "apps/common/config_reader.h"
#include "apps/common/config_writer.h"
#include "core/base/fixed_vector.h"

namespace surefoot::apps {
namespace {

enum class Colour : std::uint8_t { kRed = 0, kGreen };
constexpr std::array<const char*, 2> kColourNames{"red", "green"};

struct Motor {
  double torque_Nm = 0;
  std::uint8_t bus = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("torque_Nm", self.torque_Nm, {0.0, 20.0}, "at the joint");
    visit.integer("bus", self.bus, {0, 3}, "CAN bus");
  }
};

struct Machine {
  bool enabled = false;
  Colour colour = Colour::kRed;
  std::string file;
  std::array<double, 3> size_m{};
  Motor main;
  std::array<Motor, 2> motors;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.boolean("enabled", self.enabled, "a switch");
    visit.choice("colour", self.colour, kColourNames, "of the paint");
    visit.text("file", self.file, "a file");
    visit.reals("size_m", self.size_m, {-1.0, 1.0}, "x y z");
    visit.group("main", self.main);
    visit.groups("motors", self.motors);
  }
};

struct Fleet {
  FixedVector<Motor, 2> motors;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.list("motors", self.motors);
  }
};

const std::string kGood = R"(enabled: true
colour: green
file: "a b.png"
size_m: [0.1, -0.2, 1e-3]
main:
  torque_Nm: 17.5
  bus: 2
motors:
  - torque_Nm: 1.0
    bus: 0
  - torque_Nm: 0.1
    bus: 3
)";

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string issues_of(const std::string& yaml, const std::vector<std::string>& sets = {}) {
  ConfigIssues issues;
  ConfigNode tree = read_yaml_text(yaml, "machine.yaml", issues);
  for (const std::string& set : sets) apply_override(tree, set, issues);
  Machine machine;
  ConfigReader::read(tree, machine, issues);
  return to_string(issues);
}

Machine good_machine(const std::vector<std::string>& sets = {}) {
  ConfigIssues issues;
  ConfigNode tree = read_yaml_text(kGood, "machine.yaml", issues);
  for (const std::string& set : sets) apply_override(tree, set, issues);
  Machine machine;
  ConfigReader::read(tree, machine, issues);
  EXPECT_EQ(to_string(issues), "");
  return machine;
}

TEST(ConfigLoader, ReadsEveryKind) {
  const Machine machine = good_machine();
  EXPECT_TRUE(machine.enabled);
  EXPECT_EQ(machine.colour, Colour::kGreen);
  EXPECT_EQ(machine.file, "a b.png");
  EXPECT_EQ(machine.size_m, (std::array<double, 3>{0.1, -0.2, 1e-3}));
  EXPECT_EQ(machine.main.torque_Nm, 17.5);
  EXPECT_EQ(machine.motors[1].bus, 3);
}

TEST(ConfigLoader, UnknownKey) {
  EXPECT_EQ(issues_of(replaced("  bus: 2", "  bus: 2\n  busy: 1")),
            "machine.yaml:8: main.busy: unknown key; did you mean bus?\n");
  EXPECT_EQ(issues_of(kGood + "zebra_crossing: 1\n"),
            "machine.yaml:13: zebra_crossing: unknown key\n");
}

TEST(ConfigLoader, MissingKeyNamesTheGroupsLine) {
  EXPECT_EQ(
      issues_of(replaced("  torque_Nm: 17.5\n", "")),
      "machine.yaml:5: main.torque_Nm: missing; expected real number (at the joint), allowed: "
      "0 to 20\n");
}

TEST(ConfigLoader, OutOfRange) {
  EXPECT_EQ(issues_of(replaced("17.5", "20.5")),
            "machine.yaml:6: main.torque_Nm: 20.5 is out of range, allowed: 0 to 20\n");
  EXPECT_EQ(issues_of(replaced("bus: 2", "bus: 4")),
            "machine.yaml:7: main.bus: 4 is out of range, allowed: 0 to 3\n");
  EXPECT_EQ(issues_of(replaced("-0.2", "-1.2")),
            "machine.yaml:4: size_m.1: -1.2 is out of range, allowed: -1 to 1\n");
}

TEST(ConfigLoader, NotFinite) {
  for (const std::string text : {".nan", "nan", "NaN", ".inf", "-.inf", "inf", "-.Inf"}) {
    EXPECT_EQ(issues_of(replaced("17.5", text)), "machine.yaml:6: main.torque_Nm: " + text +
                                                     " is not a finite number, allowed: 0 to 20\n");
  }
}

TEST(ConfigLoader, WrongType) {
  EXPECT_EQ(
      issues_of(replaced("17.5", "fast")),
      "machine.yaml:6: main.torque_Nm: wrong type: 'fast' is not a real number, allowed: 0 to "
      "20\n");
  EXPECT_EQ(
      issues_of(replaced("17.5", "\"17.5\"")),
      "machine.yaml:6: main.torque_Nm: wrong type: '17.5' is not a real number, allowed: 0 to "
      "20\n");
  EXPECT_EQ(issues_of(replaced("bus: 2", "bus: 2.5")),
            "machine.yaml:7: main.bus: wrong type: '2.5' is not an integer, allowed: 0 to 3\n");
  EXPECT_EQ(issues_of(replaced("enabled: true", "enabled: 1")),
            "machine.yaml:1: enabled: wrong type: '1' is not a boolean, allowed: true, false\n");
  EXPECT_EQ(issues_of(replaced("green", "blue")),
            "machine.yaml:2: colour: 'blue' is not a choice, allowed: red, green\n");
  EXPECT_EQ(issues_of(replaced("17.5", "[1]")),
            "machine.yaml:6: main.torque_Nm: wrong type: expected a real number, found a list\n");
  EXPECT_EQ(issues_of(replaced("17.5", "")),
            "machine.yaml:6: main.torque_Nm: wrong type: expected a real number, found nothing\n");
  EXPECT_EQ(issues_of(replaced("[0.1, -0.2, 1e-3]", "1")),
            "machine.yaml:4: size_m: wrong type: expected a list of 3 items\n");
  EXPECT_EQ(issues_of(replaced("main:\n  torque_Nm: 17.5\n  bus: 2", "main: 3")),
            "machine.yaml:5: main: expected a group of keys\n");
}

TEST(ConfigLoader, WrongListLength) {
  EXPECT_EQ(issues_of(replaced(", 1e-3", "")),
            "machine.yaml:4: size_m: wrong list length: expected 3 items, found 2\n");
  EXPECT_EQ(issues_of(replaced("  - torque_Nm: 0.1\n    bus: 3\n", "")),
            "machine.yaml:8: motors: wrong list length: expected 2 items, found 1\n");
}

TEST(ConfigLoader, DuplicateKey) {
  EXPECT_EQ(issues_of(replaced("  bus: 2", "  bus: 2\n  bus: 1")),
            "machine.yaml:8: main.bus: duplicate key, first given in line 7\n");
}

TEST(ConfigLoader, SyntaxErrorAndUnreadableFile) {
  const std::string issues = issues_of("enabled: [true\n");
  EXPECT_EQ(issues.rfind("machine.yaml:2: not valid YAML: ", 0), 0u) << issues;
  ConfigIssues unreadable;
  read_yaml_file("/nowhere/x.yaml", unreadable);
  EXPECT_EQ(to_string(unreadable), "/nowhere/x.yaml: cannot be read\n");
}

TEST(ConfigLoader, AllIssuesOfAFileAreReported) {
  std::string text = replaced("17.5", "99");
  text.replace(text.find("green"), 5, "blue");
  text += "extra: 1\n";
  const std::string issues = issues_of(text);
  EXPECT_EQ(std::count(issues.begin(), issues.end(), '\n'), 3) << issues;
}

TEST(ConfigLoader, OverridesByDottedKeyAndIndex) {
  const Machine machine =
      good_machine({"main.torque_Nm=3", "motors.1.bus=1", "size_m.2=0.5", "colour=red"});
  EXPECT_EQ(machine.main.torque_Nm, 3.0);
  EXPECT_EQ(machine.motors[1].bus, 1);
  EXPECT_EQ(machine.size_m[2], 0.5);
  EXPECT_EQ(machine.colour, Colour::kRed);
  EXPECT_EQ(good_machine({"size_m=[1, 0, 1]"}).size_m, (std::array<double, 3>{1, 0, 1}));
}

TEST(ConfigLoader, OverridesAreCheckedAndNamed) {
  EXPECT_EQ(issues_of(kGood, {"main.torque_Nm=30"}),
            "--set: main.torque_Nm: 30 is out of range, allowed: 0 to 20\n");
  EXPECT_EQ(issues_of(kGood, {"main.torqe_Nm=3"}),
            "--set: main.torqe_Nm: unknown key; did you mean torque_Nm?\n");
  EXPECT_EQ(issues_of(kGood, {"nonsense.deep.key=3"}), "--set: nonsense: unknown key\n");
  EXPECT_EQ(issues_of(kGood, {"enabled"}), "--set: 'enabled' is not key=value\n");
  EXPECT_EQ(issues_of(kGood, {"motors.7.bus=1"}),
            "machine.yaml:8: motors: wrong list length: expected 2 items, found 3\n");
}

TEST(ConfigLoader, MergeKeysAndAnchors) {
  std::string text = kGood;
  text.replace(text.find("  - torque_Nm: 1.0\n    bus: 0"), 29, "  - &m {torque_Nm: 4.0, bus: 0}");
  text.replace(text.find("  - torque_Nm: 0.1\n    bus: 3"), 29, "  - {<<: *m, bus: 1}");
  ConfigIssues issues;
  Machine machine;
  ConfigReader::read(read_yaml_text(text, "m", issues), machine, issues);
  EXPECT_EQ(to_string(issues), "");
  EXPECT_EQ(machine.motors[1].torque_Nm, 4.0);
  EXPECT_EQ(machine.motors[1].bus, 1);
}

TEST(ConfigLoader, CanonicalTextRoundTrips) {
  Machine machine = good_machine();
  machine.main.torque_Nm = 0.1 + 0.2;  // needs all 17 digits
  machine.size_m[0] = -0.0;
  machine.file = "odd \"name\"\\n";
  const std::string text = ConfigWriter::write(machine);
  ConfigIssues issues;
  Machine again;
  ConfigReader::read(read_canonical_text(text, "record", issues), again, issues);
  EXPECT_EQ(to_string(issues), "");
  EXPECT_EQ(again.main.torque_Nm, machine.main.torque_Nm);
  EXPECT_TRUE(std::signbit(again.size_m[0]));
  EXPECT_EQ(again.file, machine.file);
  EXPECT_EQ(ConfigWriter::write(again), text);
  EXPECT_EQ(text_hash(text), text_hash(ConfigWriter::write(again)));
}

TEST(ConfigLoader, CanonicalTextIsReadable) {
  const std::string text = ConfigWriter::write(good_machine());
  EXPECT_NE(text.find("motors.1.torque_Nm = 0.1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("colour = green\n"), std::string::npos);
  ConfigIssues issues;
  read_canonical_text("no equals sign\n", "record", issues);
  EXPECT_EQ(to_string(issues), "record:1: expected `key = value`\n");
}

TEST(ConfigLoader, TheSameGroupInTwoFilesIsADuplicate) {
  ConfigIssues issues;
  ConfigNode tree = read_yaml_text("a: {x: 1}\n", "one.yaml", issues);
  merge_groups(tree, read_yaml_text("b: {x: 1}\na: {x: 2}\n", "two.yaml", issues), issues);
  EXPECT_EQ(to_string(issues), "two.yaml:2: a: duplicate key, first given in one.yaml:1\n");
  EXPECT_NE(tree.find("b"), nullptr);
}

// Lists of any length come back from the canonical text as they went in, the empty one too.
TEST(ConfigLoader, ListsOfAnyLengthUpToTheirCapacity) {
  const auto read = [](const std::string& text, ConfigIssues& issues) {
    Fleet fleet;
    ConfigReader::read(read_yaml_text(text, "fleet.yaml", issues), fleet, issues);
    return fleet;
  };
  const std::string motor = "  - {torque_Nm: 2.5, bus: 1}\n";
  for (std::size_t count = 0; count <= 2; ++count) {
    std::string text = count == 0 ? "motors: []\n" : "motors:\n";
    for (std::size_t i = 0; i < count; ++i) text += motor;
    ConfigIssues issues;
    const Fleet fleet = read(text, issues);
    ASSERT_EQ(to_string(issues), "");
    ASSERT_EQ(fleet.motors.size(), count);
    Fleet again;
    ConfigReader::read(read_canonical_text(ConfigWriter::write(fleet), "record", issues), again,
                       issues);
    EXPECT_EQ(to_string(issues), "");
    EXPECT_EQ(ConfigWriter::write(again), ConfigWriter::write(fleet));
  }
  ConfigIssues issues;
  read("motors:\n" + motor + motor + motor, issues);
  EXPECT_EQ(to_string(issues), "fleet.yaml:1: motors: too long: 3 items, allowed: 2\n");
}

}  // namespace
}  // namespace surefoot::apps
