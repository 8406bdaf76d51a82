#include "apps/surefoot-lab/eval_terrain_fill.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "apps/common/statistics.h"
#include "apps/surefoot-lab/terrain/fields.h"
#include "apps/surefoot-lab/terrain/fill_methods.h"
#include "apps/surefoot-lab/terrain/fill_pictures.h"
#include "apps/surefoot-lab/terrain/improved_choice.h"

namespace surefoot::apps {
namespace {

using Scenes = std::vector<std::unique_ptr<ScannedTerrain>>;
using MethodScores = std::array<std::vector<FillScore>, kFillMethods>;  // by method and terrain

// Runs task(i, thread) for all i, in any order; the first error of a task is thrown on.
void in_parallel(std::size_t count, int jobs,
                 const std::function<void(std::size_t, std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  std::vector<std::string> errors(static_cast<std::size_t>(jobs));
  std::vector<std::thread> threads;
  for (std::size_t thread = 0; thread < errors.size(); ++thread) {
    threads.emplace_back([&, thread] {
      try {
        for (std::size_t i = next++; i < count; i = next++) task(i, thread);
      } catch (const std::exception& error) {
        errors[thread] = error.what();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& error : errors) {
    if (!error.empty()) throw std::runtime_error(error);
  }
}

std::vector<std::uint64_t> seeds_between(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
  return seeds;
}

Scenes scan_all(const TerrainFillOptions& options, const std::vector<std::uint64_t>& seeds,
                int cell_mm) {
  Scenes scenes(seeds.size());
  in_parallel(seeds.size(), options.jobs, [&](std::size_t i, std::size_t) {
    scenes[i] = scan(rock_terrain(options.cache, options.bodies, seeds[i]), cell_mm,
                     options.noise_m, seeds[i]);
  });
  return scenes;
}

MethodScores score_all(const Scenes& scenes, const FillMaterial& material, int jobs) {
  MethodScores scores;
  for (auto& of_method : scores) of_method.resize(scenes.size());
  std::vector<std::unique_ptr<FillWorker>> workers;
  for (int k = 0; k < jobs; ++k) workers.push_back(std::make_unique<FillWorker>(material));
  in_parallel(scenes.size(), jobs, [&](std::size_t i, std::size_t thread) {
    for (std::size_t m = 0; m < kFillMethods; ++m) {
      const auto method = static_cast<FillMethod>(m);
      const Completion completion = workers[thread]->complete(method, *scenes[i]);
      scores[m][i] = workers[thread]->score(method, *scenes[i], completion);
    }
    std::fprintf(stderr, "terrain %zu of %zu done\n", i + 1, scenes.size());
  });
  return scores;
}

double mean(const std::vector<FillScore>& scores, double FillScore::*metric) {
  double sum = 0;
  for (const FillScore& score : scores) sum += score.*metric;
  return scores.empty() ? 0 : sum / static_cast<double>(scores.size());
}

std::vector<double> column(const std::vector<FillScore>& scores, double FillScore::*metric) {
  std::vector<double> out;
  for (const FillScore& score : scores) out.push_back(score.*metric);
  return out;
}

nlohmann::ordered_json to_json(const std::vector<FillScore>& scores) {
  nlohmann::ordered_json json;
  bool occluded = true;
  std::int64_t violations = 0;
  for (const FillScore& score : scores) {
    occluded = occluded && score.has_occluded;
    violations += score.violations;
  }
  const auto or_null = [&](double value) {
    return occluded ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  json["cost_rmse_visible"] = mean(scores, &FillScore::cost_visible);
  json["cost_rmse_occluded"] = or_null(mean(scores, &FillScore::cost_occluded));
  json["height_rmse_occluded_m"] = or_null(mean(scores, &FillScore::height_occluded_m));
  json["sight_violations"] = violations;
  json["us_per_cell"] = mean(scores, &FillScore::us_per_cell);
  json["cost_rmse_near"] = mean(scores, &FillScore::cost_near);
  json["none_fits_share"] = mean(scores, &FillScore::none_fits_share);
  json["terrains"]["cost_rmse_visible"] = column(scores, &FillScore::cost_visible);
  if (occluded) {
    json["terrains"]["cost_rmse_occluded"] = column(scores, &FillScore::cost_occluded);
    json["terrains"]["height_rmse_occluded_m"] = column(scores, &FillScore::height_occluded_m);
  }
  return json;
}

// The one with the smallest mean, of those that are neither ours nor the paper's.
std::size_t best_other(const MethodScores& scores, double FillScore::*metric) {
  std::size_t best = kFillMethods;
  for (std::size_t m = 0; m < kFillMethods; ++m) {
    const auto method = static_cast<FillMethod>(m);
    if (method == FillMethod::kPaper || method == FillMethod::kImproved) continue;
    if (method == FillMethod::kIgnoreMissing && metric != &FillScore::cost_visible) continue;
    if (best == kFillMethods || mean(scores[m], metric) < mean(scores[best], metric)) best = m;
  }
  return best;
}

nlohmann::ordered_json compare(const MethodScores& scores, FillMethod method,
                               double FillScore::*metric) {
  const std::size_t other = best_other(scores, metric);
  const std::vector<FillScore>& ours = scores[static_cast<std::size_t>(method)];
  const std::vector<double> a = column(ours, metric);
  const std::vector<double> b = column(scores[other], metric);
  int wins = 0;
  for (std::size_t i = 0; i < a.size(); ++i) wins += a[i] < b[i] ? 1 : 0;
  const auto of = [&](FillMethod rival) {
    return mean(ours, metric) / mean(scores[static_cast<std::size_t>(rival)], metric);
  };
  nlohmann::ordered_json json;
  json["best_other"] = kFillMethodNames[other];
  json["ratio"] = mean(ours, metric) / mean(scores[other], metric);
  json["ratio_to_paper_rivals"] =
      std::max(of(FillMethod::kConstraintsAsHeights), of(FillMethod::kUnconstrained));
  json["wins"] = wins;
  json["p_value"] = paired_t_test(a, b);
  return json;
}

nlohmann::ordered_json shares(const Scenes& scenes) {
  double unseen = 0, unknown = 0, above = 0, all = 0;
  for (const auto& scene : scenes) {
    for (std::int32_t cell = 0; cell < scene->seen.size(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      const double row = cell / scene->seen.columns + 0.5 - 0.5 * scene->seen.rows;
      if (std::abs(row) * scene->seen.cell_m > kScoreHalfWidth_m) continue;
      all += 1;
      unknown += scene->seen.knowledge[i] == terrain::Knowledge::kUnknown ? 1 : 0;
      if (scene->seen.knowledge[i] != terrain::Knowledge::kBounded) continue;
      unseen += 1;
      above += scene->truth.value_m[i] > scene->seen.value_m[i] ? 1 : 0;
    }
  }
  return {{"unseen_share", unseen / all},
          {"unbounded_share", unknown / all},
          {"truth_above_ceiling_share", unseen > 0 ? above / unseen : 0.0}};
}

void print_table(const MethodScores& scores) {
  std::fputs(fmt::format("{:<24}{:>9}{:>9}{:>9}{:>9}{:>10}\n", "", "visible", "occluded", "mm",
                         "above", "us/cell")
                 .c_str(),
             stdout);
  for (std::size_t m = 0; m < kFillMethods; ++m) {
    std::int64_t above = 0;
    for (const FillScore& score : scores[m]) above += score.violations;
    std::fputs(fmt::format("{:<24}{:>9.4f}{:>9.4f}{:>9.2f}{:>9}{:>10.2f}\n", kFillMethodNames[m],
                           mean(scores[m], &FillScore::cost_visible),
                           mean(scores[m], &FillScore::cost_occluded),
                           1e3 * mean(scores[m], &FillScore::height_occluded_m), above,
                           mean(scores[m], &FillScore::us_per_cell))
                   .c_str(),
               stdout);
  }
}

// What was chosen for each library.
nlohmann::ordered_json to_json(const std::vector<ImprovedChoice>& improved) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ImprovedChoice& choice : improved) {
    json.push_back({{"patch_cells", choice.settings.patch_cells},
                    {"samples", choice.settings.samples},
                    {"draws", choice.settings.draws},
                    {"guide", choice.settings.guide},
                    {"prior_log_ratio", choice.log_ratio},
                    {"prior_log_ratio_error", choice.error}});
  }
  return json;
}

nlohmann::ordered_json report(const TerrainFillOptions& options, const Scenes& tests,
                              const std::vector<ImprovedChoice>& improved,
                              const MethodScores& scores) {
  nlohmann::ordered_json json;
  json["schema"] = 1;
  json["resolution_m"] = options.resolution_m;
  json["noise_m"] = options.noise_m;
  json["library_seeds"] = {options.first_library_seed, options.last_library_seed};
  json["test_seeds"] = {options.first_test_seed, options.last_test_seed};
  if (!options.terrain.empty()) {
    json["terrain"] = options.terrain.string();
    json["scale"] = options.scale;
    json["gaps"] = options.bridge_gaps ? "bridged" : "unknown";
  }
  json["cells"] = shares(tests);
  json["improved_settings"] = to_json(improved);
  for (std::size_t m = 0; m < kFillMethods; ++m) {
    json["methods"][kFillMethodNames[m]] = to_json(scores[m]);
  }
  const std::array<std::pair<const char*, double FillScore::*>, 3> metrics{
      {{"cost_rmse_visible", &FillScore::cost_visible},
       {"cost_rmse_occluded", &FillScore::cost_occluded},
       {"height_rmse_occluded_m", &FillScore::height_occluded_m}}};
  for (const auto& [name, metric] : metrics) {
    json["comparison"]["improved"][name] = compare(scores, FillMethod::kImproved, metric);
    json["comparison"]["paper"][name] = compare(scores, FillMethod::kPaper, metric);
  }
  json["p_value"] = json["comparison"]["improved"]["cost_rmse_visible"]["p_value"];
  return json;
}

void print_comparison(const nlohmann::ordered_json& json, std::size_t terrains) {
  for (const auto& [method, metrics] : json["comparison"].items()) {
    for (const auto& [metric, c] : metrics.items()) {
      std::fputs(fmt::format("{:<9} {:<23} {:.3f} x {} ({} of {}, p = {:.1e}), {:.3f} x the "
                             "paper's better rival\n",
                             method, metric, c["ratio"].get<double>(),
                             c["best_other"].get<std::string>(), c["wins"].get<int>(), terrains,
                             c["p_value"].get<double>(), c["ratio_to_paper_rivals"].get<double>())
                     .c_str(),
                 stdout);
    }
  }
}

bool write(const std::filesystem::path& out, const nlohmann::ordered_json& json,
           const FillPictures& pictures) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  const auto write_png = [&](const char* name, const Drawing& drawing) {
    const std::vector<std::uint8_t> png = to_png(drawing);
    std::ofstream file(out / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
    return file.good();
  };
  std::ofstream text(out / "terrain-fill.json");
  text << json.dump(2) << '\n';
  return write_png("terrain.png", pictures.terrain) && write_png("fills.png", pictures.fills) &&
         text.good();
}

FillMaterial learn(const Scenes& library, int cell_mm, std::vector<ImprovedChoice>& improved) {
  std::vector<const ScannedTerrain*> pieces;
  for (const auto& piece : library) pieces.push_back(piece.get());
  improved.push_back(choose_improved(pieces, cell_mm));
  return make_material(pieces, cell_mm, improved.back().settings);
}

int finish(const TerrainFillOptions& options, const Scenes& tests, const MethodScores& scores,
           const std::vector<ImprovedChoice>& improved, const FillMaterial& material) {
  const nlohmann::ordered_json json = report(options, tests, improved, scores);
  print_table(scores);
  std::fputs(fmt::format("improved_settings {}\n", json["improved_settings"].dump()).c_str(),
             stdout);
  print_comparison(json, tests.size());
  FillWorker worker(material);
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path("out/eval-terrain-fill") : options.out;
  if (!write(out, json, draw_fills(worker, *tests.back()))) {
    std::fputs(fmt::format("{}: cannot be written\n", out.string()).c_str(), stderr);
    return 3;
  }
  std::fputs(fmt::format("{}\n", (out / "terrain-fill.json").string()).c_str(), stdout);
  return 0;
}

int run_rock_fields(const TerrainFillOptions& options, int cell_mm) {
  const std::vector<std::uint64_t> library_seeds =
      seeds_between(options.first_library_seed, options.last_library_seed);
  const std::vector<std::uint64_t> test_seeds =
      seeds_between(options.first_test_seed, options.last_test_seed);
  std::vector<std::uint64_t> all = library_seeds;
  all.insert(all.end(), test_seeds.begin(), test_seeds.end());
  if (!prepare_fields(options.cache, options.bodies, all, options.jobs)) return 3;
  std::vector<ImprovedChoice> improved;
  const FillMaterial material = learn(scan_all(options, library_seeds, cell_mm), cell_mm, improved);
  const Scenes tests = scan_all(options, test_seeds, cell_mm);
  const MethodScores scores = score_all(tests, material, options.jobs);
  return finish(options, tests, scores, improved, material);
}

int run_recorded(const TerrainFillOptions& options, int cell_mm) {
  const std::vector<FineTerrain> pieces = recorded_terrain(options.terrain, options.scale);
  Scenes tests;
  MethodScores scores;
  std::vector<ImprovedChoice> improved;
  for (std::size_t fold = 0; fold < 2; ++fold) {
    Scenes library;
    Scenes half;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      Scenes& to = k / 2 == fold ? library : half;
      to.push_back(scan(pieces[k], cell_mm, options.noise_m, k));
      if (!options.bridge_gaps) forget_gaps(*to.back());
    }
    const FillMaterial material = learn(library, cell_mm, improved);
    const MethodScores of_half = score_all(half, material, options.jobs);
    for (std::size_t m = 0; m < kFillMethods; ++m) {
      scores[m].insert(scores[m].end(), of_half[m].begin(), of_half[m].end());
    }
    for (auto& scene : half) tests.push_back(std::move(scene));
    if (fold == 1) return finish(options, tests, scores, improved, material);
  }
  return 0;
}

}  // namespace

int eval_terrain_fill(const TerrainFillOptions& options) {
  const auto cell_mm = static_cast<int>(std::lround(1e3 * options.resolution_m));
  if (cell_mm < 5 || cell_mm > 40 || std::abs(1e-3 * cell_mm - options.resolution_m) > 1e-9) {
    std::fputs("--resolution: 0.005 to 0.04, in whole millimetres\n", stderr);
    return 2;
  }
  try {
    return options.terrain.empty() ? run_rock_fields(options, cell_mm)
                                   : run_recorded(options, cell_mm);
  } catch (const std::exception& error) {
    std::fputs(fmt::format("terrain-fill: {}\n", error.what()).c_str(), stderr);
    return 2;
  }
}

}  // namespace surefoot::apps
