#include "apps/common/config_root.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "apps/common/config_motions.h"
#include "apps/common/config_reader.h"
#include "apps/common/config_stereo.h"
#include "apps/common/config_terrain.h"
#include "apps/common/config_writer.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

constexpr Range kSeeds{0, 9e15};  // what a JSON number holds exactly

// The part of a request that a record keeps.
struct RecordedRequest {
  RunRequest& request;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("robot", self.request.robot, "as asked for");
    visit.text("world", self.request.world, "as asked for");
    visit.text("mission", self.request.mission, "as asked for");
    visit.text("hal", self.request.hal, "backend");
    visit.integer("seed", self.request.seed, kSeeds, "of every draw");
  }
};

struct RecordedRun {
  RecordedRequest run;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("run", self.run);
  }
};

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".yaml");
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// A file's name as a person would type it.
std::string shown(const fs::path& path) {
  std::error_code error;
  const fs::path near = fs::proximate(path, error);
  const bool inside = !error && !near.empty() && *near.begin() != "..";
  return inside ? near.string() : path.lexically_normal().string();
}

// The file behind a name; empty when there is none, which was reported.
std::string find_file(const char* option, const std::string& kind, const std::string& name,
                      const fs::path& folder, ConfigIssues& issues) {
  if (is_path(name)) return name;
  if (folder.empty()) {
    issues.push_back(
        {{option, 0}, "", "no config folder found; set SUREFOOT_CONFIG or give a path"});
    return {};
  }
  const fs::path file = folder / kind / (name + ".yaml");
  std::error_code error;
  if (!name.empty() && fs::exists(file, error)) return shown(file);
  std::string known;
  for (const std::string& candidate : names_in(folder / kind)) known += " " + candidate;
  issues.push_back(
      {{option, 0},
       "",
       fmt::format("'{}' is unknown; {} holds:{}", name, shown(folder / kind), known)});
  return {};
}

void add_file(const char* option, const std::string& kind, const std::string& name,
              const fs::path& folder, ConfigNode& tree, ConfigIssues& issues) {
  const std::string file = find_file(option, kind, name, folder, issues);
  if (file.empty()) return;
  ConfigNode part = read_yaml_file(file, issues);
  if (tree.place.source.empty()) tree.place = part.place;
  merge_groups(tree, std::move(part), issues);
}

struct WorldArgument {
  std::string name;
  std::vector<std::string> items;  // after the colon: "height=0.05", or a bare value
};

WorldArgument split_world(const std::string& text) {
  WorldArgument argument;
  const std::size_t yaml = text.find(".yaml:");
  const std::size_t colon = yaml == std::string::npos ? text.find(':') : yaml + 5;
  argument.name = text.substr(0, colon);
  std::size_t begin = colon == std::string::npos ? text.size() : colon + 1;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    argument.items.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return argument;
}

// Takes `parameters` out of the world's tree.
std::vector<std::string> take_parameters(ConfigNode& tree) {
  std::vector<std::string> keys;
  const auto found = std::find_if(tree.children.begin(), tree.children.end(),
                                  [](const auto& child) { return child.key == "parameters"; });
  if (found == tree.children.end()) return keys;
  for (const auto& [index, item] : found->node.children) keys.push_back(item.text);
  tree.children.erase(found);
  return keys;
}

// height -> height_m
std::string full_key(const std::string& name, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    if (key == name || key.rfind(name + "_", 0) == 0) return key;
  }
  return {};
}

