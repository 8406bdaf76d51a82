#include "core/terrain/cost.h"

#include "core/math/elementary.h"

namespace surefoot::terrain {

namespace {

// Sums over the cells of a window, positions and heights relative to its middle cell.
struct Moments {
  double n = 0;
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  double z = 0, xz = 0, yz = 0, zz = 0;
  double lowest = 0, highest = 0;
  double bends = 0, bend_sum = 0;

  void add(double dx, double dy, double dz) {
    n += 1;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
    z += dz;
    xz += dx * dz;
    yz += dy * dz;
    zz += dz * dz;
    if (dz < lowest) lowest = dz;
    if (dz > highest) highest = dz;
  }
  WindowFeatures features(double cell_m) const {
    WindowFeatures out;
    const double cxx = xx - x * x / n;
    const double cxy = xy - x * y / n;
    const double cyy = yy - y * y / n;
    const double cxz = xz - x * z / n;
    const double cyz = yz - y * z / n;
    const double determinant = cxx * cyy - cxy * cxy;
    // In cells; cells on one line leave the slope across it open. One of a fitting set is over 0.5.
    if (determinant > 0.1) {
      const double gx = (cyy * cxz - cxy * cyz) / determinant;
      const double gy = (cxx * cyz - cxy * cxz) / determinant;
      out.slope = math::sqrt(gx * gx + gy * gy) / cell_m;
    }
    const double variance = zz / n - math::square(z / n);
    out.height_difference_m = highest - lowest;
    out.deviation_m = variance > 0 ? math::sqrt(variance) : 0.0;
    out.roughness_per_m = bends > 0 ? bend_sum / (bends * cell_m * cell_m) : 0.0;
    return out;
  }
};

}  // namespace

Status validate(const CostConfig& config) {
  RangeCheck check;
  CostConfig::describe(config, check);
  double last = 0;
  for (const double radius : config.radius_cells) {
    if (!check.good || radius != static_cast<std::int32_t>(radius) || radius <= last) {
      return Status::kInvalid;
    }
    last = radius;
  }
  double weight = 0;
  for (const FeatureCost* feature :
       {&config.slope, &config.height_difference, &config.deviation, &config.roughness}) {
    for (const double share : feature->weight) weight += share;
  }
  return weight > 0 ? Status::kOk : Status::kInvalid;
}

Status CostMap::configure(const CostConfig& config) {
  const Status status = validate(config);
  if (!ok(status)) return status;
  config_ = config;
  configured_ = true;
  total_weight_ = 0;
  for (std::size_t w = 0; w < kCostWindows; ++w) {
    radius_[w] = static_cast<std::int32_t>(config.radius_cells[w]);
    for (const FeatureCost* feature :
         {&config.slope, &config.height_difference, &config.deviation, &config.roughness}) {
      total_weight_ += feature->weight[w];
    }
  }
  view_ = {};
  row_ = 0;
  count_ = 0;
  return Status::kOk;
}

void CostMap::touch() {
  bend_m_.fill(0);
  sum_.fill(0);
  squares_.fill(0);
}

Status CostMap::start() {
  if (!configured_) return Status::kUnavailable;
  view_ = {};
  row_ = 0;
  count_ = 0;
  sum_.fill(0);
  squares_.fill(0);
  return Status::kOk;
}

Status CostMap::add(const HeightView& view) {
  if (!configured_) return Status::kUnavailable;
  const bool sides = view.columns >= 1 && view.columns <= kMaxSide && view.rows >= 1 &&
                     view.rows <= kMaxSide && view.pitch >= view.columns && view.cell_m > 0;
  const bool same = count_ == 0 || (view.columns == view_.columns && view.rows == view_.rows);
  if (!sides || !same) return Status::kInvalid;
  view_ = view;
  row_ = 0;
  count_ += 1;
  for (std::int32_t row = 0; row < view.rows; ++row) {
    for (std::int32_t column = 0; column < view.columns; ++column) {
      bend_m_[table_index(column, row, view.columns)] = bend(column, row);
    }
  }
  return Status::kOk;
}

bool CostMap::advance(std::int32_t rows) {
  const std::int32_t end = row_ + rows < view_.rows ? row_ + rows : view_.rows;
  for (; row_ < end; ++row_) {
    for (std::int32_t column = 0; column < view_.columns; ++column) {
      if (!known(column, row_)) continue;
      const auto cost = static_cast<float>(cost_of(features(column, row_)));
      const auto i = table_index(column, row_, view_.columns);
      sum_[i] += cost;
      squares_[i] += cost * cost;
    }
  }
  return row_ >= view_.rows;
}

double CostMap::spread(std::size_t i) const {
  if (!(count_ > 0)) return 0;
  const double variance = squares_[i] / count_ - math::square(cost(i));
  return variance > 0 ? math::sqrt(variance) : 0.0;
}

bool CostMap::known(std::int32_t column, std::int32_t row) const {
  return view_.state[row * view_.columns + column] != FilledState::kUnknown;
}

float CostMap::height(std::int32_t column, std::int32_t row) const {
  return view_.height_m[row * view_.pitch + column];
}

float CostMap::bend(std::int32_t column, std::int32_t row) const {
  if (column < 1 || row < 1 || column + 1 >= view_.columns || row + 1 >= view_.rows) return -1;
  if (!known(column - 1, row) || !known(column + 1, row) || !known(column, row - 1) ||
      !known(column, row + 1)) {
    return -1;
  }
  const float around = (height(column - 1, row) + height(column + 1, row)) +
                       (height(column, row - 1) + height(column, row + 1));
  const float laplacian = around - 4 * height(column, row);
  return laplacian < 0 ? -laplacian : laplacian;
}

CellFeatures CostMap::features(std::int32_t column, std::int32_t row) const {
  CellFeatures out;
  Moments moments;
  const double middle = height(column, row);
  std::int32_t inside = -1;  // radius of the windows already added up
  for (std::size_t w = 0; w < kCostWindows; ++w) {
    const std::int32_t radius = radius_[w];
    for (std::int32_t dy = -radius; dy <= radius; ++dy) {
      const std::int32_t r = row + dy;
      if (r < 0 || r >= view_.rows) continue;
      const bool through = dy >= -inside && dy <= inside;
      for (std::int32_t dx = -radius; dx <= radius; ++dx) {
        if (through && dx == -inside) dx = inside + 1;
        const std::int32_t c = column + dx;
        if (c < 0 || c >= view_.columns || !known(c, r)) continue;
        moments.add(dx, dy, static_cast<double>(height(c, r)) - middle);
        const float bend_m = bend_m_[table_index(c, r, view_.columns)];
        if (bend_m < 0) continue;
        moments.bends += 1;
        moments.bend_sum += static_cast<double>(bend_m);
      }
    }
    inside = radius;
    out[w] = moments.features(view_.cell_m);
  }
  return out;
}

double CostMap::cost_of(const CellFeatures& features) const {
  const std::array<const FeatureCost*, kCostFeatures> shares{
      &config_.slope, &config_.height_difference, &config_.deviation, &config_.roughness};
  double sum = 0;
  for (std::size_t w = 0; w < kCostWindows; ++w) {
    const std::array<double, kCostFeatures> values = features[w].values();
    for (std::size_t k = 0; k < kCostFeatures; ++k) {
      const double share = values[k] / shares[k]->scale[w];
      sum += shares[k]->weight[w] * (share < 1 ? share : 1.0);
    }
  }
  return sum / total_weight_;
}

}  // namespace surefoot::terrain
