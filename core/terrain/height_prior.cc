#include "core/terrain/height_prior.h"

#include "core/math/elementary.h"
#include "core/terrain/table_index.h"

namespace surefoot::terrain {

namespace {

// Half away from zero.
std::int16_t rounded(double x) {
  const double farther = x < 0 ? x - 0.5 : x + 0.5;
  return static_cast<std::int16_t>(farther);
}

bool is_on_lattice(std::int32_t u, std::int32_t v, std::int32_t radius, std::int32_t stride) {
  const std::int32_t reach = radius * stride;
  return u % stride == 0 && v % stride == 0 && u >= -reach && u <= reach && v >= -reach &&
         v <= reach;
}

}  // namespace

std::size_t prior_points(std::int32_t radius, std::int32_t stride) {
  const std::int32_t side = 2 * radius + 1;
  std::size_t points = table_index(0, side, side);
  if (radius == 0 || stride == 1) return points;
  for (std::int32_t v = -kDenseRadius; v <= kDenseRadius; ++v) {
    for (std::int32_t u = -kDenseRadius; u <= kDenseRadius; ++u) {
      points += is_on_lattice(u, v, radius, stride) ? 0 : 1;
    }
  }
  return points;
}

Status validate(const HeightPrior& prior) {
  bool valid = prior.radius >= 0 && prior.radius <= kMaxPriorRadius && prior.stride >= 1 &&
               prior.stride <= 8;
  if (prior.radius > 0) valid = valid && prior.cell_m >= 0.001 && prior.cell_m <= 1.0;
  valid = valid && prior.residual_m >= 0 && prior.residual_m <= 10;
  for (const float weight : prior.weights) {
    valid = valid && math::is_finite(static_cast<double>(weight));
  }
  return valid ? Status::kOk : Status::kInvalid;
}

void PriorStencil::set(std::int32_t radius, std::int32_t stride, double view_rad, bool mirrored) {
  SUREFOOT_ASSERT(radius >= 0 && radius <= kMaxPriorRadius && stride >= 1 && stride <= 8);
  const math::SinCos turn = math::sin_cos(view_rad);
  const double left = mirrored ? -1 : 1;
  points_ = 0;
  for (std::int32_t v = -radius; v <= radius; ++v) {
    for (std::int32_t u = -radius; u <= radius; ++u) {
      add(u * stride, left * v * stride, turn.cos, turn.sin);
    }
  }
  if (radius == 0 || stride == 1) return;
  for (std::int32_t v = -kDenseRadius; v <= kDenseRadius; ++v) {
    for (std::int32_t u = -kDenseRadius; u <= kDenseRadius; ++u) {
      if (!is_on_lattice(u, v, radius, stride)) add(u, left * v, turn.cos, turn.sin);
    }
  }
}

void PriorStencil::add(double along, double left, double cos, double sin) {
  offsets_[points_++] = {rounded(cos * along - sin * left), rounded(sin * along + cos * left)};
}

void PriorStencil::gather(const TerrainGrid& grid, std::int32_t column, std::int32_t row,
                          std::span<float> inputs) const {
  SUREFOOT_ASSERT(inputs.size() >= 2 * points_ + 1);
  const float own_m = grid.value_m[grid.index(column, row)];
  for (std::size_t k = 0; k < points_; ++k) {
    const std::int32_t c = column + offsets_[k].column;
    const std::int32_t r = row + offsets_[k].row;
    float value = 0;
    float seen = 0;
    if (grid.contains(c, r)) {
      const std::size_t i = grid.index(c, r);
      if (grid.knowledge[i] != Knowledge::kUnknown) {
        value = math::clamp((grid.value_m[i] - own_m) / kPriorScale_m, -kPriorLimit, kPriorLimit);
        seen = grid.knowledge[i] == Knowledge::kMeasured ? 1.0f : 0.0f;
      }
    }
    inputs[k] = value;
    inputs[points_ + k] = seen;
  }
  inputs[2 * points_] = 1;
}

float predict(const HeightPrior& prior, std::span<const float> inputs, float ceiling_m) {
  SUREFOOT_ASSERT(inputs.size() >= prior.inputs());
  float drop = 0;
  for (std::size_t k = 0; k < prior.inputs(); ++k) drop += prior.weights[k] * inputs[k];
  const float height = ceiling_m + drop;
  return height < ceiling_m ? height : ceiling_m;
}

}  // namespace surefoot::terrain