void apply_world_item(const std::string& item, const std::vector<std::string>& keys,
                      ConfigNode& tree, ConfigIssues& issues) {
  const std::size_t equals = item.find('=');
  // A bare item is the first parameter's value: heightmap:FILE, rocks:flat.
  const std::string first = keys.empty() ? std::string() : keys.front();
  const std::string name = equals == std::string::npos ? first : item.substr(0, equals);
  const std::string key = full_key(name, keys);
  if (key.empty()) {
    std::string known;
    for (const std::string& candidate : keys) known += " " + candidate;
    issues.push_back(
        {{"--world", 0},
         "world." + name,
         "not a parameter of this world; allowed:" + (known.empty() ? " none" : known)});
    return;
  }
  const std::string value = equals == std::string::npos ? item : item.substr(equals + 1);
  ConfigNode* group = tree.find("world");
  ConfigNode* node = group == nullptr ? nullptr : group->find(key);
  if (node == nullptr) return;  // the file lacks it: reported on reading
  node->kind = ConfigNode::Kind::kScalar;
  node->text = value;
  node->quoted = false;
  node->place = {"--world", 0};
}

void add_world(const std::string& text, const fs::path& folder, ConfigNode& tree,
               ConfigIssues& issues) {
  const WorldArgument argument = split_world(text);
  const std::string file = find_file("--world", "worlds", argument.name, folder, issues);
  if (file.empty()) return;
  ConfigNode part = read_yaml_file(file, issues);
  const std::vector<std::string> keys = take_parameters(part);
  for (const std::string& item : argument.items) apply_world_item(item, keys, part, issues);
  if (tree.place.source.empty()) tree.place = part.place;
  merge_groups(tree, std::move(part), issues);
}

// Which option should have brought a top-level group.
const char* option_of(const std::string& group) {
  if (group == "world") return "--world";
  if (group == "mission" || group == "scenario") return "--mission";
  return "--robot";
}

bool is_missing_group(const ConfigIssue& issue) {
  return issue.key.find('.') == std::string::npos && issue.message.rfind("missing", 0) == 0;
}

// What a file would have held that could not be read is not missing as well.
void drop_what_follows(const ConfigIssues& before, ConfigIssues& read) {
  std::erase_if(read, [&](const ConfigIssue& issue) {
    if (issue.message.rfind("missing", 0) != 0) return false;
    return std::any_of(before.begin(), before.end(), [&](const ConfigIssue& other) {
      return !other.key.empty() && issue.key.rfind(other.key + ".", 0) == 0;
    });
  });
}

// Issues of groups whose file was not asked for, or could not be found, say nothing new.
ConfigIssues without_absent_groups(ConfigIssues read, const RunRequest& request,
                                   const ConfigIssues& before) {
  std::erase_if(read, [&](const ConfigIssue& issue) {
    if (!is_missing_group(issue)) return false;
    const std::string option = option_of(issue.key);
    const bool asked = !(option == "--world"     ? request.world
                         : option == "--mission" ? request.mission
                                                 : request.robot)
                            .empty();
    const bool failed = std::any_of(before.begin(), before.end(), [&](const ConfigIssue& other) {
      return other.place.source == option || other.key.empty();
    });
    return !asked || failed;
  });
  for (ConfigIssue& issue : read) {
    if (is_missing_group(issue)) issue.place = {option_of(issue.key), 0};
  }
  return read;
}

}  // namespace

fs::path config_folder() {
  const char* chosen = std::getenv("SUREFOOT_CONFIG");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& candidate : {binary.parent_path() / "../../../config", fs::path("config"),
                                    fs::path(SUREFOOT_SOURCE_CONFIG)}) {
    if (fs::is_directory(candidate / "robots", error)) return candidate.lexically_normal();
  }
  return {};
}

