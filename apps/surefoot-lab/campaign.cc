#include "apps/surefoot-lab/campaign.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>

#include "apps/common/run.h"

extern char** environ;

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class Campaign {
 public:
  explicit Campaign(const CampaignOptions& options)
      : options_(options), results_(options.seeds.count()), begin_(Clock::now()) {}

  // False: a process could not be started.
  bool run_all(const fs::path& folder) {
    folder_ = folder;
    std::size_t started = 0;
    while (done_ < results_.size()) {
      while (started < results_.size() &&
             running_.size() < static_cast<std::size_t>(options_.jobs)) {
        if (!start(started)) return false;
        ++started;
      }
      collect_one();
      show();
    }
    std::fputs("\n", stderr);
    return true;
  }

  const std::vector<Json>& results() const { return results_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t seed(std::size_t index) const { return options_.seeds.first + index; }
  fs::path folder(std::size_t index) const { return folder_ / fmt::format("seed-{}", seed(index)); }

  std::vector<std::string> arguments(std::size_t index) const {
    const RunRequest& request = options_.request;
    std::vector<std::string> list{surefoot_binary().string(),
                                  "run",
                                  "--robot",
                                  request.robot,
                                  "--world",
                                  request.world,
                                  "--mission",
                                  request.mission,
                                  "--hal",
                                  request.hal,
                                  "--seed",
                                  std::to_string(seed(index)),
                                  "--out",
                                  folder(index).string(),
                                  "--record",
                                  options_.record == "off" ? "off" : "on",
                                  "--report",
                                  options_.record == "all" ? "on" : "failures",
                                  "--quiet"};
    for (const std::string& set : request.sets) {
      list.push_back("--set");
      list.push_back(set);
    }
    return list;
  }

  bool start(std::size_t index) {
    std::error_code error;
    fs::create_directories(folder(index), error);
    fs::remove(folder(index) / "summary.json", error);
    std::vector<std::string> list = arguments(index);
    std::vector<char*> pointers;
    for (std::string& argument : list) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const std::string log = (folder(index) / "run.log").string();
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    pid_t child = 0;
    const int failed =
        posix_spawn(&child, list[0].c_str(), &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed == 0) running_[child] = index;
    return failed == 0;
  }

  void collect_one() {
    int status = 0;
    const pid_t child = waitpid(-1, &status, 0);
    const auto found = running_.find(child);
    if (found == running_.end()) return;
    results_[found->second] = result_of(found->second, status);
    running_.erase(found);
    ++done_;
  }

  Json result_of(std::size_t index, int status) {
    std::ifstream file(folder(index) / "summary.json");
    Json summary = Json::parse(file, nullptr, false);
    if (summary.is_discarded()) {
      const std::string how =
          WIFSIGNALED(status)
              ? fmt::format("the process ended by signal {}", WTERMSIG(status))
              : fmt::format("the process ended with code {} and no summary", WEXITSTATUS(status));
      summary = {{"seed", seed(index)}, {"outcome", "fault"}, {"reason", how}};
    }
    const bool goal = summary.value("outcome", "") == "goal";
    goals_ += goal ? 1 : 0;
    std::error_code error;
    if (goal && options_.record == "failures") fs::remove(folder(index) / "record.mcap", error);
    if (!goal) {
      std::fputs(fmt::format("\rseed {}: {}: {}{:20}\n", seed(index), summary.value("outcome", ""),
                             summary.value("reason", ""), "")
                     .c_str(),
                 stderr);
    }
    return summary;
  }

  void show() const {
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
    const double left =
        elapsed / static_cast<double>(done_) * static_cast<double>(results_.size() - done_);
    std::fputs(fmt::format("\r{} of {} runs, {} at the goal, {:.0f} s left   ", done_,
                           results_.size(), goals_, left)
                   .c_str(),
               stderr);
    std::fflush(stderr);
  }

  const CampaignOptions& options_;
  fs::path folder_;
  std::vector<Json> results_;
  std::map<pid_t, std::size_t> running_;
  std::size_t done_ = 0;
  std::size_t goals_ = 0;
  Clock::time_point begin_;
};

fs::path default_folder(const RunRequest& request) {
  const std::string world = request.world.substr(0, request.world.find_first_of(":/."));
  return fs::path("out") /
         fmt::format("campaign-{}-{}", world, fs::path(request.mission).stem().string());
}

}  // namespace

fs::path surefoot_binary() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / "surefoot";
}

int campaign(const CampaignOptions& options) {
  ConfigIssues issues;
  load_config(options.request, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  const fs::path folder = options.out.empty() ? default_folder(options.request) : options.out;
  Campaign campaign(options);
  if (!campaign.run_all(folder)) {
    std::fputs(fmt::format("{}: cannot be started\n", surefoot_binary().string()).c_str(), stderr);
    return 3;
  }
  const Json json = campaign_json(campaign.results());
  std::ofstream file(folder / "campaign.json");
  file << json.dump(2) << "\n";
  file.close();
  std::fputs(
      fmt::format("{} of {} at the goal ({:.0f} %, 95 % interval {:.0f} to {:.0f} %), median "
                  "{:.2f} m/s\n{}\n",
                  json["outcomes"]["goal"].get<int>(), options.seeds.count(),
                  100 * json["success_rate"].get<double>(), 100 * json["wilson95"][0].get<double>(),
                  100 * json["wilson95"][1].get<double>(), json["median_speed_m_s"].get<double>(),
                  (folder / "campaign.json").string())
          .c_str(),
      stdout);
  return file ? 0 : 3;
}

}  // namespace surefoot::apps
