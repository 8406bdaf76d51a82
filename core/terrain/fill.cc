#include "core/terrain/fill.h"

#include "core/base/hash.h"
#include "core/base/random.h"
#include "core/math/elementary.h"

namespace surefoot::terrain {

namespace {

// Whole steps along the view lie within 1.5 sides of cell (0, 0), to either side.
constexpr std::int32_t kKeyOffset = 2 * kMaxSide;
constexpr std::size_t kKeys = 4 * static_cast<std::size_t>(kMaxSide);

// Draws depend on the cell's place in the map and not on the window: a cell that stays unseen
// meets the same candidates again when the window has moved.
std::uint64_t seed_of(std::uint32_t seed, mapping::CellIndex cell, std::int32_t draw) {
  Fnv64 hash;
  hash.word(seed, 4);
  hash.word(static_cast<std::uint32_t>(cell.ix), 4);
  hash.word(static_cast<std::uint32_t>(cell.iy), 4);
  hash.word(static_cast<std::uint32_t>(draw), 4);
  return hash.value();
}

}  // namespace

HeightView view_of(const FilledTerrain& filled) {
  return {filled.height_m.data(), filled.state.data(), filled.columns, filled.rows,
          filled.columns,         filled.cell_m};
}

void keep_measured(const TerrainGrid& grid, FilledTerrain& out) {
  out.columns = grid.columns;
  out.rows = grid.rows;
  out.cell_m = grid.cell_m;
  out.first = grid.first;
  for (std::size_t i = 0; i < static_cast<std::size_t>(grid.size()); ++i) {
    const bool measured = grid.knowledge[i] == Knowledge::kMeasured;
    out.state[i] = measured ? FilledState::kMeasured : FilledState::kUnknown;
    out.height_m[i] = measured ? grid.value_m[i] : 0.0f;
    out.spread_m[i] = 0;
  }
}

void TerrainFiller::touch() {
  grid_.value_m.fill(0);
  grid_.knowledge.fill(Knowledge::kUnknown);
  order_.fill(0);
  in_rows_.fill(0);
  learned_m_.fill(0);
  known_.fill(0);
  ceiling_m_.fill(0);
  for (auto& heights : height_m_) heights.fill(0);
  for (auto& heights : drawn_m_) heights.fill(0);
  filled_.state.fill(FilledState::kUnknown);
  filled_.height_m.fill(0);
  filled_.spread_m.fill(0);
}

Status TerrainFiller::configure(const FillConfig& config) {
  const Status status = validate(config);
  if (!ok(status)) return status;
  config_ = config;
  configured_ = true;
  phase_ = Phase::kIdle;
  const std::int32_t side = config.patch_cells;
  target_.reset(side);
  const double deviation = config.weight_deviation * side;
  for (std::int32_t v = 0; v < side; ++v) {
    for (std::int32_t u = 0; u < side; ++u) {
      const double square = math::square(u - side / 2) + math::square(v - side / 2);
      gauss_[table_index(u, v, side)] =
          static_cast<float>(math::exp(-square / (2 * deviation * deviation)));
    }
  }
  return Status::kOk;
}

Status TerrainFiller::start(const TerrainGrid& grid, const PatchLibrary& library,
                            const HeightPrior& prior, double view_rad) {
  phase_ = Phase::kIdle;
  if (!configured_ || library.patches() == 0) return Status::kUnavailable;
  if (config_.guide > 0 && !prior.exists()) return Status::kUnavailable;
  if (!ok(validate(prior)) || !(view_rad >= -10 && view_rad <= 10)) return Status::kInvalid;
  if (library.patch_cells() != config_.patch_cells ||
      !same_cell_size(library.cell_m(), grid.cell_m) ||
      (prior.exists() && !same_cell_size(prior.cell_m, grid.cell_m))) {
    return Status::kOutOfRange;
  }
  std::int32_t measured = 0;
  for (std::int32_t i = 0; i < grid.size(); ++i) {
    measured += grid.knowledge[static_cast<std::size_t>(i)] == Knowledge::kMeasured ? 1 : 0;
  }
  if (measured == 0) return Status::kNotFound;
  grid_ = grid;
  library_ = &library;
  prior_ = prior;
  if (prior_.exists()) stencil_.set(prior_.radius, prior_.stride, view_rad);
  counts_ = {};
  counts_.measured = measured;
  spread_out(grid);
  sort_cells(view_rad);
  cursor_ = 0;
  sweep_ = 0;
  phase_ = Phase::kPrior;
  if (counts_.unseen == 0) phase_ = Phase::kDone;
  return Status::kOk;
}

std::size_t TerrainFiller::padded(std::size_t i) const {
  const auto cell = static_cast<std::int32_t>(i);
  return padded(cell % grid_.columns, cell / grid_.columns);
}

// Into the padded layers, and what is known at once into the result.
void TerrainFiller::spread_out(const TerrainGrid& grid) {
  known_.fill(0);
  ceiling_m_.fill(kNoCeiling_m);
  filled_.columns = grid.columns;
  filled_.rows = grid.rows;
  filled_.cell_m = grid.cell_m;
  filled_.first = grid.first;
  filled_.state.fill(FilledState::kUnknown);
  filled_.height_m.fill(0);
  filled_.spread_m.fill(0);
  for (std::int32_t draw = 0; draw < config_.draws; ++draw) {
    height_m_[static_cast<std::size_t>(draw)].fill(0);
  }
  for (std::int32_t cell = 0; cell < grid.size(); ++cell) {
    const auto i = static_cast<std::size_t>(cell);
    const std::size_t at = padded(i);
    if (grid.knowledge[i] == Knowledge::kMeasured) {
      known_[at] = 1;
      filled_.state[i] = FilledState::kMeasured;
      filled_.height_m[i] = grid.value_m[i];
      for (std::int32_t draw = 0; draw < config_.draws; ++draw) {
        height_m_[static_cast<std::size_t>(draw)][at] = grid.value_m[i];
      }
    } else if (grid.knowledge[i] == Knowledge::kBounded) {
      ceiling_m_[at] = grid.value_m[i];
      in_rows_[static_cast<std::size_t>(counts_.unseen++)] = static_cast<std::uint16_t>(cell);
    }
  }
  counts_.unknown = grid.size() - counts_.measured - counts_.unseen;
}

// A counting sort by the whole steps along the view, ties by index: raster order goes up along x,
// far-first order down along the view.
void TerrainFiller::sort_cells(double view_rad) {
  const bool far_first = config_.order == FillOrder::kFarFirst;
  const math::SinCos turn = math::sin_cos(far_first ? view_rad : 0.0);
  const auto key_of = [&](std::uint16_t cell) {
    const std::int32_t column = cell % grid_.columns;
    const std::int32_t row = cell / grid_.columns;
    const double shifted = turn.cos * column + turn.sin * row + kKeyOffset + 0.5;
    const auto key = static_cast<std::size_t>(shifted);  // rounds: it is positive
    return far_first ? kKeys - 1 - key : key;
  };
  std::array<std::uint16_t, kKeys + 1> begin{};
  for (std::int32_t k = 0; k < counts_.unseen; ++k) {
    ++begin[key_of(in_rows_[static_cast<std::size_t>(k)]) + 1];
  }
  for (std::size_t key = 1; key <= kKeys; ++key) {
    begin[key] = static_cast<std::uint16_t>(begin[key] + begin[key - 1]);
  }
  for (std::int32_t k = 0; k < counts_.unseen; ++k) {
    const std::uint16_t cell = in_rows_[static_cast<std::size_t>(k)];
    order_[begin[key_of(cell)]++] = cell;
  }
}

std::int64_t TerrainFiller::total_work() const {
  const std::int64_t smoothing =
      static_cast<std::int64_t>(config_.smoothing_sweeps) * config_.draws;
  return counts_.unseen * (prior_work() + cell_work() + smoothing + 1);
}

bool TerrainFiller::advance(std::int64_t work) {
  std::int64_t spent = 0;
  // At most one step per unit of work: each step spends at least one.
  while (!done() && spent < work) spent += step();
  return done();
}

void TerrainFiller::next_phase() {
  cursor_ = 0;
  switch (phase_) {
    case Phase::kPrior: phase_ = Phase::kSynthesis; break;
    case Phase::kSynthesis:
      phase_ = config_.smoothing_sweeps > 0 ? Phase::kSmoothing : Phase::kCombination;
      break;
    case Phase::kSmoothing:
      if (++sweep_ == config_.smoothing_sweeps) phase_ = Phase::kCombination;
      break;
    case Phase::kCombination:
    case Phase::kIdle:
    case Phase::kDone: phase_ = Phase::kDone; break;
  }
}

// One cell in the phase under way. Returns the work it took.
std::int64_t TerrainFiller::step() {
  const auto at = static_cast<std::size_t>(cursor_);
  std::int64_t work = 1;
  switch (phase_) {
    case Phase::kPrior:
      learn_height(order_[at]);
      work = prior_work();
      break;
    case Phase::kSynthesis:
      synthesise(order_[at]);
      work = cell_work();
      break;
    case Phase::kSmoothing:
      smooth(in_rows_[at]);
      work = config_.draws;
      break;
    case Phase::kCombination: combine(in_rows_[at]); break;
    case Phase::kIdle:
    case Phase::kDone: return work;
  }
  if (++cursor_ == counts_.unseen) next_phase();
  return work;
}

void TerrainFiller::learn_height(std::size_t i) {
  learned_m_[i] = grid_.value_m[i];
  if (!prior_.exists()) return;
  const auto cell = static_cast<std::int32_t>(i);
  stencil_.gather(grid_, cell % grid_.columns, cell / grid_.columns, inputs_);
  learned_m_[i] = predict(prior_, inputs_, grid_.value_m[i]);
}

// The surroundings of a cell as one draw sees them.
void TerrainFiller::gather(std::size_t i, std::int32_t draw) {
  const auto& heights = height_m_[static_cast<std::size_t>(draw)];
  const std::int32_t side = config_.patch_cells;
  const std::size_t middle = padded(i);
  for (std::int32_t v = 0; v < side; ++v) {
    const std::size_t begin =
        middle + table_index(0, v - side / 2, kPitch) - static_cast<std::size_t>(side / 2);
    for (std::int32_t u = 0; u < side; ++u) {
      const std::size_t at = begin + static_cast<std::size_t>(u);
      const float known = known_[at];
      target_.set(u, v, heights[at], known, known * gauss_[table_index(u, v, side)],
                  ceiling_m_[at]);
    }
  }
}

float TerrainFiller::best_height(std::size_t i, std::int32_t draw) {
  const auto cell = static_cast<std::int32_t>(i);
  const mapping::CellIndex place =
      grid_.first + mapping::CellIndex{cell % grid_.columns, cell / grid_.columns};
  Random random(seed_of(config_.seed, place, draw));
  const auto penalty = static_cast<float>(config_.penalty);
  const auto guide = static_cast<float>(config_.guide);
  bool found_valid = false;
  float best = 0;
  float height_m = 0;
  for (std::int32_t k = 0; k < config_.samples; ++k) {
    const PatchFit fit = target_.fit(library_->draw(random));
    float score = fit.difference + guide * math::square(fit.height_m - learned_m_[i]);
    bool better = k == 0 || score < best;
    if (config_.rule == SightRule::kPenalty) {
      score += penalty * fit.violation;
      better = k == 0 || score < best;
      found_valid = found_valid || !(fit.violation > 0);
    } else if (config_.rule == SightRule::kReject) {
      const bool valid = !(fit.violation > 0);
      if (!valid) score = fit.violation;
      better = k == 0 || (valid == found_valid ? score < best : valid);
      found_valid = found_valid || valid;
    }
    if (!better) continue;
    best = score;
    height_m = fit.height_m;
  }
  if (config_.rule != SightRule::kNone && !found_valid) ++counts_.none_fits;
  return height_m;
}

void TerrainFiller::synthesise(std::size_t i) {
  const std::size_t at = padded(i);
  const float ceiling_m = grid_.value_m[i];
  bool compared = true;
  for (std::int32_t draw = 0; draw < config_.draws; ++draw) {
    gather(i, draw);
    compared = target_.finish();
    float height_m = compared ? best_height(i, draw) : learned_m_[i];
    if (config_.rule == SightRule::kPenalty && !(height_m < ceiling_m)) height_m = ceiling_m;
    height_m_[static_cast<std::size_t>(draw)][at] = height_m;
    drawn_m_[static_cast<std::size_t>(draw)][i] = height_m;
  }
  if (!compared) ++counts_.no_patch;
  known_[at] = 1;
  // What is filled is part of the texture; the text's constraint goes on to hold the patch's part
  // over it under the ceiling, which is why it fails so often.
  if (config_.rule == SightRule::kPenalty) ceiling_m_[at] = kNoCeiling_m;
}

// Gauss-Seidel towards the mean of the four neighbours, held by what was drawn.
void TerrainFiller::smooth(std::size_t i) {
  const std::size_t at = padded(i);
  const float ceiling_m = grid_.value_m[i];
  const auto hold = static_cast<float>(config_.smoothing_hold);
  constexpr std::size_t kDown = static_cast<std::size_t>(kPitch);
  const std::array<std::size_t, 4> around{at - kDown, at - 1, at + 1, at + kDown};
  for (std::int32_t draw = 0; draw < config_.draws; ++draw) {
    auto& heights = height_m_[static_cast<std::size_t>(draw)];
    float count = hold;
    float sum = hold * drawn_m_[static_cast<std::size_t>(draw)][i];
    for (const std::size_t k : around) {
      count += known_[k];
      sum += known_[k] * heights[k];
    }
    if (!(count > 0)) continue;
    const float mean = sum / count;
    heights[at] = config_.rule == SightRule::kPenalty && !(mean < ceiling_m) ? ceiling_m : mean;
  }
}

void TerrainFiller::combine(std::size_t i) {
  const std::size_t at = padded(i);
  const auto draws = static_cast<float>(config_.draws);
  const float base = height_m_[0][at];  // differences are small: no digits are lost
  float sum = 0;
  float squares = 0;
  for (std::int32_t draw = 0; draw < config_.draws; ++draw) {
    const float off = height_m_[static_cast<std::size_t>(draw)][at] - base;
    sum += off;
    squares += off * off;
  }
  const float mean = sum / draws;
  const float variance = squares / draws - mean * mean;
  float height_m = base + mean;
  if (config_.rule == SightRule::kPenalty && !(height_m < grid_.value_m[i])) {
    height_m = grid_.value_m[i];
  }
  filled_.state[i] = FilledState::kFilled;
  filled_.height_m[i] = height_m;
  filled_.spread_m[i] =
      variance > 0 ? static_cast<float>(math::sqrt(static_cast<double>(variance))) : 0.0f;
}

HeightView TerrainFiller::draw(std::int32_t number) const {
  SUREFOOT_ASSERT(number >= 0 && number < config_.draws);
  return {&height_m_[static_cast<std::size_t>(number)][padded(0, 0)],
          filled_.state.data(),
          grid_.columns,
          grid_.rows,
          kPitch,
          grid_.cell_m};
}

}  // namespace surefoot::terrain