namespace {

void check_mission(const Config& root, ConfigIssues& issues) {
  const autonomy::AutonomyConfig& config = root.autonomy;
  const bool navigates = config.mission.kind == autonomy::MissionConfig::Kind::kNavigate;
  if (navigates && (!config.navigation.present || root.robot.lidar.rate_Hz <= 0)) {
    issues.push_back(
        {{"--mission", 0},
         "mission.kind",
         "navigate, but the robot's file has no laser scanner or no group navigation"});
  }
  if (config.own_gaits && (config.mission.jump || config.mission.recover)) {
    issues.push_back(
        {{"--set", 0}, "sim.plant", "fast, but the mission jumps or gets up: that takes legs"});
  }
  if (!config.control.static_walk.enabled || !config.mission.jump) return;
  issues.push_back({{"--mission", 0},
                    "mission.jump",
                    "true, but the robot walks one leg at a time (control.static_walk.enabled)"});
}

// A body that moves its own legs is spoken to in velocities.
void tell_plant(Config& config) {
  config.autonomy.own_gaits = config.sim.plant == sim::PlantKind::kFast;
}

void take_goal_from_world(Config& config, std::uint64_t seed) {
  config.world.goal_x_m = sim::goal_of(config.world, seed);
  autonomy::MissionConfig& mission = config.autonomy.mission;
  using Kind = autonomy::MissionConfig::Kind;
  const bool goes = mission.kind == Kind::kCross || mission.kind == Kind::kNavigate;
  if (goes && mission.waypoints.empty() && mission.goal_x_m == 0.0) {
    mission.goal_x_m = config.world.goal_x_m;
  }
}

}  // namespace

Config load_config(const RunRequest& request, const fs::path& folder, ConfigIssues& issues) {
  const std::pair<const char*, const std::string*> needed[] = {
      {"--robot", &request.robot}, {"--world", &request.world}, {"--mission", &request.mission}};
  for (const auto& [option, value] : needed) {
    if (value->empty()) issues.push_back({{option, 0}, "", "missing"});
  }
  return load_config_parts(request, folder, issues);
}

Config load_config_parts(const RunRequest& request, const fs::path& folder, ConfigIssues& issues) {
  ConfigNode tree;
  if (!request.robot.empty()) add_file("--robot", "robots", request.robot, folder, tree, issues);
  if (!request.world.empty()) add_world(request.world, folder, tree, issues);
  if (!request.mission.empty()) {
    add_file("--mission", "missions", request.mission, folder, tree, issues);
  }
  for (const std::string& set : request.sets) {
    // The contract's short name.
    apply_override(tree, set.rfind("plant=", 0) == 0 ? "sim." + set : set, issues);
  }
  load_motions(tree, folder, issues);
  load_stereo(tree, issues);
  load_terrain(tree, issues);
  Config config;
  ConfigIssues read;
  ConfigReader::read(tree, config, read);
  tell_plant(config);
  if (read.empty()) check_motions(config.autonomy.motions, config.robot, read);
  if (read.empty()) check_mission(config, read);
  // Also of a robot's file alone.
  if (!request.robot.empty() && std::all_of(read.begin(), read.end(), is_missing_group)) {
    check_stereo(tree, config.robot, config.autonomy.stereo, config.sim.stereo.present, read);
    check_camera_motion(config.robot, config.autonomy, read);
  }
  take_goal_from_world(config, request.seed);
  read = without_absent_groups(std::move(read), request, issues);
  drop_what_follows(issues, read);
  issues.insert(issues.end(), read.begin(), read.end());
  return config;
}

mapping::TraversabilityLimits class_limits(const Config& config) {
  return mapping::traversability_limits(config.autonomy.mapping, config.robot,
                                        config.autonomy.control.body.height_m,
                                        config.autonomy.control.swing.clearance_m);
}

std::string config_text(const Config& config) { return ConfigWriter::write(config); }

std::uint64_t config_hash(const Config& config) { return text_hash(config_text(config)); }

std::string record_text(const RunRequest& request, const Config& config) {
  RunRequest copy = request;
  const RecordedRun run{{copy}};
  return ConfigWriter::write(run) + config_text(config);
}

void read_record_text(const std::string& text, RunRequest& request, Config& config,
                      ConfigIssues& issues) {
  ConfigNode tree = read_canonical_text(text, "record", issues);
  ConfigNode head;
  const auto run = std::find_if(tree.children.begin(), tree.children.end(),
                                [](const auto& child) { return child.key == "run"; });
  if (run != tree.children.end()) {
    head.children.push_back(std::move(*run));
    tree.children.erase(run);
  }
  RecordedRun recorded{{request}};
  ConfigReader::read(head, recorded, issues);
  ConfigReader::read(tree, config, issues);
  tell_plant(config);
}

}  // namespace surefoot::apps
