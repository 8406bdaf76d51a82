// Heights on a regular grid of W, some of them unknown: the true ground and the perceived map,
// brought to one raster so that they can be drawn side by side and compared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace surefoot::apps {

struct HeightGrid {
  double x_m = 0;  // W, corner with the smallest coordinates
  double y_m = 0;
  double cell_m = 0.01;
  int columns = 0;  // along x
  int rows = 0;     // along y
  std::vector<float> height_m;
  std::vector<std::uint8_t> known;

  HeightGrid() = default;
  HeightGrid(double x, double y, double width, double length_y, double cell);

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  double x_of(int column) const { return x_m + (column + 0.5) * cell_m; }
  double y_of(int row) const { return y_m + (row + 0.5) * cell_m; }
  void set(int column, int row, double height) {
    height_m[index(column, row)] = static_cast<float>(height);
    known[index(column, row)] = 1;
  }
  double right_m() const { return x_m + columns * cell_m; }
  double top_m() const { return y_m + rows * cell_m; }
};

// perceived - truth where both are known.
HeightGrid difference(const HeightGrid& perceived, const HeightGrid& truth);

}  // namespace surefoot::apps
