// campaign.json of a list of summaries.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace surefoot::apps {

struct SeedRange {
  std::uint64_t first = 1;
  std::uint64_t last = 1;  // included

  std::size_t count() const { return static_cast<std::size_t>(last - first + 1); }
};

// "1..20" or "7". Empty: not a range, or more than a million runs.
std::optional<SeedRange> parse_seeds(const std::string& text);

// `runs`: summaries in the order of their seeds. success_rate: share of outcome goal, with its
// Wilson interval. median_speed_m_s: of the runs that reached the goal, 0 when none did.
nlohmann::ordered_json campaign_json(const std::vector<nlohmann::ordered_json>& runs);

}  // namespace surefoot::apps
