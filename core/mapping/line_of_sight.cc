#include "core/mapping/line_of_sight.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "core/math/elementary.h"
#include "core/math/lanes.h"

namespace surefoot::mapping {
namespace {

// Below this descent (about 6 degrees) the height margins are not stretched further along the ray.
constexpr float kLeastDescent = 0.1F;

// Four neighbours in a row of the map, field by field.
struct CellLanes {
  Lanes height_m;
  Lanes variance_m2;
  LaneMask wanted;  // has a height that this frame did not measure

  CellLanes(const MapCell* cells, std::uint32_t now_ms) {
    static_assert(offsetof(MapCell, height_m) == 0 && offsetof(MapCell, variance_m2) == 4 &&
                  offsetof(MapCell, stamp_ms) == 8 && offsetof(MapCell, state) == 14);
    const Lanes a = load_cell(cells[0]);
    const Lanes b = load_cell(cells[1]);
    const Lanes c = load_cell(cells[2]);
    const Lanes d = load_cell(cells[3]);
    const Lanes ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Lanes cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Lanes ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Lanes cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    height_m = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
    variance_m2 = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
    const LaneMask stamps = bits(__builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5));
    const LaneMask rest = bits(__builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7));
    const LaneMask states = (rest >> 16) & 0xFF;
    wanted = (states >= static_cast<std::int32_t>(CellState::kAssumed)) &
             (stamps != static_cast<std::int32_t>(now_ms));
  }

 private:
  static Lanes load_cell(const MapCell& cell) {
    Lanes lanes;
    std::memcpy(&lanes, &cell, sizeof(lanes));
    return lanes;
  }
};

