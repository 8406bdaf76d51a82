#include "apps/surefoot-lab/terrain/fill_pictures.h"

#include <algorithm>
#include <cmath>

namespace surefoot::apps {
namespace {

using terrain::FilledState;
using terrain::Knowledge;
using terrain::TerrainGrid;

constexpr double kPanel = 300;
constexpr double kGap = 24;
constexpr double kTitle = 26;
constexpr Colour kUnseenRed{196, 60, 50};

Colour blend(Colour a, Colour b, double share) {
  const auto mix = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + share * (to - from)));
  };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

// Light to dark in equal steps of lightness, for a value from 0 to 1.
Colour height_colour(double share) {
  const double x = std::clamp(share, 0.0, 1.0);
  return blend({20, 24, 34}, {246, 240, 224}, x);
}
Colour cost_colour(double share) {
  const double x = std::clamp(share, 0.0, 1.0);
  return x < 0.5 ? blend({240, 246, 240}, {240, 190, 90}, 2 * x)
                 : blend({240, 190, 90}, {150, 30, 50}, 2 * x - 1);
}

// Paints cell by cell; row 0 of the grid at the bottom, the camera walks to the right.
template <class ColourOf>
Raster paint(const TerrainGrid& grid, ColourOf&& colour_of) {
  Raster raster;
  raster.columns = grid.columns;
  raster.rows = grid.rows;
  for (std::int32_t row = grid.rows - 1; row >= 0; --row) {
    for (std::int32_t column = 0; column < grid.columns; ++column) {
      raster.pixels.push_back(colour_of(grid.index(column, row)));
    }
  }
  return raster;
}

// Lines between cells that were seen and cells that were not.
void outline(Drawing& drawing, const Rectangle& box, const TerrainGrid& grid) {
  const double width = box.width / grid.columns;
  const double height = box.height / grid.rows;
  const auto unseen = [&](std::int32_t column, std::int32_t row) {
    return grid.knowledge[grid.index(column, row)] != Knowledge::kMeasured;
  };
  for (std::int32_t row = 0; row < grid.rows; ++row) {
    for (std::int32_t column = 0; column < grid.columns; ++column) {
      const double right = box.x + (column + 1) * width;
      const double top = box.bottom() - (row + 1) * height;
      if (column + 1 < grid.columns && unseen(column, row) != unseen(column + 1, row)) {
        drawing.line({right, top}, {right, top + height}, {palette::kBlue, 0.8, false});
      }
      if (row + 1 < grid.rows && unseen(column, row) != unseen(column, row + 1)) {
        drawing.line({right - width, top}, {right, top}, {palette::kBlue, 0.8, false});
      }
    }
  }
}

Rectangle panel(int column, int row) {
  return {kGap + column * (kPanel + kGap), kTitle + row * (kPanel + kGap + kTitle), kPanel, kPanel};
}

Drawing sheet(int columns, int rows) {
  Drawing drawing(kGap + columns * (kPanel + kGap), rows * (kPanel + kGap + kTitle));
  drawing.fill({0, 0, drawing.width(), drawing.height()}, palette::kPaper);
  return drawing;
}

void add(Drawing& drawing, const Rectangle& box, const char* title, Raster raster,
         const TerrainGrid* outlined) {
  drawing.text({box.x, box.y - 7}, title, {});
  drawing.raster(box, std::move(raster));
  if (outlined != nullptr) outline(drawing, box, *outlined);
  drawing.frame(box, {palette::kGrid, 1, false});
}

// Heights of a terrain as colours: dark is its lowest cell, bright its highest.
class HeightScale {
 public:
  explicit HeightScale(const TerrainGrid& truth) {
    const auto begin = truth.value_m.begin();
    const auto [low, high] = std::minmax_element(begin, begin + truth.size());
    lowest_m_ = static_cast<double>(*low);
    range_m_ = std::max(static_cast<double>(*high) - lowest_m_, 1e-6);
  }
  Colour operator()(float z_m) const {
    return height_colour((static_cast<double>(z_m) - lowest_m_) / range_m_);
  }

 private:
  double lowest_m_ = 0;
  double range_m_ = 1;
};

