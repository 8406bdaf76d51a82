#include "apps/surefoot-lab/terrain/fill_methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/surefoot-lab/stopwatch.h"

namespace surefoot::apps {
namespace {

using terrain::CostConfig;
using terrain::FillConfig;
using terrain::FilledState;
using terrain::HeightView;
using terrain::Knowledge;
using terrain::TerrainGrid;

constexpr double kScalePercentile = 0.95;
constexpr double kNear_m = 0.02;
constexpr int kFineCell_mm = 7;  // below: fine cells, whose fill has to be smoothed

// Sums over cells of guesses and truths.
struct Errors {
  double count = 0;
  double squares = 0;
  double true_sum = 0;
  double true_squares = 0;

  void add(double guess, double truth) {
    count += 1;
    squares += (guess - truth) * (guess - truth);
    true_sum += truth;
    true_squares += truth * truth;
  }
  double rms() const { return count > 0 ? std::sqrt(squares / count) : 0; }
  // Of the truth: the error of the best constant.
  double deviation() const {
    if (!(count > 0)) return 0;
    return std::sqrt(std::max(true_squares / count - true_sum * true_sum / (count * count), 0.0));
  }
};

std::vector<FilledState> states(const TerrainGrid& grid, bool filled) {
  std::vector<FilledState> out(static_cast<std::size_t>(grid.size()), FilledState::kUnknown);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (grid.knowledge[i] == Knowledge::kMeasured) out[i] = FilledState::kMeasured;
    if (grid.knowledge[i] == Knowledge::kBounded && filled) out[i] = FilledState::kFilled;
  }
  return out;
}

Heights copy(const HeightView& view) {
  Heights heights;
  heights.reserve(static_cast<std::size_t>(view.columns * view.rows));
  for (std::int32_t row = 0; row < view.rows; ++row) {
    const float* begin = view.height_m + row * view.pitch;
    heights.insert(heights.end(), begin, begin + view.columns);
  }
  return heights;
}

HeightView view_of(const Heights& heights, const std::vector<FilledState>& state,
                   const TerrainGrid& grid) {
  return {heights.data(), state.data(), grid.columns, grid.rows, grid.columns, grid.cell_m};
}

std::array<terrain::FeatureCost*, terrain::kCostFeatures> features_of(CostConfig& config) {
  return {&config.slope, &config.height_difference, &config.deviation, &config.roughness};
}

// The values that kScalePercentile of the library's cells stay below.
void set_scales(const std::vector<const ScannedTerrain*>& library, CostConfig& config) {
  const auto map = std::make_unique<terrain::CostMap>();
  if (!ok(map->configure(config)) || !ok(map->start())) throw std::runtime_error("cost");
  std::array<std::array<std::vector<double>, terrain::kCostWindows>, terrain::kCostFeatures> all;
  for (const ScannedTerrain* piece : library) {
    const Heights heights(piece->truth.value_m.begin(),
                          piece->truth.value_m.begin() + piece->truth.size());
    const std::vector<FilledState> state = states(piece->truth, true);
    if (!ok(map->add(view_of(heights, state, piece->truth)))) throw std::runtime_error("cost");
    for (std::int32_t row = 0; row < piece->truth.rows; ++row) {
      for (std::int32_t column = 0; column < piece->truth.columns; ++column) {
        if (state[piece->truth.index(column, row)] == FilledState::kUnknown) continue;
        const terrain::CellFeatures features = map->features(column, row);
        for (std::size_t w = 0; w < terrain::kCostWindows; ++w) {
          const auto values = features[w].values();
          for (std::size_t k = 0; k < values.size(); ++k) all[k][w].push_back(values[k]);
        }
      }
    }
  }
  const auto targets = features_of(config);
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (std::size_t w = 0; w < terrain::kCostWindows; ++w) {
      std::vector<double>& values = all[k][w];
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                           kScalePercentile * static_cast<double>(values.size()));
      std::nth_element(values.begin(), at, values.end());
      targets[k]->scale[w] = std::max(*at, 1e-6);
    }
  }
}

std::unique_ptr<terrain::PatchLibrary> make_library(
    const std::vector<const ScannedTerrain*>& pieces, int patch_cells) {
  auto library = std::make_unique<terrain::PatchLibrary>();
  Status status = library->reset(pieces.front()->truth.cell_m, patch_cells);
  std::uint64_t number = 0;
  for (const ScannedTerrain* piece : pieces) {
    if (!ok(status)) break;
    terrain::Provenance provenance;
    std::copy_n("library terrain", 15, provenance.source.begin());
    provenance.seed = number++;
    status = library->add(provenance, piece->truth.columns, piece->truth.rows, piece->truth.cell_m,
                          piece->truth.value_m);
  }
  if (!ok(status)) {
    throw std::runtime_error(fmt::format("library of {} terrains: {}; {} heights fit",
                                         pieces.size(), to_string(status),
                                         terrain::kMaxLibraryCells));
  }
  return library;
}

}  // namespace

