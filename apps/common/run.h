// One run from start to summary: what `surefoot run` does.
#pragma once

#include <cstdint>
#include <filesystem>

#include "apps/common/config_root.h"
#include "apps/common/stack.h"

namespace surefoot::apps {

enum class Keep : std::uint8_t { kNever, kFailures, kAlways };

struct RunOptions {
  RunRequest request;
  std::filesystem::path out;    // empty: a new folder under out/
  bool record = true;           // record.mcap
  bool can_log = false;         // can.log
  Keep report = Keep::kAlways;  // report.html and *.png
  bool realtime = false;        // hold the simulation back to real time
  bool quiet = false;           // no progress, no verdict
};

// The program's exit code: 0 goal, 1 not, 2 wrong use or configuration, 3 fault (of the robot, or
// of this program: nothing could be written).
int run(const RunOptions& options, Stack& stack);

// Prints the issues to standard error; the exit code for wrong configuration.
int refuse(const ConfigIssues& issues);

}  // namespace surefoot::apps
