// Runs one piece of a tick with fixed inputs, so that callgrind can count its instructions.
//
//   task_work            lists the cases
//   task_work CASE       runs one and says how long its rounds took, once and with cold caches;
//                        exit code 1 when it did not do the work that it stands for
//
// Counting is limited to measured_region (valgrind --toggle-collect=measured_region).
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/timing/work_case.h"

extern "C" [[gnu::noinline]] void measured_region(surefoot::timing::WorkCase* work) {
  work->run();
  asm volatile("" ::: "memory");  // no tail call: the region ends here
}

namespace surefoot::timing {
namespace {

constexpr std::array kTables{kControlCases,   kModuleCases,  kMpcCases,          kDynamicsCases,
                             kJumpCases,      kMappingCases, kRegistrationCases, kObstacleCases,
                             kExecutiveCases, kStereoCases,  kPlanningCases,     kGroundCases,
                             kNavigationCases};

int list() {
  for (const WorkEntry* table : kTables) {
    for (const WorkEntry* entry = table; entry->name != nullptr; ++entry) {
      std::printf("%s\t%s\n", entry->name, entry->what);
    }
  }
  return 0;
}

int run(const WorkEntry& entry) {
  const std::unique_ptr<WorkCase> work = entry.make();
  std::chrono::duration<double, std::micro> spent{};
  std::size_t round = 0;
  for (; work->prepare(round); ++round) {
    const auto begin = std::chrono::steady_clock::now();
    measured_region(work.get());
    spent += std::chrono::steady_clock::now() - begin;
  }
  if (work->did_the_work()) {
    std::printf("%-20s %4zu rounds %10.1f us\n", entry.name, round, spent.count());
    return 0;
  }
  std::fprintf(stderr, "%s: did not do the work that it stands for\n", entry.name);
  return 1;
}

}  // namespace

apps::Config load(const std::vector<std::string>& sets) {
  const apps::RunRequest request{"mini_cheetah", "flat", "cross", "sim", 1, sets};
  apps::ConfigIssues issues;
  apps::Config config = apps::load_config(request, SUREFOOT_SOURCE_DIR "/config", issues);
  if (!issues.empty()) {
    std::fputs(to_string(issues).c_str(), stderr);
    std::exit(2);
  }
  return config;
}

}  // namespace surefoot::timing

int main(int argc, char** argv) {
  using namespace surefoot::timing;
  if (argc < 2) return list();
  for (const WorkEntry* table : kTables) {
    for (const WorkEntry* entry = table; entry->name != nullptr; ++entry) {
      if (std::strcmp(entry->name, argv[1]) == 0) return run(*entry);
    }
  }
  std::fprintf(stderr, "no case '%s'\n", argv[1]);
  return 2;
}
