// The pictures of a run and report.html, which holds them all and opens from disk with no network.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/drawing.h"
#include "apps/common/summary.h"

namespace surefoot::apps {

struct NamedDrawing {
  std::string name;     // file NAME.png
  std::string caption;  // one sentence under the picture
  Drawing drawing;
};

// Writes NAME.png of every drawing and report.html into `folder`. False: something could not be
// written; `problem` says what.
bool write_report(const std::filesystem::path& folder, const RunFacts& facts,
                  const std::vector<NamedDrawing>& drawings, const std::string& config_text,
                  std::string& problem);

}  // namespace surefoot::apps
