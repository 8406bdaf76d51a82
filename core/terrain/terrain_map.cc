#include "core/terrain/terrain_map.h"

#include "core/base/fields.h"

namespace surefoot::terrain {

std::uint64_t TerrainMap::digest() const {
  Fnv64 hash;
  FieldHasher hasher(hash);
  hasher.members(*this);
  return hash.value();
}

}  // namespace surefoot::terrain