// The camera, ready to look at many cells. In floats, as heights are: what they round off a
// distance of some metres is less than a thousandth of the margins.
class CellView {
 public:
  explicit CellView(const Sight& sight)
      : sight_(sight),
        image_(sight.image),
        size_m_(static_cast<float>(sight.config.cell_size_m)),
        camera_z_m_(all_lanes(static_cast<float>(sight.X_OC.origin.m.z()))),
        lens_{lane(image_.fx), lane(image_.fy),    lane(image_.cx),
              lane(image_.cy), lane(image_.width), lane(image_.height)},
        min_range_m_(lane(sight.sensor.min_range_m)),
        inverse_depth_sigma_1_m_(lane(sight.sensor.inverse_depth_sigma_per_m)),
        depth_floor_m_(lane(sight.config.depth_noise_floor_m)),
        attitude_variance_(lane(math::square(sight.config.attitude_noise_rad))),
        clear_sigma_(lane(sight.config.clear_sigma)),
        margin_m_(lane(sight.config.clear_margin_m)),
        height_margin_m_(lane(sight.config.clear_height_margin_m)) {
    half_diagonal_px_m_ =
        lane(1.4143 * 0.5 * sight.config.cell_size_m * std::max(image_.fx, image_.fy));
    const Matrix3& R_OC = sight.X_OC.rotation.matrix;
    const Lanes half_x = Lanes{-0.5F, 0.5F, -0.5F, 0.5F} * size_m_;
    const Lanes half_y = Lanes{-0.5F, -0.5F, 0.5F, 0.5F} * size_m_;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      x_C_[k] = lane(R_OC(0, axis));
      z_C_[k] = lane(R_OC(2, axis));
      corners_[k] = x_C_[k] * half_x + lane(R_OC(1, axis)) * half_y;
    }
  }

  // A bit for each lane. Neither: no answer, or the cell is hidden.
  struct Verdicts {
    std::uint32_t consistent = 0;
    std::uint32_t seen_through = 0;
  };

  // The row's distance from the camera, for the cells that are looked at next.
  void enter_row(double offset_y) {
    for (std::size_t k = 0; k < 3; ++k) {
      row_C_[k] = lane(sight_.X_OC.rotation.matrix(1, static_cast<Eigen::Index>(k)) * offset_y);
    }
    row_distance2_ = lane(offset_y * offset_y);
  }

  // offset_x: of the first cell's centre from the camera, in O. Near the camera a cell is wider
  // than three pixels, and the surface may fill but a corner of it: all corners must be seen
  // through, unless they lie within a pixel of the centre.
  Verdicts look_at(double offset_x, const CellLanes& cells) const {
    const Lanes x = static_cast<float>(offset_x) + Lanes{0, 1, 2, 3} * size_m_;
    const Lanes rise = cells.height_m - camera_z_m_;
    const Axes centre{x_C_[0] * x + row_C_[0] + z_C_[0] * rise,
                      x_C_[1] * x + row_C_[1] + z_C_[1] * rise,
                      x_C_[2] * x + row_C_[2] + z_C_[2] * rise};
    const Lanes seen = seen_at(centre, cells.wanted);
    const Lanes gap = seen - centre[2];
    const LaneMask answers = (seen > 0.0F) & (gap >= -margin_m_);
    if (lane_bits(answers) == 0) return {};
    const Lanes margin = height_margin(x, rise, cells.variance_m2);
    const LaneMask free = answers & (gap > margin_m_) & (gap > margin + depth_margin(seen));
    // Small in the image: the pixels around the centre's are those of the corners.
    const std::uint32_t large = lane_bits(free & (half_diagonal_px_m_ > centre[2]));
    std::uint32_t seen_through = lane_bits(free) & ~large;
    for (std::uint32_t i = 0; large >> i != 0; ++i) {
      if ((large >> i & 1u) == 0) continue;
      const Axes corners{centre[0][i] + corners_[0], centre[1][i] + corners_[1],
                         centre[2][i] + corners_[2]};
      if (all_free(corners, all_lanes(margin[i]))) seen_through |= 1u << i;
    }
    return {lane_bits(answers & ~free), seen_through};
  }

 private:
  using Axes = std::array<Lanes, 3>;  // in C
  struct Lens {
    Lanes fx;
    Lanes fy;
    Lanes cx;
    Lanes cy;
    Lanes width;
    Lanes height;
  };
  static Lanes lane(double a) { return all_lanes(static_cast<float>(a)); }

  bool all_free(const Axes& p_C, Lanes margin) const {
    const Lanes seen = seen_at(p_C, LaneMask{-1, -1, -1, -1});
    return lane_bits((seen > 0.0F) & (seen - p_C[2] > margin + depth_margin(seen))) == 0xFu;
  }

  // Nearest depth around the points' pixels; 0: outside of the image, or not all measured, or the
  // point is not wanted.
  Lanes seen_at(const Axes& p_C, LaneMask wanted) const {
    const Lanes inverse = 1.0F / p_C[2];
    const Lanes u = lens_.fx * p_C[0] * inverse + lens_.cx + 0.5F;
    const Lanes v = lens_.fy * p_C[1] * inverse + lens_.cy + 0.5F;
    const LaneMask visible = wanted & (p_C[2] >= min_range_m_) & (u >= 0.0F) & (v >= 0.0F) &
                             (u < lens_.width) & (v < lens_.height);
    if (lane_bits(visible) == 0) return Lanes{};
    const Lanes column = whole(from_bits(bits(u) & visible));
    const Lanes row = whole(from_bits(bits(v) & visible));
    // Exact: fewer than 2^24 pixels. The first pixel is on the border and thus 0.
    const LaneMask pixel = __builtin_convertvector(row * lens_.width + column, LaneMask);
    const float* nearest_m = image_.nearest_m.data();
    return Lanes{nearest_m[pixel[0]], nearest_m[pixel[1]], nearest_m[pixel[2]],
                 nearest_m[pixel[3]]};
  }
  static Lanes whole(Lanes a) {
    return __builtin_convertvector(__builtin_convertvector(a, LaneMask), Lanes);
  }

  // How far behind the cell the ray must end: noise of the depth ...
  Lanes depth_margin(Lanes seen) const {
    return clear_sigma_ * (seen * seen * inverse_depth_sigma_1_m_ + depth_floor_m_);
  }
  // ... and what an error of the cell's height or of the attitude amounts to along a ray that
  // descends at a grazing angle.
  Lanes height_margin(Lanes x, Lanes rise, Lanes variance_m2) const {
    const Lanes range2 = x * x + row_distance2_;
    const Lanes height_sigma = square_root(variance_m2 + attitude_variance_ * range2);
    const Lanes range = larger(square_root(range2), all_lanes(1e-3F));
    const Lanes descent = larger(magnitude(rise) / range, all_lanes(kLeastDescent));
    return margin_m_ + (height_margin_m_ + clear_sigma_ * height_sigma) / descent;
  }

  const Sight& sight_;
  const DepthImage& image_;
  float size_m_;
  // The axes of O, and the corners of a cell from its centre, in the camera's frame C.
  Axes x_C_;
  Axes z_C_;
  Axes corners_;
  Lanes camera_z_m_;
  Lens lens_;
  Lanes min_range_m_;
  Lanes inverse_depth_sigma_1_m_;
  Lanes depth_floor_m_;
  Lanes attitude_variance_;
  Lanes clear_sigma_;
  Lanes margin_m_;
  Lanes height_margin_m_;
  Lanes half_diagonal_px_m_;  // in pixels, times the depth at which it is seen
  Axes row_C_{};
  Lanes row_distance2_{};
};

