#include "apps/common/config_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/common/motion_file.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

bool jumps(const ConfigNode& tree) {
  const ConfigNode* mission = tree.find("mission");
  const ConfigNode* jump = mission == nullptr ? nullptr : mission->find("jump");
  return jump != nullptr && jump->text == "true";
}

// The group `motion` of a file that reads without an issue.
ConfigNode motion_node(const ConfigNode& name, const fs::path& folder, ConfigIssues& issues) {
  const fs::path file = folder / "motions" / (name.text + ".yaml");
  std::error_code error;
  if (name.kind != ConfigNode::Kind::kScalar || name.text.empty() || !fs::exists(file, error)) {
    issues.push_back({name.place, "motions",
                      fmt::format("'{}' is no motion: {} does not exist", name.text,
                                  file.lexically_normal().string())});
    return {};
  }
  const std::size_t before = issues.size();
  static_cast<void>(read_motion_file(file, issues));
  if (issues.size() != before) return {};
  ConfigNode tree = read_yaml_file(file.string(), issues);
  ConfigNode motion = std::move(*tree.find("motion"));
  std::erase_if(motion.children, [](const ConfigChild& child) { return child.key == "checksum"; });
  return motion;
}

}  // namespace

void load_motions(ConfigNode& tree, const fs::path& folder, ConfigIssues& issues) {
  ConfigNode* list = tree.find("motions");
  if (list == nullptr) return;  // reported on reading
  if (!jumps(tree)) {
    list->kind = ConfigNode::Kind::kList;
    list->children.clear();
    return;
  }
  for (ConfigChild& child : list->children) {
    const ConfigPlace place = child.node.place;
    child.node = motion_node(child.node, folder, issues);
    if (child.node.place.source.empty()) child.node.place = place;
  }
}

void check_motions(const motions::MotionLibrary& motions, const robot::RobotModel& model,
                   ConfigIssues& issues) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const motions::MotionCheck check = motions::check_motion(motions[i], model);
    if (check.fault == motions::MotionFault::kNone) continue;
    issues.push_back({{"--robot", 0},
                      fmt::format("motions.{}.rows.{}", i, check.row),
                      motions::kMotionFaultNames[static_cast<std::size_t>(check.fault)]});
  }
}

}  // namespace surefoot::apps
