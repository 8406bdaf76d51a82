#include "core/mapping/line_of_sight.h"

#include <algorithm>
#include <array>

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

// Below this descent (about 6 degrees) the height margins are not stretched further along the ray.
constexpr double kLeastDescent = 0.1;

// The camera, ready to look at many cells.
class CellView {
 public:
  explicit CellView(const Sight& sight)
      : sight_(sight),
        x_C_(sight.X_OC.rotation.matrix.row(0).transpose()),
        y_C_(sight.X_OC.rotation.matrix.row(1).transpose()),
        z_C_(sight.X_OC.rotation.matrix.row(2).transpose()),
        camera_z_m_(sight.X_OC.origin.m.z()) {
    const double half = 0.5 * sight.config.cell_size_m;
    half_diagonal_px_m_ = 1.4143 * half * std::max(sight.image.fx, sight.image.fy);
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      corners_[i] = x_C_ * (i % 2 == 0 ? -half : half) + y_C_ * (i / 2 == 0 ? -half : half);
    }
  }

  enum class Verdict { kNone, kConsistent, kSeenThrough };

  // offset_x, offset_y: the cell's centre from the camera, in O. Near the camera a cell is wider
  // than three pixels, and the surface may fill but a corner of it: all corners must be seen
  // through, unless they lie within a pixel of the centre.
  Verdict look_at_cell(double offset_x, double offset_y, const MapCell& cell) const {
    const double rise = static_cast<double>(cell.height_m) - camera_z_m_;
    const Vector3 centre_C = x_C_ * offset_x + y_C_ * offset_y + z_C_ * rise;
    const double seen = seen_at(centre_C);
    const double gap = seen - centre_C.z();
    const double least = sight_.config.clear_margin_m;
    if (!(seen > 0) || gap < -least) return Verdict::kNone;  // no answer, or hidden
    if (gap <= least) return Verdict::kConsistent;
    const double margin = height_margin(offset_x, offset_y, rise, cell);
    if (!(gap > margin + depth_margin(seen))) return Verdict::kConsistent;
    // Small in the image: the pixels around the centre's are those of the corners.
    if (half_diagonal_px_m_ <= centre_C.z()) return Verdict::kSeenThrough;
    for (const Vector3& corner_C : corners_) {
      const Vector3 p_C = centre_C + corner_C;
      const double behind = seen_at(p_C);
      if (!(behind > 0) || !(behind - p_C.z() > margin + depth_margin(behind))) {
        return Verdict::kNone;
      }
    }
    return Verdict::kSeenThrough;
  }

 private:
  // Nearest depth around the point's pixel; 0: outside of the image, or not all measured.
  double seen_at(const Vector3& p_C) const {
    if (p_C.z() < sight_.sensor.min_range_m) return 0;
    const DepthImage& image = sight_.image;
    const double inverse = 1.0 / p_C.z();
    const double u = image.fx * p_C.x() * inverse + image.cx + 0.5;
    const double v = image.fy * p_C.y() * inverse + image.cy + 0.5;
    if (!(u >= 0 && v >= 0 && u < image.width && v < image.height)) return 0;
    return static_cast<double>(
        image.nearest_m[image.at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v))]);
  }

  // How far behind the cell the ray must end: noise of the depth ...
  double depth_margin(double seen) const {
    const MappingConfig& config = sight_.config;
    return config.clear_sigma *
           (seen * seen * sight_.sensor.inverse_depth_sigma_per_m + config.depth_noise_floor_m);
  }
  // ... and what an error of the cell's height or of the attitude amounts to along a ray that
  // descends at a grazing angle.
  double height_margin(double offset_x, double offset_y, double rise, const MapCell& cell) const {
    const MappingConfig& config = sight_.config;
    const double range2 = offset_x * offset_x + offset_y * offset_y;
    const double height_sigma = math::sqrt(static_cast<double>(cell.variance_m2) +
                                           math::square(config.attitude_noise_rad) * range2);
    const double range = math::sqrt(range2);
    const double descent =
        std::max((rise < 0 ? -rise : rise) / std::max(range, 1e-3), kLeastDescent);
    return config.clear_margin_m +
           (config.clear_height_margin_m + config.clear_sigma * height_sigma) / descent;
  }

  const Sight& sight_;
  // The axes of O, and the corners of a cell from its centre, in the camera's frame C.
  Vector3 x_C_;
  Vector3 y_C_;
  Vector3 z_C_;
  double camera_z_m_;
  std::array<Vector3, 4> corners_;
  double half_diagonal_px_m_ = 0;  // in pixels, times the depth at which it is seen
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

