// The motions that a robot's file names, put in place of their names.
#pragma once

#include <filesystem>

#include "apps/common/config_node.h"
#include "core/motions/motion.h"
#include "core/robot/robot_model.h"

namespace surefoot::apps {

// `motions: [platform_0.13, ...]` of the tree becomes the list of what config/motions/NAME.yaml
// hold, without their checksums, which were compared. Where the mission does not jump (mission.jump
// false, or no mission asked for) the list becomes empty.
void load_motions(ConfigNode& tree, const std::filesystem::path& folder, ConfigIssues& issues);

// What this robot cannot do: one issue per motion.
void check_motions(const motions::MotionLibrary& motions, const robot::RobotModel& model,
                   ConfigIssues& issues);

}  // namespace surefoot::apps