FillConfig paper_config(int cell_mm) {
  FillConfig config;
  config.rule = terrain::SightRule::kPenalty;
  config.order = terrain::FillOrder::kFarFirst;
  config.patch_cells = cell_mm < kFineCell_mm ? 15 : 9;
  config.samples = 1000;
  config.draws = 1;
  config.weight_deviation = 0.25;
  config.penalty = 1;
  if (cell_mm < kFineCell_mm) {
    config.smoothing_sweeps = 10;
    config.smoothing_hold = 2;
  }
  config.seed = 1;
  return config;
}

FillConfig literal_config(int cell_mm) {
  FillConfig config = paper_config(cell_mm);
  config.rule = terrain::SightRule::kReject;
  config.order = terrain::FillOrder::kRaster;
  config.smoothing_sweeps = 0;
  return config;
}

FillConfig unconstrained_config(int cell_mm) {
  FillConfig config = literal_config(cell_mm);
  config.rule = terrain::SightRule::kNone;
  return config;
}

// At 1 cm chosen on the seeds 1..10 alone (seven to learn from, three to look at), at 5 mm on 1..20
// (the same, then ten and ten); README.md of core/terrain has the figures.
FillConfig improved_config(int cell_mm) {
  FillConfig config = paper_config(cell_mm);
  const bool fine = cell_mm < kFineCell_mm;
  config.patch_cells = fine ? 7 : 3;
  config.samples = fine ? 100 : 30;
  config.draws = 8;
  config.weight_deviation = fine ? 0.8 : 0.4;
  config.guide = fine ? 2 : 3;
  if (fine) config.smoothing_hold = 3;
  return config;
}

FillConfig drawn_config(int cell_mm) {
  FillConfig config = paper_config(cell_mm);
  config.samples = cell_mm < kFineCell_mm ? 100 : 300;
  config.draws = 8;
  return config;
}

PriorOptions prior_options(int cell_mm) {
  PriorOptions options;
  options.stride = cell_mm < kFineCell_mm ? 2 : 1;
  return options;
}

CostConfig cost_config(int cell_mm) {
  CostConfig config;
  config.radius_cells =
      cell_mm < kFineCell_mm ? std::array{2.0, 4.0, 8.0} : std::array{1.0, 2.0, 4.0};
  for (terrain::FeatureCost* feature : features_of(config)) {
    feature->scale.fill(1);
    feature->weight.fill(1);
  }
  return config;
}

FillMaterial make_material(const std::vector<const ScannedTerrain*>& library, int cell_mm,
                           const FillConfig& improved) {
  if (library.empty()) throw std::runtime_error("the library is empty");
  FillMaterial material;
  material.cell_mm = cell_mm;
  material.cost = cost_config(cell_mm);
  set_scales(library, material.cost);
  material.prior = train_prior(library, prior_options(cell_mm));
  if (!material.prior.exists()) throw std::runtime_error("the library has no unseen cells");
  material.wide = make_library(library, paper_config(cell_mm).patch_cells);
  material.improved = improved;
  material.improving = make_library(library, improved.patch_cells);
  return material;
}

FillWorker::FillWorker(const FillMaterial& material) : material_(material) {
  if (!ok(map_->configure(material.cost))) throw std::runtime_error("cost configuration");
}

void FillWorker::synthesise(const FillConfig& config, const terrain::PatchLibrary& library,
                            const TerrainGrid& grid, Completion& out) {
  Status status = filler_->configure(config);
  if (ok(status)) status = filler_->start(grid, library, material_.prior, 0);
  if (!ok(status)) throw std::runtime_error(fmt::format("fill: {}", to_string(status)));
  while (!filler_->advance(1 << 20)) {
  }
  for (std::int32_t draw = 0; draw < config.draws; ++draw) {
    out.draws.push_back(copy(filler_->draw(draw)));
  }
  const terrain::FilledTerrain& filled = filler_->result();
  out.mean = copy(terrain::view_of(filled));
  out.spread.assign(filled.spread_m.begin(), filled.spread_m.begin() + grid.size());
  out.none_fits = filler_->counts().none_fits;
}

