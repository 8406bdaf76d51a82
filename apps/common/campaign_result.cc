#include "apps/common/campaign_result.h"

#include "apps/common/config_values.h"
#include "apps/common/statistics.h"

namespace surefoot::apps {

using Json = nlohmann::ordered_json;

std::optional<SeedRange> parse_seeds(const std::string& text) {
  constexpr std::int64_t kMostRuns = 1'000'000;
  const std::size_t dots = text.find("..");
  const auto first = parse_integer(text.substr(0, dots));
  const auto last = dots == std::string::npos ? first : parse_integer(text.substr(dots + 2));
  if (!first || !last || *first < 0 || *last < *first || *last - *first >= kMostRuns) return {};
  return SeedRange{static_cast<std::uint64_t>(*first), static_cast<std::uint64_t>(*last)};
}

Json campaign_json(const std::vector<Json>& runs) {
  static constexpr const char* kOutcomes[] = {"goal",    "fall",    "collision", "live_lock",
                                              "no_path", "timeout", "fault",     "aborted"};
  Json outcomes = Json::object();
  for (const char* outcome : kOutcomes) outcomes[outcome] = 0;
  std::vector<double> speeds;
  for (const Json& run : runs) {
    const std::string outcome = run.value("outcome", "fault");
    outcomes[outcome] = outcomes.value(outcome, 0) + 1;
    if (outcome == "goal") speeds.push_back(run.value("mean_speed_m_s", 0.0));
  }
  const auto interval = wilson95(speeds.size(), runs.size());
  Json json;
  json["schema"] = 1;
  json["count"] = runs.size();
  json["outcomes"] = outcomes;
  json["success_rate"] =
      runs.empty() ? 0.0 : static_cast<double>(speeds.size()) / static_cast<double>(runs.size());
  json["wilson95"] = {interval[0], interval[1]};
  json["median_speed_m_s"] = median(speeds);
  json["runs"] = runs;
  return json;
}

}  // namespace surefoot::apps
