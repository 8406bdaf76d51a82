// Motion files (config/motions/NAME.yaml): group `motion`, read and checked.
#pragma once

#include <filesystem>
#include <string>

#include "apps/common/config_node.h"
#include "core/motions/motion.h"

namespace surefoot::apps {

// Hash, 16 hex digits, of the canonical text of all that a motion holds.
std::string motion_checksum(const motions::Motion& motion);

// The motion of a file. What is wrong (a key, a range, the version, the checksum) is an issue with
// file, line and key.
motions::Motion read_motion_file(const std::filesystem::path& file, ConfigIssues& issues);

}  // namespace surefoot::apps