Completion FillWorker::complete(FillMethod method, const ScannedTerrain& scene) {
  const TerrainGrid& grid = scene.seen;
  const int cell = material_.cell_mm;
  Completion out;
  out.state = states(grid, method != FillMethod::kIgnoreMissing);
  const double begin_us = processor_us();
  switch (method) {
    case FillMethod::kPaperLiteral:
      synthesise(literal_config(cell), *material_.wide, grid, out);
      break;
    case FillMethod::kPaper: synthesise(paper_config(cell), *material_.wide, grid, out); break;
    case FillMethod::kImproved:
      synthesise(material_.improved, *material_.improving, grid, out);
      break;
    case FillMethod::kUnconstrained:
      synthesise(unconstrained_config(cell), *material_.wide, grid, out);
      break;
    case FillMethod::kIgnoreMissing:
    case FillMethod::kConstraintsAsHeights: out.mean = fill_with_ceilings(grid); break;
    case FillMethod::kBestConstant: {
      double sum = 0;
      double count = 0;
      for (std::size_t i = 0; i < out.state.size(); ++i) {
        if (grid.knowledge[i] != Knowledge::kBounded || !is_scored(grid, i) ||
            scene.truth.knowledge[i] != Knowledge::kMeasured) {
          continue;
        }
        sum += static_cast<double>(scene.truth.value_m[i]);
        count += 1;
      }
      out.mean = fill_with_constant(grid, count > 0 ? static_cast<float>(sum / count) : 0.0f);
      break;
    }
    case FillMethod::kClippedInpainting: out.mean = fill_by_inpainting(grid); break;
    case FillMethod::kMinimumSpread: out.mean = fill_with_minimum(grid); break;
    case FillMethod::kSmoothedMinimumSpread: out.mean = fill_with_smoothed_minimum(grid); break;
  }
  out.seconds = 1e-6 * (processor_us() - begin_us);
  if (out.draws.empty()) out.draws.push_back(out.mean);
  if (out.spread.empty()) out.spread.assign(out.mean.size(), 0.0f);
  return out;
}

std::vector<double> FillWorker::costs(const ScannedTerrain& scene, const Completion& completion) {
  Status status = map_->start();
  for (const Heights& heights : completion.draws) {
    if (ok(status)) status = map_->add(view_of(heights, completion.state, scene.seen));
    if (!ok(status)) throw std::runtime_error(fmt::format("cost: {}", to_string(status)));
    while (!map_->advance(scene.seen.rows)) {
    }
  }
  std::vector<double> out(completion.state.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = map_->cost(i);
  return out;
}

bool FillWorker::is_scored(const TerrainGrid& grid, std::size_t i) const {
  const auto row = static_cast<double>(static_cast<std::int32_t>(i) / grid.columns);
  const double off_m = (row + 0.5 - 0.5 * grid.rows) * grid.cell_m;
  return std::abs(off_m) <= kScoreHalfWidth_m;
}

bool FillWorker::is_near(const TerrainGrid& grid, std::size_t i) const {
  const auto reach = static_cast<std::int32_t>(std::lround(kNear_m / grid.cell_m));
  const std::int32_t column = static_cast<std::int32_t>(i) % grid.columns;
  const std::int32_t row = static_cast<std::int32_t>(i) / grid.columns;
  for (std::int32_t r = row - reach; r <= row + reach; ++r) {
    for (std::int32_t c = column - reach; c <= column + reach; ++c) {
      if (grid.contains(c, r) && grid.knowledge[grid.index(c, r)] != Knowledge::kMeasured) {
        return true;
      }
    }
  }
  return false;
}

FillScore FillWorker::score(FillMethod method, const ScannedTerrain& scene,
                            const Completion& completion) {
  const TerrainGrid& grid = scene.seen;
  Completion truth;
  truth.state = states(scene.truth, scene.bridged);
  truth.draws.emplace_back(scene.truth.value_m.begin(),
                           scene.truth.value_m.begin() + scene.truth.size());
  const std::vector<double> true_cost = costs(scene, truth);
  const std::vector<double> cost = costs(scene, completion);
  FillScore score;
  Errors visible, near, occluded, height;
  double all_filled = 0;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    const bool filled = completion.state[i] == FilledState::kFilled;
    all_filled += filled ? 1 : 0;
    if (filled && completion.mean[i] > grid.value_m[i]) ++score.violations;
    if (!is_scored(grid, i) || scene.truth.knowledge[i] != Knowledge::kMeasured) continue;
    if (grid.knowledge[i] == Knowledge::kMeasured) {
      visible.add(cost[i], true_cost[i]);
      if (is_near(grid, i)) near.add(cost[i], true_cost[i]);
    } else if (filled) {
      occluded.add(cost[i], true_cost[i]);
      height.add(static_cast<double>(completion.mean[i]),
                 static_cast<double>(scene.truth.value_m[i]));
    }
  }
  // The best constant cost, as in the paper, not the cost of a constant height.
  const bool constant = method == FillMethod::kBestConstant;
  score.cost_visible = constant ? visible.deviation() : visible.rms();
  score.cost_near = constant ? near.deviation() : near.rms();
  score.cost_occluded = constant ? occluded.deviation() : occluded.rms();
  score.height_occluded_m = height.rms();
  score.has_occluded = occluded.count > 0;
  if (all_filled > 0) {
    score.us_per_cell = 1e6 * completion.seconds / all_filled;
    score.none_fits_share =
        completion.none_fits / (all_filled * static_cast<double>(completion.draws.size()));
  }
  return score;
}

}  // namespace surefoot::apps
