#include "apps/surefoot/replay_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/common/run.h"
#include "apps/common/summary.h"
#include "apps/common/version.h"
#include "hal/replay/replay_board.h"
#include "hal/replay/replay_comparer.h"

namespace surefoot::apps {
namespace {

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

bool write_result(const std::filesystem::path& folder, const nlohmann::ordered_json& result) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::ofstream file(folder / "replay.json");
  file << result.dump(2) << "\n";
  file.close();
  return static_cast<bool>(file);
}

}  // namespace

int replay(const std::string& record, const std::filesystem::path& out, Stack& stack) {
  hal::ReplayBoard board;
  if (!ok(board.open(record))) {
    std::fputs(fmt::format("{}: {}\n", record, board.message()).c_str(), stderr);
    return 2;
  }
  RunRequest request;
  Config config;
  ConfigIssues issues;
  read_record_text(board.configuration(), request, config, issues);
  if (!issues.empty()) return refuse(issues);

  runtime::RecordedRunner runner(nullptr, board.overruns());
  if (const Status status =
          stack.start(config, board.board(autonomy::kTickPeriod), runner, nullptr);
      !ok(status)) {
    std::fputs(
        fmt::format("{}: the autonomy refuses the configuration: {}\n", record, to_string(status))
            .c_str(),
        stderr);
    return 2;
  }
  hal::ReplayComparer comparer;
  const runtime::Executive& executive = stack.executive();
  while (comparer.identical() && ok(stack.executive().run_tick())) {
    comparer.compare(executive.inputs(), executive.outputs(), executive.hash(), board.recorded());
  }

  const bool complete = board.end() == hal::ReplayEnd::kComplete;
  nlohmann::ordered_json result{{"record", record},
                                {"identical", comparer.identical()},
                                {"complete", complete},
                                {"ticks", comparer.ticks_compared()},
                                {"hash", hex16(executive.hash())},
                                {"version", version_text()}};
  if (comparer.identical()) {
    print(fmt::format("identical, {} ticks, hash {}\n", comparer.ticks_compared(),
                      hex16(executive.hash())));
    if (!complete) print(board.message() + "\n");
    result["message"] = board.message();
  } else {
    const hal::ReplayDifference& first = comparer.difference();
    print(fmt::format("different at tick {}, {}: recorded {}, replayed {}\n", first.tick,
                      first.field, first.recorded, first.replayed));
    result["difference"] = {{"tick", first.tick},
                            {"field", first.field},
                            {"recorded", first.recorded},
                            {"replayed", first.replayed}};
  }
  if (!out.empty() && !write_result(out, result)) {
    std::fputs(fmt::format("{}: cannot be written\n", (out / "replay.json").string()).c_str(),
               stderr);
    return 3;
  }
  return comparer.identical() && complete ? 0 : 1;
}

}  // namespace surefoot::apps