// Marches one ray back from where it ended.
class CeilingRay {
 public:
  CeilingRay(const Sight& sight, ControlMap& map)
      : sight_(sight),
        size_(sight.config.cell_size_m),
        camera_(cell_index(sight.X_OC.origin.m.x(), sight.X_OC.origin.m.y(), size_)),
        around_(map, camera_) {}

  // direction: of one unit of depth, in O; depth: of the surface.
  void lower(const Vector3& direction, double depth, IntegrationReport& report) const {
    const double horizontal =
        math::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
    if (horizontal < 1e-3) return;
    const double step = sight_.config.ray_step_cells * size_ / horizontal;
    // The end's own noise must not enter: start above it by the margin of the clearing.
    const double sigma = depth * depth * sight_.sensor.inverse_depth_sigma_per_m;
    const double end = depth - sight_.config.clear_sigma * sigma - size_;
    // The sample is one height of the cell's stretch of the ray; its highest is at most this above.
    const double slack =
        size_ * 0.7072 * (direction.z() < 0 ? -direction.z() : direction.z()) / horizontal;
    const Vector3& origin = sight_.X_OC.origin.m;
    // In cells, counted from the camera's cell and shifted so that truncation rounds down.
    const double inverse = 1.0 / size_;
    const double base_x = origin.x() * inverse - camera_.ix + kShift;
    const double base_y = origin.y() * inverse - camera_.iy + kShift;
    double t = end;
    for (std::int32_t i = 0; i < kMaxCellsPerRay && t > 0; ++i, t -= step) {
      const double x = base_x + t * direction.x() * inverse;
      const double y = base_y + t * direction.y() * inverse;
      if (!(x >= 0 && y >= 0 && x < 2 * kShift && y < 2 * kShift)) continue;
      MapCell* cell = around_.find(static_cast<std::int32_t>(x) - kShift,
                                   static_cast<std::int32_t>(y) - kShift);
      if (cell == nullptr || cell->state > CellState::kBounded) continue;
      const auto ceiling = static_cast<float>(origin.z() + t * direction.z() + slack);
      if (cell->state == CellState::kBounded && cell->height_m <= ceiling) continue;
      cell->height_m = ceiling;
      cell->state = CellState::kBounded;
      cell->stamp_ms = sight_.now_ms;
      ++report.ceilings;
    }
  }

 private:
  static constexpr std::int32_t kShift = kMapSide / 2;

  const Sight& sight_;
  double size_;
  CellIndex camera_;
  ControlMap::Around around_;
};

}  // namespace

void clear_seen_through(const Sight& sight, ControlMap& map, IntegrationReport& report) {
  const CellView view(sight);
  const double size = sight.config.cell_size_m;
  const Vector3& origin = sight.X_OC.origin.m;
  const CellRange range = seen_range(sight, map.first());
  for (std::int32_t iy = range.iy_begin; iy < range.iy_end; ++iy) {
    const double offset_y = cell_centre(iy, size) - origin.y();
    map.for_row(iy, range.ix_begin, range.ix_end, [&](std::int32_t ix, MapCell& cell) {
      if (!cell.has_height() || cell.stamp_ms == sight.now_ms) return;
      const double offset_x = cell_centre(ix, size) - origin.x();
      switch (view.look_at_cell(offset_x, offset_y, cell)) {
        case CellView::Verdict::kNone: break;
        case CellView::Verdict::kConsistent: cell.misses = 0; break;
        case CellView::Verdict::kSeenThrough: doubt(sight, cell, report); break;
      }
    });
  }
}

void lower_ceilings(const Sight& sight, std::uint64_t phase, ControlMap& map,
                    IntegrationReport& report) {
  const DepthImage& image = sight.image;
  const std::int32_t stride = sight.config.ceiling_pixel_stride;
  const auto cycle = static_cast<std::uint64_t>(stride);
  const auto u_begin = static_cast<std::int32_t>(phase % cycle);
  const auto v_begin = static_cast<std::int32_t>(phase / cycle % cycle);
  const Matrix3& R_OC = sight.X_OC.rotation.matrix;
  const CeilingRay ray(sight, map);
  for (std::int32_t v = v_begin; v < image.height; v += stride) {
    for (std::int32_t u = u_begin; u < image.width; u += stride) {
      const auto depth = static_cast<double>(image.z_m[image.at(u, v)]);
      if (!(depth > 0)) continue;
      const Vector3 direction = R_OC * Vector3(image.across[static_cast<std::size_t>(u)],
                                               image.down[static_cast<std::size_t>(v)], 1.0);
      ray.lower(direction, std::min(depth, sight.sensor.max_range_m), report);
    }
  }
}

}  // namespace surefoot::mapping
