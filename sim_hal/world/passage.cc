#include "sim_hal/world/passage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace surefoot::sim {

namespace {

constexpr double kCell_m = 0.1;

struct Raster {
  PlanBounds area;
  std::int64_t nx = 0;
  std::int64_t ny = 0;
  std::vector<std::uint8_t> closed;  // blocked, or seen

  explicit Raster(const PlanBounds& bounds)
      : area(bounds),
        nx(std::max<std::int64_t>(1, std::llround((bounds.x1 - bounds.x0) / kCell_m))),
        ny(std::max<std::int64_t>(1, std::llround((bounds.y1 - bounds.y0) / kCell_m))),
        closed(static_cast<std::size_t>(nx * ny), 0) {}

  std::int64_t column(double x) const {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((x - area.x0) / kCell_m)),
                                    0, nx - 1);
  }
  std::int64_t row(double y) const {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((y - area.y0) / kCell_m)),
                                    0, ny - 1);
  }
  Vector2 centre(std::int64_t i, std::int64_t j) const {
    return {area.x0 + kCell_m * (static_cast<double>(i) + 0.5),
            area.y0 + kCell_m * (static_cast<double>(j) + 0.5)};
  }
  std::uint8_t& at(std::int64_t i, std::int64_t j) {
    return closed[static_cast<std::size_t>(j * nx + i)];
  }
};

void block(const Solid& solid, double reach_m, Raster& raster) {
  const PlanBounds b = plan_bounds(solid);
  const std::int64_t i1 = raster.column(b.x1 + reach_m);
  const std::int64_t j1 = raster.row(b.y1 + reach_m);
  for (std::int64_t j = raster.row(b.y0 - reach_m); j <= j1; ++j) {
    for (std::int64_t i = raster.column(b.x0 - reach_m); i <= i1; ++i) {
      const Vector2 p = raster.centre(i, j);
      Vector2 away;
      if (plan_distance_m(solid, p, p, away) < reach_m) raster.at(i, j) = 1;
    }
  }
}

}  // namespace

bool passage_exists(const std::vector<Solid>& solids, const PlanBounds& area, const Vector2& from_m,
                    const Vector2& to_m, double width_m) {
  Raster raster(area);
  for (const Solid& solid : solids) block(solid, 0.5 * width_m, raster);
  struct Place {
    std::int64_t i;
    std::int64_t j;
  };
  const Place goal{raster.column(to_m.x()), raster.row(to_m.y())};
  std::vector<Place> open;
  const auto visit = [&](std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0 || i >= raster.nx || j >= raster.ny || raster.at(i, j) != 0) return;
    raster.at(i, j) = 1;
    open.push_back({i, j});
  };
  visit(raster.column(from_m.x()), raster.row(from_m.y()));
  while (!open.empty()) {
    const Place here = open.back();
    open.pop_back();
    if (here.i == goal.i && here.j == goal.j) return true;
    visit(here.i + 1, here.j);
    visit(here.i - 1, here.j);
    visit(here.i, here.j + 1);
    visit(here.i, here.j - 1);
  }
  return false;
}

}  // namespace surefoot::sim
