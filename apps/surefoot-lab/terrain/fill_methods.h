// The ways of completing a scanned terrain that `eval terrain-fill` compares, and how they score.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "apps/surefoot-lab/terrain/prior_training.h"
#include "apps/surefoot-lab/terrain/simple_fills.h"
#include "core/terrain/cost.h"
#include "core/terrain/fill.h"

namespace surefoot::apps {

// Cells farther from the sensor's path do not count: the picture gets narrow there.
inline constexpr double kScoreHalfWidth_m = 0.30;

// In the order of the contract.
enum class FillMethod : std::uint8_t {
  kPaperLiteral = 0,
  kPaper,
  kImproved,
  kIgnoreMissing,
  kConstraintsAsHeights,
  kUnconstrained,
  kBestConstant,
  kClippedInpainting,
  kMinimumSpread,
  kSmoothedMinimumSpread,
};
inline constexpr std::array kFillMethodNames{"paper_literal",
                                             "paper",
                                             "improved",
                                             "ignore_missing",
                                             "constraints_as_heights",
                                             "unconstrained",
                                             "best_constant",
                                             "clipped_inpainting",
                                             "minimum_spread",
                                             "smoothed_minimum_spread"};
inline constexpr std::size_t kFillMethods = kFillMethodNames.size();

// The settings of the methods that use core/terrain, by the size of a cell.
terrain::FillConfig literal_config(int cell_mm);
terrain::FillConfig paper_config(int cell_mm);
terrain::FillConfig improved_config(int cell_mm);
// The paper's patches in several draws: the improved method where there is no good prior.
terrain::FillConfig drawn_config(int cell_mm);
terrain::FillConfig unconstrained_config(int cell_mm);
PriorOptions prior_options(int cell_mm);
// All features weigh the same; the scales are left open.
terrain::CostConfig cost_config(int cell_mm);

// All that is learned from the library: shared by all workers, never changed.
struct FillMaterial {
  int cell_mm = 10;
  terrain::CostConfig cost;
  terrain::HeightPrior prior;
  terrain::FillConfig improved;                      // settings of the improved method
  std::unique_ptr<terrain::PatchLibrary> wide;       // patches of the paper's methods
  std::unique_ptr<terrain::PatchLibrary> improving;  // of the improved one
};

// Scales of the cost: what 95 of 100 cells of the library stay below. Throws std::runtime_error
// for a library that core's cannot hold.
FillMaterial make_material(const std::vector<const ScannedTerrain*>& library, int cell_mm,
                           const terrain::FillConfig& improved);

// A completed terrain: the draws whose costs are averaged (one for most methods), their mean.
struct Completion {
  std::vector<Heights> draws;
  Heights mean;
  Heights spread;
  std::vector<terrain::FilledState> state;
  double seconds = 0;          // processor time of the fill
  std::int32_t none_fits = 0;  // cell draws without a patch under all ceilings
};

struct FillScore {
  double cost_visible = 0;
  double cost_near = 0;      // visible cells with an unseen one within 20 mm
  double cost_occluded = 0;  // meaningless where has_occluded is false
  double height_occluded_m = 0;
  bool has_occluded = false;
  std::int64_t violations = 0;
  double us_per_cell = 0;
  double none_fits_share = 0;
};

// One per thread: the big objects of core.
class FillWorker {
 public:
  explicit FillWorker(const FillMaterial& material);

  Completion complete(FillMethod method, const ScannedTerrain& scene);
  FillScore score(FillMethod method, const ScannedTerrain& scene, const Completion& completion);
  // Costs of a completion, mean over its draws.
  std::vector<double> costs(const ScannedTerrain& scene, const Completion& completion);

 private:
  void synthesise(const terrain::FillConfig& config, const terrain::PatchLibrary& library,
                  const terrain::TerrainGrid& grid, Completion& out);
  bool is_scored(const terrain::TerrainGrid& grid, std::size_t i) const;
  bool is_near(const terrain::TerrainGrid& grid, std::size_t i) const;

  const FillMaterial& material_;
  std::unique_ptr<terrain::TerrainFiller> filler_ = std::make_unique<terrain::TerrainFiller>();
  std::unique_ptr<terrain::CostMap> map_ = std::make_unique<terrain::CostMap>();
};

}  // namespace surefoot::apps