// Lit from the upper left.
Colour shade(const TerrainGrid& truth, std::size_t i) {
  const auto c = static_cast<std::int32_t>(i) % truth.columns;
  const auto r = static_cast<std::int32_t>(i) / truth.columns;
  const auto at = [&](std::int32_t column, std::int32_t row) {
    return static_cast<double>(truth.value_m[truth.index(std::clamp(column, 0, truth.columns - 1),
                                                         std::clamp(row, 0, truth.rows - 1))]);
  };
  const double gx = (at(c + 1, r) - at(c - 1, r)) / truth.cell_m;
  const double gy = (at(c, r + 1) - at(c, r - 1)) / truth.cell_m;
  const double light = (0.5 * gx - 0.5 * gy + 0.7) / std::sqrt(gx * gx + gy * gy + 1);
  return blend({45, 40, 36}, {236, 228, 214}, std::clamp(light, 0.0, 1.0));
}

Drawing draw_terrain(const ScannedTerrain& scene, const HeightScale& colour) {
  const TerrainGrid& seen = scene.seen;
  const auto truth = [&](std::size_t i) { return colour(scene.truth.value_m[i]); };
  const auto sensed = [&](std::size_t i) {
    return seen.knowledge[i] == Knowledge::kMeasured ? colour(seen.value_m[i]) : kUnseenRed;
  };
  Drawing drawing = sheet(3, 1);
  add(drawing, panel(0, 0), "Ground, shaded",
      paint(seen, [&](std::size_t i) { return shade(scene.truth, i); }), nullptr);
  add(drawing, panel(1, 0), "Heights, bright is high", paint(seen, truth), nullptr);
  add(drawing, panel(2, 0), "Seen while walking to the right; red: unseen", paint(seen, sensed),
      nullptr);
  return drawing;
}

// The second row of the lower picture: how sure the fill is and what it makes of the cost.
void add_costs(Drawing& drawing, FillWorker& worker, const ScannedTerrain& scene,
               const Completion& improved) {
  const TerrainGrid& seen = scene.seen;
  const auto spread = [&](std::size_t i) {
    return cost_colour(static_cast<double>(improved.spread[i]) / 0.02);
  };
  add(drawing, panel(1, 1), "Spread of the draws, dark is 2 cm", paint(seen, spread), &seen);
  Completion all;
  all.state.assign(improved.state.size(), FilledState::kMeasured);
  all.draws.emplace_back(scene.truth.value_m.begin(),
                         scene.truth.value_m.begin() + scene.truth.size());
  const std::vector<double> true_cost = worker.costs(scene, all);
  const std::vector<double> cost = worker.costs(scene, improved);
  add(drawing, panel(2, 1), "True cost, dark is 1",
      paint(seen, [&](std::size_t i) { return cost_colour(true_cost[i]); }), &seen);
  add(drawing, panel(3, 1), "Cost of the improved fill",
      paint(seen, [&](std::size_t i) { return cost_colour(cost[i]); }), &seen);
}

}  // namespace

FillPictures draw_fills(FillWorker& worker, const ScannedTerrain& scene) {
  const TerrainGrid& seen = scene.seen;
  const HeightScale colour(scene.truth);
  FillPictures pictures;
  pictures.terrain = draw_terrain(scene, colour);
  pictures.fills = sheet(4, 2);
  const auto truth = [&](std::size_t i) { return colour(scene.truth.value_m[i]); };
  const auto ceilings = [&](std::size_t i) {
    return seen.knowledge[i] == Knowledge::kUnknown ? palette::kUnknown : colour(seen.value_m[i]);
  };
  add(pictures.fills, panel(0, 0), "True heights", paint(seen, truth), &seen);
  add(pictures.fills, panel(1, 0), "Ceilings", paint(seen, ceilings), &seen);
  const std::array<std::pair<FillMethod, const char*>, 3> fills{
      {{FillMethod::kImproved, "Filled: improved, mean of draws"},
       {FillMethod::kPaper, "Filled: paper"},
       {FillMethod::kUnconstrained, "Filled: without ceilings"}}};
  int number = 2;
  for (const auto& [method, title] : fills) {
    const Completion completion = worker.complete(method, scene);
    const auto filled = [&](std::size_t i) {
      return completion.state[i] == FilledState::kUnknown ? palette::kUnknown
                                                          : colour(completion.mean[i]);
    };
    add(pictures.fills, panel(number % 4, number / 4), title, paint(seen, filled), &seen);
    if (method == FillMethod::kImproved) add_costs(pictures.fills, worker, scene, completion);
    ++number;
  }
  return pictures;
}

}  // namespace surefoot::apps