struct CellRange {
  std::int32_t ix_begin;
  std::int32_t ix_end;
  std::int32_t iy_begin;
  std::int32_t iy_end;
};

// The cells under the pyramid of view down to the farthest depth that could clear something, within
// kMaxClearRadius_cells of the camera and inside the map.
CellRange seen_range(const Sight& sight, CellIndex first) {
  const double size = sight.config.cell_size_m;
  const DepthImage& image = sight.image;
  const Vector3& origin = sight.X_OC.origin.m;
  const double radius = kMaxClearRadius_cells * size;
  Vector3 low = origin;
  Vector3 high = origin;
  for (int corner = 0; corner < 4; ++corner) {
    const double u = corner % 2 == 0 ? 0 : image.width;
    const double v = corner / 2 == 0 ? 0 : image.height;
    const Vector3 ray((u - image.cx) / image.fx, (v - image.cy) / image.fy, 1.0);
    const Vector3 end =
        origin + sight.X_OC.rotation.matrix * ray * static_cast<double>(image.farthest_m);
    low = low.cwiseMin(end);
    high = high.cwiseMax(end);
  }
  low = low.cwiseMax(origin - Vector3::Constant(radius));
  high = high.cwiseMin(origin + Vector3::Constant(radius));
  const CellIndex begin = cell_index(low.x(), low.y(), size);
  const CellIndex end = cell_index(high.x(), high.y(), size);
  const auto clip = [](std::int32_t i, std::int32_t least) {
    return math::clamp(i, least, least + kMapSide);
  };
  return {clip(begin.ix, first.ix), clip(end.ix + 1, first.ix), clip(begin.iy, first.iy),
          clip(end.iy + 1, first.iy)};
}

// Called for a cell that was seen through.
void doubt(const Sight& sight, MapCell& cell, IntegrationReport& report) {
  ++cell.misses;
  if (cell.misses < sight.config.clear_frames) {
    ++report.cells_doubted;
    return;
  }
  // What remains true: a line of sight passes where the top was.
  const float ceiling = cell.height_m;
  cell = MapCell{};
  cell.height_m = ceiling;
  cell.stamp_ms = sight.now_ms;
  cell.state = CellState::kBounded;
  ++report.cells_cleared;
}

