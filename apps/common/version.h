// What was built.
#pragma once

#include <string>

namespace surefoot::apps {

std::string version_text();  // "0.1.0+a1b2c3d", the commit where git knows it
std::string build_text();    // compiler, flags, target

}  // namespace surefoot::apps
