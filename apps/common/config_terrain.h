// The terrain model that a robot's file names, put in place of its name.
#pragma once

#include "apps/common/config_node.h"

namespace surefoot::apps {

// `terrain.model: FILE` of the tree becomes what that file holds (core/terrain/terrain_model.h).
// The name is relative to the folder of the file that names it; a number is reported with the line
// of the model's file it stands in.
void load_terrain(ConfigNode& tree, ConfigIssues& issues);

}  // namespace surefoot::apps
