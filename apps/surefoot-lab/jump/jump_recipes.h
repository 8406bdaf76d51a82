// The jumps of config/motions, by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot-lab/jump/jump_settings.h"

namespace surefoot::apps::jump {

std::vector<std::string> recipe_names();
std::optional<JumpSettings> recipe(const std::string& name);

}  // namespace surefoot::apps::jump