// `count` <= 4 neighbours in a row.
void look_at_cells(const Sight& sight, const CellView& view, double offset_x, MapCell* cells,
                   std::int32_t count, IntegrationReport& report) {
  std::array<MapCell, kLanes> padded{};
  if (count < kLanes) std::copy_n(cells, count, padded.begin());
  const CellLanes lanes(count < kLanes ? padded.data() : cells, sight.now_ms);
  const std::uint32_t wanted = lane_bits(lanes.wanted);
  if (wanted == 0) return;
  report.cells_looked_at +=
      (wanted & 1u) + (wanted >> 1u & 1u) + (wanted >> 2u & 1u) + (wanted >> 3u);
  const CellView::Verdicts verdicts = view.look_at(offset_x, lanes);
  if ((verdicts.consistent | verdicts.seen_through) == 0) return;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    if ((verdicts.consistent >> i & 1u) != 0) cells[i].misses = 0;
    if ((verdicts.seen_through >> i & 1u) != 0) doubt(sight, cells[i], report);
  }
}

// Marches one ray back from where it ended.
class CeilingRay {
 public:
  CeilingRay(const Sight& sight, ControlMap& map)
      : sight_(sight),
        map_(map),
        size_(sight.config.cell_size_m),
        inverse_(1.0 / size_),
        camera_(cell_index(sight.X_OC.origin.m.x(), sight.X_OC.origin.m.y(), size_)),
        around_(map, camera_),
        // In cells, counted from the camera's cell and shifted so that truncation rounds down.
        base_x_(sight.X_OC.origin.m.x() * inverse_ - camera_.ix + kShift),
        base_y_(sight.X_OC.origin.m.y() * inverse_ - camera_.iy + kShift) {}

  // direction: of one unit of depth, in O; depth: of the surface. Returns the steps it took.
  std::int32_t lower(const Vector3& direction, double depth, IntegrationReport& report) const {
    const double horizontal =
        math::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
    if (horizontal < 1e-3) return 0;
    const double step = sight_.config.ray_step_cells * size_ / horizontal;
    // The end's own noise must not enter: start above it by the margin of the clearing.
    const double sigma = depth * depth * sight_.sensor.inverse_depth_sigma_per_m;
    const double end = depth - sight_.config.clear_sigma * sigma - size_;
    // The sample is one height of the cell's stretch of the ray; its highest is at most this above.
    const double slack =
        size_ * 0.7072 * (direction.z() < 0 ? -direction.z() : direction.z()) / horizontal;
    // A ray whose both ends are in the map stays there.
    const bool inside = is_inside(direction, end) && is_inside(direction, 0);
    return inside ? march<true>(direction, end, step, slack, report)
                  : march<false>(direction, end, step, slack, report);
  }

 private:
  static constexpr std::int32_t kShift = kMapSide / 2;

  bool is_inside(const Vector3& direction, double t) const {
    const double x = base_x_ + t * direction.x() * inverse_;
    const double y = base_y_ + t * direction.y() * inverse_;
    if (!(x >= 0 && y >= 0 && x < 2 * kShift && y < 2 * kShift)) return false;
    return map_.contains({camera_.ix + static_cast<std::int32_t>(x) - kShift,
                          camera_.iy + static_cast<std::int32_t>(y) - kShift});
  }

  template <bool kInside>
  std::int32_t march(const Vector3& direction, double end, double step, double slack,
                     IntegrationReport& report) const {
    const double camera_z_m = sight_.X_OC.origin.m.z();
    double t = end;
    std::int32_t steps = 0;
    for (; steps < kMaxCellsPerRay && t > 0; ++steps, t -= step) {
      const double x = base_x_ + t * direction.x() * inverse_;
      const double y = base_y_ + t * direction.y() * inverse_;
      if (!kInside && !(x >= 0 && y >= 0 && x < 2 * kShift && y < 2 * kShift)) continue;
      const std::int32_t dx = static_cast<std::int32_t>(x) - kShift;
      const std::int32_t dy = static_cast<std::int32_t>(y) - kShift;
      if (!kInside && !around_.contains(dx, dy)) continue;
      MapCell& cell = around_.at(dx, dy);
      if (cell.state > CellState::kBounded) continue;
      const auto ceiling = static_cast<float>(camera_z_m + t * direction.z() + slack);
      if (cell.state == CellState::kBounded && cell.height_m <= ceiling) continue;
      cell.height_m = ceiling;
      cell.state = CellState::kBounded;
      cell.stamp_ms = sight_.now_ms;
      ++report.ceilings;
    }
    return steps;
  }

