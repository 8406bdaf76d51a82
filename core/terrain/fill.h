// Fill-Terrain: heights for ground that was not seen, drawn from a library of known terrain under
// the line-of-sight ceilings. Kolter, Kim, Ng, "Stereo Vision and Terrain Modeling for Quadruped
// Robots", section III and figure 6; what differs and why: README.md.
//
// Done in small steps: start(), then advance() as time allows. The result does not depend on how
// the work was spread. Static memory, no heap; the object is large (sizeof in README.md).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
#include "core/terrain/fill_config.h"
#include "core/terrain/height_prior.h"
#include "core/terrain/patch_library.h"
#include "core/terrain/patch_target.h"
#include "core/terrain/terrain_grid.h"

namespace surefoot::terrain {

enum class FilledState : std::uint8_t {
  kUnknown = 0,  // no line of sight bounded it: no height
  kFilled,       // a guess under the ceiling, with a spread
  kMeasured,     // as it was measured, bit for bit
};

// Indices as in the TerrainGrid.
struct FilledTerrain {
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  double cell_m = 0;
  mapping::CellIndex first;
  std::array<FilledState, kMaxCells> state{};
  std::array<float, kMaxCells> height_m{};  // mean of the draws; 0 where unknown
  std::array<float, kMaxCells> spread_m{};  // standard deviation of the draws; measured: 0
};

// One draw, or the mean, with its own row pitch: what the cost of terrain is computed from.
struct HeightView {
  const float* height_m = nullptr;     // of cell (0, 0)
  const FilledState* state = nullptr;  // of cell (0, 0); rows `columns` apart
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::int32_t pitch = 0;  // of height_m
  double cell_m = 0;
};
HeightView view_of(const FilledTerrain& filled);
// Measured cells as they are, all others unknown: nothing is filled.
void keep_measured(const TerrainGrid& grid, FilledTerrain& out);

struct FillCounts {
  std::int32_t measured = 0;
  std::int32_t unseen = 0;     // bounded, to be filled
  std::int32_t unknown = 0;    // stay so
  std::int32_t none_fits = 0;  // cell draws in which every patch rose above a ceiling
  std::int32_t no_patch = 0;   // cells with nothing known around: the prior or the ceiling
};

// A learned height gathers from all over the window: 0.5 us for 339 inputs, where a patch of 3 x 3
// takes 24 ns.
inline constexpr std::int64_t kPriorInputs_per_unit = 16;

class TerrainFiller {
 public:
  // kInvalid: see validate(); nothing changed. Ends a fill under way.
  Status configure(const FillConfig& config);

  // Writes every page, so that no later call meets one for the first time.
  void touch();

  // Copies the grid; the library must stay as it is until the fill is done. view_rad: heading of
  // the sensor in the grid (0 along x): where the far rims are, and how the prior lies.
  // Nothing is changed and nothing is under way after an error.
  // kUnavailable: not configured; the library is empty; guide > 0 and there is no prior.
  // kOutOfRange: the library's or the prior's cells or the library's patches have another size.
  // kNotFound: nothing in the grid is measured. kInvalid: a broken prior or a view_rad beyond 10.
  Status start(const TerrainGrid& grid, const PatchLibrary& library, const HeightPrior& prior,
               double view_rad);

  // Works until at least `work` units are spent or all is done; overshoots by less than one step,
  // that is the larger of cell_work() and prior_work(). A unit is one patch compared, one cell
  // smoothed or kPriorInputs_per_unit inputs of the prior.
  // True: done. Without a start(): true.
  bool advance(std::int64_t work);
  bool done() const { return phase_ == Phase::kDone || phase_ == Phase::kIdle; }
  // Units that the fill under way takes in all.
  std::int64_t total_work() const;
  std::int64_t cell_work() const { return 2 + config_.draws * (config_.samples + 1); }
  // Of one learned height.
  std::int64_t prior_work() const {
    if (!prior_.exists()) return 1;
    return 1 + static_cast<std::int64_t>(prior_.inputs()) / kPriorInputs_per_unit;
  }

  // Valid once done() after a start() that was accepted.
  const FilledTerrain& result() const { return filled_; }
  const FillCounts& counts() const { return counts_; }
  HeightView draw(std::int32_t number) const;
  std::int32_t draws() const { return config_.draws; }

 private:
  enum class Phase : std::uint8_t { kIdle, kPrior, kSynthesis, kSmoothing, kCombination, kDone };

  static constexpr std::int32_t kRim = kMaxPatch_cells / 2 + 1;
  static constexpr std::int32_t kPitch = kMaxSide + 2 * kRim;
  static constexpr std::size_t kPadded = static_cast<std::size_t>(kPitch) * kPitch;

  std::size_t padded(std::int32_t column, std::int32_t row) const {
    return table_index(column + kRim, row + kRim, kPitch);
  }
  std::size_t padded(std::size_t i) const;
  void spread_out(const TerrainGrid& grid);
  void sort_cells(double view_rad);
  void next_phase();
  std::int64_t step();
  void learn_height(std::size_t i);
  void synthesise(std::size_t i);
  void gather(std::size_t i, std::int32_t draw);
  float best_height(std::size_t i, std::int32_t draw);
  void smooth(std::size_t i);
  void combine(std::size_t i);

  FillConfig config_;
  bool configured_ = false;
  const PatchLibrary* library_ = nullptr;
  HeightPrior prior_;
  PriorStencil stencil_;
  Phase phase_ = Phase::kIdle;
  std::int32_t cursor_ = 0;  // within the phase
  std::int32_t sweep_ = 0;
  FillCounts counts_;

  TerrainGrid grid_;
  std::array<float, kMaxPatch_cells * kMaxPatch_cells> gauss_{};
  std::array<std::uint16_t, kMaxCells> order_{};    // unseen cells as they are filled
  std::array<std::uint16_t, kMaxCells> in_rows_{};  // the same by index: smoothing, combination
  std::array<float, kMaxCells> learned_m_{};        // by cell
  std::array<float, kPadded> known_{};              // 1: measured or filled already
  std::array<float, kPadded> ceiling_m_{};          // of the cells to respect, else kNoCeiling_m
  std::array<std::array<float, kPadded>, kMaxDraws> height_m_{};
  std::array<std::array<float, kMaxCells>, kMaxDraws> drawn_m_{};  // before smoothing
  PatchTarget target_;
  std::array<float, kMaxPriorInputs> inputs_{};
  FilledTerrain filled_;
};

}  // namespace surefoot::terrain
