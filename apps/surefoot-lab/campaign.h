// `surefoot-lab campaign`: many runs, each its own process of the surefoot binary.
#pragma once

#include <filesystem>
#include <string>

#include "apps/common/campaign_result.h"
#include "apps/common/config_root.h"

namespace surefoot::apps {

struct CampaignOptions {
  RunRequest request;  // the seed is set per run
  SeedRange seeds;
  int jobs = 1;
  std::filesystem::path out;        // empty: out/campaign-WORLD-MISSION
  std::string record = "failures";  // off, failures, all
};

// Writes OUT/campaign.json, and OUT/seed-N/ with summary.json, run.log, and record and report of
// the runs that did not reach their goal. 0: every run was made, however it ended. 2: wrong use or
// configuration. 3: a file could not be written or no process started.
int campaign(const CampaignOptions& options);

// The surefoot binary beside this program.
std::filesystem::path surefoot_binary();

}  // namespace surefoot::apps
