#include "core/autonomy/ledge.h"

#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

constexpr double kMinShare = 0.8;       // of the lines that must end at the edge
constexpr double kOutlier_m = 0.03;     // of an end, off the line
constexpr double kMaxSpread_m = 0.015;  // rms
constexpr std::size_t kStepCells = 4;   // within which the ground rises or falls
constexpr double kSameGround_m = 0.03;  // less is roughness
constexpr double kSameLevel_m = 0.08;   // far side of a gap, to the near one
constexpr std::int32_t kFarCells = 3;   // in a row that make a far side
constexpr double kTopFrom_m = 0.03;     // behind the edge, where its height is taken
constexpr double kTopTo_m = 0.20;

using math::magnitude;

// Where a line ends, in the frame of the query: x along the heading.
struct End {
  bool found = false;
  bool used = true;
  Ledge::Kind kind = Ledge::Kind::kPlatform;
  double x_m = 0;       // of the edge
  double y_m = 0;       // of the line
  double ground_m = 0;  // height before the edge
  double top_m = 0;     // mean height behind it
  double far_m = 0;     // gap: where the ground goes on
};

// The heights that a line has passed over.
class Trail {
 public:
  explicit Trail(double ground_m) { heights_m_.fill(ground_m); }
  double ground_m() const { return heights_m_[next_]; }  // kStepCells cells ago
  double last_m() const { return heights_m_[(next_ + kStepCells - 1) % kStepCells]; }
  void pass(double height_m) {
    heights_m_[next_] = height_m;
    next_ = (next_ + 1) % kStepCells;
  }

 private:
  std::array<double, kStepCells> heights_m_{};
  std::size_t next_ = 0;
};

class Search {
 public:
  Search(const mapping::MapWindow& window, const LedgeQuery& query)
      : window_(window), query_(query), heading_(math::sin_cos(query.yaw_rad)) {}

  End look(double y_m, double from_m) const {
    End end;
    end.y_m = y_m;
    const double reach_m = 0.5 * mapping::kWindowSide * window_.cell_size_m;
    Trail trail(ground_at(from_m, y_m));
    double last_x_m = from_m;  // of ground on the level of that before it
    for (double x_m = from_m; x_m < reach_m; x_m += window_.cell_size_m) {
      const mapping::WindowCell* here = cell(x_m, y_m);
      if (here == nullptr) return end;
      const double rise_m = here->height_m - trail.ground_m();
      end.ground_m = trail.ground_m();
      if (here->has_height() && rise_m >= query_.min_rise_m) {
        end.kind = Ledge::Kind::kPlatform;
        end.x_m = x_m;
        return with_top(end);
      }
      if (here->state != mapping::CellState::kUnknown && rise_m <= -query_.min_drop_m) {
        end.kind = Ledge::Kind::kGap;
        end.x_m = last_x_m;
        return with_far_side(end, x_m, reach_m);
      }
      if (here->has_height() && rise_m >= -kSameGround_m) last_x_m = x_m;
      trail.pass(here->has_height() ? here->height_m : trail.last_m());
    }
    return end;
  }

 private:
  // Where a line begins: what the map says, unless that is a platform right there or nothing.
  double ground_at(double x_m, double y_m) const {
    const mapping::WindowCell* here = cell(x_m, y_m);
    const bool ground = here != nullptr && here->has_height() &&
                        here->height_m - query_.ground_z_m < query_.min_rise_m;
    return ground ? here->height_m : query_.ground_z_m;
  }

  const mapping::WindowCell* cell(double x_m, double y_m) const {
    const auto index = window_.locate(query_.x_O_m + heading_.cos * x_m - heading_.sin * y_m,
                                      query_.y_O_m + heading_.sin * x_m + heading_.cos * y_m);
    return index.ok() ? window_.find(index.value()) : nullptr;
  }

  End with_top(End end) const {
    double sum_m = 0;
    double first_m = 0;
    int count = 0;
    for (double x_m = end.x_m + kTopFrom_m; x_m < end.x_m + kTopTo_m; x_m += window_.cell_size_m) {
      const mapping::WindowCell* here = cell(x_m, end.y_m);
      if (here == nullptr || !here->has_height()) continue;
      if (count == 0) first_m = here->height_m;
      if (magnitude(here->height_m - first_m) > kSameGround_m) continue;
      sum_m += here->height_m;
      ++count;
    }
    end.found = count > 0;
    if (end.found) end.top_m = sum_m / count;
    return end;
  }

  End with_far_side(End end, double from_m, double reach_m) const {
    std::int32_t level = 0;
    double sum_m = 0;
    for (double x_m = from_m; x_m < reach_m; x_m += window_.cell_size_m) {
      const mapping::WindowCell* here = cell(x_m, end.y_m);
      const bool there = here != nullptr && here->has_height() &&
                         magnitude(here->height_m - end.ground_m) <= kSameLevel_m;
      level = there ? level + 1 : 0;
      sum_m = there ? sum_m + here->height_m : 0.0;
      if (level < kFarCells) continue;
      end.far_m = x_m - (kFarCells - 1) * window_.cell_size_m;
      end.top_m = sum_m / kFarCells;
      end.found = true;
      return end;
    }
    return end;
  }

  const mapping::MapWindow& window_;
  const LedgeQuery& query_;
  math::SinCos heading_;
};

// x = offset + slope y by least squares.
struct Line {
  double offset_m = 0;
  double slope = 0;
  double spread_m = 0;
  std::size_t count = 0;
};