  const Sight& sight_;
  const ControlMap& map_;
  double size_;
  double inverse_;
  CellIndex camera_;
  ControlMap::Around around_;
  double base_x_;
  double base_y_;
};

}  // namespace

void clear_seen_through(const Sight& sight, SightTurn& turn, ControlMap& map,
                        IntegrationReport& report) {
  CellView view(sight);
  const double size = sight.config.cell_size_m;
  const Vector3& origin = sight.X_OC.origin.m;
  const CellRange range = seen_range(sight, map.first());
  const std::int32_t rows = range.iy_end - range.iy_begin;
  const auto columns = static_cast<std::uint32_t>(std::max(range.ix_end - range.ix_begin, 0));
  std::int32_t iy = turn.clear_row;
  if (iy < range.iy_begin || iy >= range.iy_end) iy = range.iy_begin;
  for (std::int32_t i = 0; i < rows; ++i) {
    if (report.cells_looked_at + columns > kMaxLooks) {
      report.rows_put_off = static_cast<std::uint32_t>(rows - i);
      break;
    }
    view.enter_row(cell_centre(iy, size) - origin.y());
    map.for_runs(iy, range.ix_begin, range.ix_end,
                 [&](std::int32_t ix, MapCell* cells, std::int32_t count) {
                   for (std::int32_t k = 0; k < count; k += kLanes) {
                     look_at_cells(sight, view, cell_centre(ix + k, size) - origin.x(), cells + k,
                                   std::min(kLanes, count - k), report);
                   }
                 });
    if (++iy == range.iy_end) iy = range.iy_begin;
  }
  turn.clear_row = iy;
}

void lower_ceilings(const Sight& sight, SightTurn& turn, ControlMap& map,
                    IntegrationReport& report) {
  const DepthImage& image = sight.image;
  const std::int32_t stride = sight.config.ceiling_pixel_stride;
  const auto cycle = static_cast<std::uint64_t>(stride);
  const auto u_begin = static_cast<std::int32_t>(turn.ceiling_pass % cycle);
  const auto v_begin = static_cast<std::int32_t>(turn.ceiling_pass / cycle % cycle);
  const std::int32_t columns = (image.width - u_begin + stride - 1) / stride;
  const std::int32_t rows = (image.height - v_begin + stride - 1) / stride;
  const std::int32_t rays = std::max(columns, 0) * std::max(rows, 0);
  const Matrix3& R_OC = sight.X_OC.rotation.matrix;
  const CeilingRay ray(sight, map);
  std::int32_t steps = 0;
  for (std::int32_t i = turn.ceiling_ray; i < rays; ++i) {
    if (steps + kMaxCellsPerRay > kMaxCeilingSteps) {
      report.rays_put_off = static_cast<std::uint32_t>(rays - i);
      turn.ceiling_ray = i;
      return;
    }
    const std::int32_t u = u_begin + i % columns * stride;
    const std::int32_t v = v_begin + i / columns * stride;
    const auto depth = static_cast<double>(image.z_m[image.at(u, v)]);
    if (!(depth > 0)) continue;
    const Vector3 direction = R_OC * Vector3(image.across[static_cast<std::size_t>(u)],
                                             image.down[static_cast<std::size_t>(v)], 1.0);
    steps += ray.lower(direction, std::min(depth, sight.sensor.max_range_m), report);
  }
  turn.ceiling_ray = 0;
  ++turn.ceiling_pass;
}

}  // namespace surefoot::mapping
