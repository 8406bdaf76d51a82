// `surefoot can-replay`: what a recorded bus says about the joints.
#pragma once

#include <filesystem>
#include <string>

#include "apps/common/config_root.h"

namespace surefoot::apps {

// Reads a `candump -L` log of the robot's buses (can0, can1, ...), decodes it as the robot would,
// runs the contact estimation's kinematics on it and writes OUT/joints.csv: one row per tick of 2
// ms in which a frame came. 0: done (malformed lines are reported with their number). 1: no frame
// in the whole log. 2: wrong use or configuration. 3: joints.csv could not be written.
int can_replay(const std::string& log, const RunRequest& request, const std::filesystem::path& out);

}  // namespace surefoot::apps
