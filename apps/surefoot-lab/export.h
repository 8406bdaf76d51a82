// `surefoot-lab export`: a record in other people's formats.
#pragma once

#include <filesystem>
#include <string>

#include "apps/common/stack.h"

namespace surefoot::apps {

// to: candump (can.log), csv (ticks.csv: every scalar of inputs and telemetry but the CAN frames,
// one row per tick) or html (report.html and pictures, by replaying the record; no ground truth).
// out: a folder, or empty for the record's own. 0: done. 1: the record is damaged, what lies before
// the damage was converted. 2: wrong use. 3: cannot be written.
int export_record(const std::string& record, const std::string& to,
                  const std::filesystem::path& out, Stack& stack);

}  // namespace surefoot::apps
