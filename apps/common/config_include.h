// A file that another one names: calibrations, terrain models.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/common/config_node.h"

namespace surefoot::apps {

// The file that `name` says, relative to the folder of `source`; none: there is no such file, which
// is reported at `name` under `key`. `what`: "calibration", for the message.
std::optional<std::filesystem::path> named_file(const ConfigNode& name, const std::string& source,
                                                const std::string& key, const char* what,
                                                ConfigIssues& issues);

}  // namespace surefoot::apps
