#include "apps/surefoot-lab/terrain/improved_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/math/linear.h"

namespace surefoot::apps {
namespace {

using terrain::TerrainGrid;
using Pieces = std::vector<const ScannedTerrain*>;

constexpr std::size_t kManyPieces = 10;  // whole ones are held back then
constexpr std::size_t kMostFills = 16;   // of all groups together
constexpr double kLeastError = 1e-9;     // a perfect fill is no division by zero

std::unique_ptr<TerrainGrid> rows_of(const TerrainGrid& grid, std::int32_t begin,
                                     std::int32_t rows) {
  auto out = std::make_unique<TerrainGrid>();
  if (!ok(out->reset(grid.columns, rows, grid.cell_m))) return out;
  const std::size_t from = grid.index(0, begin);
  std::copy_n(grid.value_m.begin() + static_cast<std::ptrdiff_t>(from), out->size(),
              out->value_m.begin());
  std::copy_n(grid.knowledge.begin() + static_cast<std::ptrdiff_t>(from), out->size(),
              out->knowledge.begin());
  return out;
}

// One side of the sensor's path, 0 or 1.
std::unique_ptr<ScannedTerrain> side_of(const ScannedTerrain& piece, std::size_t number) {
  const std::int32_t rows = piece.seen.rows / 2;
  const std::int32_t begin = number == 0 ? 0 : piece.seen.rows - rows;
  auto side = std::make_unique<ScannedTerrain>();
  side->seen = *rows_of(piece.seen, begin, rows);
  side->truth = *rows_of(piece.truth, begin, rows);
  side->bridged = piece.bridged;
  return side;
}

// What is filled together, from what the other groups teach.
struct Groups {
  std::vector<std::unique_ptr<ScannedTerrain>> sides;
  std::vector<Pieces> pieces;
};

Groups grouped(const Pieces& library) {
  Groups groups;
  if (library.size() >= kManyPieces) {
    groups.pieces.resize(kManyPieces / 2);
    for (std::size_t k = 0; k < library.size(); ++k) {
      groups.pieces[k / 2 % groups.pieces.size()].push_back(library[k]);
    }
    return groups;
  }
  groups.pieces.resize(2);
  for (std::size_t k = 0; k < library.size(); ++k) {
    for (std::size_t side = 0; side < 2; ++side) {
      groups.sides.push_back(side_of(*library[k], side));
      groups.pieces[(k + side) % 2].push_back(groups.sides.back().get());
    }
  }
  return groups;
}

std::vector<FillScore> scores_of(const std::vector<Pieces>& groups, int cell_mm,
                                 const terrain::FillConfig& settings) {
  std::vector<FillScore> scores;
  for (const Pieces& group : groups) {
    Pieces others;
    for (const Pieces& other : groups) {
      if (&other != &group) others.insert(others.end(), other.begin(), other.end());
    }
    const FillMaterial material = make_material(others, cell_mm, settings);
    FillWorker worker(material);
    for (std::size_t k = 0; k < std::min(group.size(), kMostFills / groups.size()); ++k) {
      const Completion completion = worker.complete(FillMethod::kImproved, *group[k]);
      scores.push_back(worker.score(FillMethod::kImproved, *group[k], completion));
    }
  }
  return scores;
}

// Of the first's errors to the second's, geometric mean over the three of Table I; 0: the same.
double log_ratio(const FillScore& first, const FillScore& second) {
  double sum = 0;
  for (double FillScore::*const error :
       {&FillScore::cost_visible, &FillScore::cost_occluded, &FillScore::height_occluded_m}) {
    sum += std::log(std::max(first.*error, kLeastError) / std::max(second.*error, kLeastError));
  }
  return sum / 3;
}

bool has_unseen(const Pieces& pieces) {
  return std::any_of(pieces.begin(), pieces.end(), [](const ScannedTerrain* piece) {
    const auto end = piece->seen.knowledge.begin() + piece->seen.size();
    return std::find(piece->seen.knowledge.begin(), end, terrain::Knowledge::kBounded) != end;
  });
}

}  // namespace

ImprovedChoice choose_improved(const Pieces& library, int cell_mm) {
  const std::array settings{improved_config(cell_mm), drawn_config(cell_mm)};
  const Groups groups = grouped(library);
  if (!std::all_of(groups.pieces.begin(), groups.pieces.end(), has_unseen)) {
    return {settings[1], 0, 0};
  }
  const std::vector<FillScore> guided = scores_of(groups.pieces, cell_mm, settings[0]);
  const std::vector<FillScore> drawn = scores_of(groups.pieces, cell_mm, settings[1]);
  double sum = 0;
  double squares = 0;
  for (std::size_t k = 0; k < guided.size(); ++k) {
    const double ratio = log_ratio(guided[k], drawn[k]);
    sum += ratio;
    squares += ratio * ratio;
  }
  const auto count = static_cast<double>(guided.size());
  ImprovedChoice choice;
  choice.log_ratio = sum / count;
  const double variance = std::max(squares / count - math::square(choice.log_ratio), 0.0);
  choice.error = std::sqrt(variance / std::max(count - 1, 1.0));
  choice.settings = choice.log_ratio < -choice.error ? settings[0] : settings[1];
  return choice;
}

}  // namespace surefoot::apps
