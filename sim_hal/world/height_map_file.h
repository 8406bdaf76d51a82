// Height maps from files. Every error is a SimulatorError that names the file and, for text, the
// line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace surefoot::sim {

// As in the file: row 0 is the northern edge (greatest y), metres, unknown cells flagged.
struct RawHeightMap {
  std::size_t columns = 0;
  std::size_t rows = 0;
  double cell_m = 0;
  std::vector<double> z_m;          // row-major; meaningless where unknown
  std::vector<std::uint8_t> known;  // 1 or 0

  std::size_t index(std::size_t row, std::size_t column) const { return row * columns + column; }
};

// ESRI ASCII grid: ncols, nrows, xllcorner|xllcenter, yllcorner|yllcenter, cellsize, NODATA_value
// (optional, any order, any case), then nrows lines of ncols numbers.
RawHeightMap read_esri_ascii(const std::string& file);

// 16-bit single-channel PNG and, beside it with the extension .yaml, a map with the keys
// metres_per_count, cell_size_m and, optionally, offset_m and nodata (a count).
RawHeightMap read_png16(const std::string& file);

// Chooses by extension.
RawHeightMap read_height_map(const std::string& file);

// Gives each unknown cell the height of its lowest known neighbour (of eight), ring by ring, until
// all are known. Returns how many cells were given a height. There must be a known cell.
std::uint32_t bridge_unknown(RawHeightMap& map);

// Cuts rows and columns off the border while less than half of them is known, the emptiest first,
// so that little of the ground is invention. Keeps at least 8 x 8 cells.
void crop_to_known(RawHeightMap& map);

}  // namespace surefoot::sim
