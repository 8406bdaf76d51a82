// Places in row-major tables.
#pragma once

#include <cstddef>
#include <cstdint>

namespace surefoot::terrain {

// Of a table that is `pitch` wide. Tables here have far fewer than 2^31 places.
constexpr std::size_t table_index(std::int32_t column, std::int32_t row, std::int32_t pitch) {
  const std::int32_t place = row * pitch + column;
  return static_cast<std::size_t>(place);
}

}  // namespace surefoot::terrain
