// Places in row-major tables, and whether two of them have the same cells.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/math/elementary.h"

namespace surefoot::terrain {

// Of a table that is `pitch` wide. Tables here have far fewer than 2^31 places.
constexpr std::size_t table_index(std::int32_t column, std::int32_t row, std::int32_t pitch) {
  const std::int32_t place = row * pitch + column;
  return static_cast<std::size_t>(place);
}

// Sizes that come from two texts.
inline bool same_cell_size(double a_m, double b_m) {
  return math::magnitude(a_m - b_m) <= 1e-9 * b_m;
}

}  // namespace surefoot::terrain
