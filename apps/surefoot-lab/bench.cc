#include "apps/surefoot-lab/bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/common/figures.h"
#include "apps/common/run.h"
#include "apps/surefoot-lab/bench_mapping.h"
#include "apps/surefoot-lab/bench_mpc.h"
#include "apps/surefoot-lab/bench_navigation.h"
#include "apps/surefoot-lab/bench_stereo.h"
#include "apps/surefoot-lab/bench_terrain.h"
#include "apps/surefoot-lab/eval_registration.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

int bench_run(Stack& stack) {
  RunOptions options;
  options.request = {"mini_cheetah", "clutter", "cross", "sim", 1, {}};
  options.out = fs::temp_directory_path() / fmt::format("surefoot-bench-{}", getpid());
  options.record = false;
  options.report = Keep::kNever;
  options.quiet = true;
  const int code = run(options, stack);
  std::ifstream file(options.out / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(file, nullptr, false);
  std::error_code error;
  fs::remove_all(options.out, error);
  if (code > 1 || summary.is_discarded()) return 3;
  print(fmt::format("run: clutter, seed 1: {:.1f} s simulated in {:.1f} s, {:.2f} x real time\n",
                    summary["sim_time_s"].get<double>(), summary["wall_time_s"].get<double>(),
                    summary["real_time_factor"].get<double>()));
  print(fmt::format("  {:<10} {:>8} {:>10} {:>10} {:>10} {:>10}\n", "task", "runs", "median us",
                    "99 % us", "max us", "budget us"));
  for (const auto& task : summary["tasks"]) {
    print(fmt::format("  {:<10} {:>8} {:>10.0f} {:>10.0f} {:>10.0f} {:>10}\n",
                      task["name"].get<std::string>(), task["count"].get<std::uint64_t>(),
                      task["p50_us"].get<double>(), task["p99_us"].get<double>(),
                      task["max_us"].get<double>(), task["budget_us"].get<std::uint64_t>()));
  }
  return 0;
}

int bench_pictures() {
  const RunLog log(1, true);
  TerrainFigure figure;
  figure.truth = HeightGrid(-0.6, -0.75, 4.2, 1.5, 0.015);
  figure.perceived = figure.truth;
  figure.classes = ClassGrid(figure.truth);
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t bytes = to_png(terrain_figure(log, figure)).size();
  const double ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  print(fmt::format("pictures: terrain map in {:.0f} ms ({} bytes)\n", ms, bytes));
  return 0;
}

}  // namespace

int bench(const std::string& name, Stack& stack) {
  constexpr std::array kNames{"run", "pictures", "mapping", "registration",
                              "mpc", "stereo",   "terrain", "navigation"};
  if (!name.empty() && std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
    std::fputs(fmt::format("bench: '{}' is unknown; there are: {}\n", name, fmt::join(kNames, " "))
                   .c_str(),
               stderr);
    return 2;
  }
  int worst = 0;
  if (name.empty() || name == "pictures") bench_pictures();
  if (name.empty() || name == "mapping") worst = bench_mapping();
  if (name.empty() || name == "registration") worst = std::max(worst, bench_registration());
  if (name.empty() || name == "mpc") worst = std::max(worst, bench_mpc());
  if (name.empty() || name == "stereo") worst = std::max(worst, bench_stereo());
  if (name.empty() || name == "terrain") worst = std::max(worst, bench_terrain());
  if (name.empty() || name == "navigation") worst = std::max(worst, bench_navigation());
  if (name.empty() || name == "run") worst = std::max(worst, bench_run(stack));
  return worst;
}

}  // namespace surefoot::apps
