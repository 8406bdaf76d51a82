// `surefoot replay`: feeds a record back and compares everything that comes out.
#pragma once

#include <filesystem>
#include <string>

#include "apps/common/stack.h"

namespace surefoot::apps {

// 0: identical. 1: a tick differs, or the record is damaged (identical up to there or not). 2: not
// a readable record.
int replay(const std::string& record, const std::filesystem::path& out, Stack& stack);

}  // namespace surefoot::apps