using Ends = std::array<End, kLedgeLines>;

Line fit(const Ends& ends) {
  double n = 0;
  double sx = 0;
  double sy = 0;
  double syy = 0;
  double sxy = 0;
  for (const End& end : ends) {
    if (!end.found || !end.used) continue;
    n += 1;
    sx += end.x_m;
    sy += end.y_m;
    syy += end.y_m * end.y_m;
    sxy += end.x_m * end.y_m;
  }
  Line line;
  line.count = static_cast<std::size_t>(n);
  const double determinant = n * syy - sy * sy;
  if (n < 3 || determinant <= 0) return {};
  line.slope = (n * sxy - sx * sy) / determinant;
  line.offset_m = (sx - line.slope * sy) / n;
  double squares = 0;
  for (const End& end : ends) {
    if (!end.found || !end.used) continue;
    squares += math::square(end.x_m - line.offset_m - line.slope * end.y_m);
  }
  line.spread_m = math::sqrt(squares / n);
  return line;
}

// The kind that most lines end at; the others are left out.
Ledge::Kind choose_kind(Ends& ends) {
  int gaps = 0;
  int platforms = 0;
  for (const End& end : ends) {
    if (!end.found) continue;
    ++(end.kind == Ledge::Kind::kGap ? gaps : platforms);
  }
  const Ledge::Kind kind = gaps > platforms ? Ledge::Kind::kGap : Ledge::Kind::kPlatform;
  for (End& end : ends) end.used = end.found && end.kind == kind;
  return kind;
}

}  // namespace

double Ledge::distance_m(double x_O_m, double y_O_m) const {
  const math::SinCos normal = math::sin_cos(yaw_rad);
  return normal.cos * (edge_O_m[0] - x_O_m) + normal.sin * (edge_O_m[1] - y_O_m);
}

Result<Ledge> find_ledge(const mapping::MapWindow& window, const LedgeQuery& query) {
  if (window.cell_size_m <= 0) return Status::kUnavailable;
  const Search search(window, query);
  Ends ends;
  for (std::size_t i = 0; i < kLedgeLines; ++i) {
    const double share = 2.0 * static_cast<double>(i) / (kLedgeLines - 1) - 1.0;
    const double stagger_m = 0.25 * static_cast<double>(i % 4) * window.cell_size_m;
    ends[i] = search.look(share * query.half_width_m, query.from_m + stagger_m);
  }
  Ledge ledge;
  ledge.kind = choose_kind(ends);
  Line line = fit(ends);
  if (line.count == 0) return Status::kNotFound;
  for (End& end : ends) {
    const double off = end.x_m - line.offset_m - line.slope * end.y_m;
    end.used = end.used && magnitude(off) <= kOutlier_m;
  }
  line = fit(ends);
  const double needed = kMinShare * static_cast<double>(kLedgeLines);
  if (static_cast<double>(line.count) < needed || line.spread_m > kMaxSpread_m) {
    return Status::kNotFound;
  }
  double ground_m = 0;
  double rise_m = 0;
  double gap_m = 0;
  for (const End& end : ends) {
    if (!end.used) continue;
    ground_m += end.ground_m / static_cast<double>(line.count);
    rise_m += (end.top_m - end.ground_m) / static_cast<double>(line.count);
    gap_m += (end.far_m - end.x_m) / static_cast<double>(line.count);
  }
  const double turn_rad = -math::atan(line.slope);
  const math::SinCos heading = math::sin_cos(query.yaw_rad);
  ledge.edge_O_m = Vector3(query.x_O_m + heading.cos * line.offset_m,
                           query.y_O_m + heading.sin * line.offset_m, ground_m);
  ledge.yaw_rad = math::wrap_angle(query.yaw_rad + turn_rad);
  ledge.rise_m = rise_m;
  ledge.spread_m = line.spread_m;
  if (ledge.kind == Ledge::Kind::kGap) ledge.gap_m = gap_m * math::cos(turn_rad);
  return ledge;
}

bool landing_is_free(const mapping::MapWindow& window, const Ledge& ledge, double along_edge_m,
                     const LandingArea& area) {
  if (window.cell_size_m <= 0) return false;
  const math::SinCos normal = math::sin_cos(ledge.yaw_rad);
  const auto steps = static_cast<std::int32_t>(area.length_m / window.cell_size_m);
  const auto side = static_cast<std::int32_t>(area.half_width_m / window.cell_size_m);
  const double level_m = ledge.edge_O_m[2] + ledge.rise_m;
  std::int32_t known = 0;
  for (std::int32_t i = 0; i <= steps; ++i) {
    for (std::int32_t j = -side; j <= side; ++j) {
      const double along_m = area.from_m + i * window.cell_size_m;
      const double across_m = along_edge_m + j * window.cell_size_m;
      const auto index =
          window.locate(ledge.edge_O_m[0] + normal.cos * along_m - normal.sin * across_m,
                        ledge.edge_O_m[1] + normal.sin * along_m + normal.cos * across_m);
      if (!index.ok()) continue;
      const mapping::WindowCell& cell = window.at(index.value());
      if (!cell.has_height()) continue;
      ++known;
      if (magnitude(cell.height_m - level_m) > area.max_error_m) return false;
    }
  }
  const double all = static_cast<double>((steps + 1) * (2 * side + 1));
  return static_cast<double>(known) >= area.min_known * all;
}

}  // namespace surefoot::autonomy
