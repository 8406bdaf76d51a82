#include "core/terrain/terrain_map.h"

#include "core/base/fields.h"
#include "core/mapping/foothold.h"

namespace surefoot::terrain {

void TerrainMap::clear() {
  ground.clear();
  cost.fill(0);
  spread_m.fill(0);
  crest_m.fill(kNoCrest_m);
}

void TerrainMap::raise_crests() {
  for (std::int32_t iy = 0; iy < mapping::kWindowSide; ++iy) {
    for (std::int32_t ix = 0; ix < mapping::kWindowSide; ++ix) {
      const mapping::CellIndex middle = ground.first + mapping::CellIndex{ix, iy};
      const Result<float> highest_m = mapping::highest_ground_m(ground, middle);
      crest_m[ground.place(middle)] = highest_m.ok() ? highest_m.value() : kNoCrest_m;
    }
  }
}

std::uint64_t TerrainMap::digest() const {
  Fnv64 hash;
  FieldHasher hasher(hash);
  hasher.members(*this);
  return hash.value();
}

}  // namespace surefoot::terrain
