#include "core/terrain/terrain_map.h"

#include "core/base/fields.h"

namespace surefoot::terrain {

void TerrainMap::clear() {
  ground.clear();
  cost.fill(0);
  spread_m.fill(0);
}

std::uint64_t TerrainMap::digest() const {
  Fnv64 hash;
  FieldHasher hasher(hash);
  hasher.members(*this);
  return hash.value();
}

}  // namespace surefoot::terrain
