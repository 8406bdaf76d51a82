#include "core/mapping/height_map.h"

#include <bit>

namespace surefoot::mapping {

void MapCell::add_to(Fnv64& hash) const {
  hash.word(std::bit_cast<std::uint32_t>(height_m), 4);
  hash.word(std::bit_cast<std::uint32_t>(variance_m2), 4);
  hash.word(stamp_ms, 4);
  hash.word(static_cast<std::uint16_t>(candidate_mm), 2);
  hash.word(static_cast<std::uint8_t>(state), 1);
  hash.word(static_cast<std::uint64_t>(confirmations) | static_cast<std::uint64_t>(misses) << 4u,
            1);
}

}  // namespace surefoot::mapping
