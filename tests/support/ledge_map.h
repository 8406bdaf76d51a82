// A published map window whose heights are a function of the place.
#pragma once

#include <memory>

#include "core/mapping/map_window.h"

namespace surefoot::tests {

inline constexpr double kCell_m = 0.015;

// height(x, y) of the cell's centre; NaN: never seen.
template <class Height>
std::unique_ptr<mapping::MapWindow> window_of(double x_O_m, double y_O_m, Height height) {
  auto window = std::make_unique<mapping::MapWindow>();
  window->cell_size_m = kCell_m;
  window->frames = 1;
  const auto floor_of = [](double x) { return static_cast<std::int32_t>(x < 0 ? x - 1 : x); };
  window->first = {floor_of(x_O_m / kCell_m) - mapping::kWindowSide / 2,
                   floor_of(y_O_m / kCell_m) - mapping::kWindowSide / 2};
  for (std::int32_t j = 0; j < mapping::kWindowSide; ++j) {
    for (std::int32_t i = 0; i < mapping::kWindowSide; ++i) {
      const double x = (window->first.ix + i + 0.5) * kCell_m;
      const double y = (window->first.iy + j + 0.5) * kCell_m;
      const double z = height(x, y);
      mapping::WindowCell& cell =
          window->cells[static_cast<std::size_t>(j * mapping::kWindowSide + i)];
      if (z != z) continue;
      cell.height_m = static_cast<float>(z);
      cell.state = mapping::CellState::kMeasured;
    }
  }
  return window;
}

}  // namespace surefoot::tests
