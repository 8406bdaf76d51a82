// Where the robot went between what stood there: the whole way from above, and moments of it with
// objects, cost map and plan (paper 003, figure 6).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/common/axes.h"
#include "apps/common/figures.h"

namespace surefoot::apps {
namespace {

constexpr double kWidth = 1000;
constexpr double kLeft = 66;
constexpr double kRight = 20;
constexpr double kStripTop = 42;
constexpr double kLeastHalfWidth_m = 4;  // shown beside the line from start to goal
constexpr double kMargin_m = 2;
constexpr double kTallest = 560;  // of the strip
constexpr int kMoments = 3;
constexpr double kMoment_m = 8;  // shown around the robot, to either side
constexpr double kGap = 26;      // between the moments

constexpr Colour kTrunk{120, 96, 72};
constexpr Colour kWood{176, 142, 104};
constexpr Colour kStone{150, 150, 156};

Colour solid_colour(sim::SolidKind kind) {
  switch (kind) {
    case sim::SolidKind::kTrunk: return kTrunk;
    case sim::SolidKind::kLog: return kWood;
    case sim::SolidKind::kBoulder:
    case sim::SolidKind::kWall: return kStone;
    case sim::SolidKind::kWalker: return palette::kRed;
  }
  return kStone;
}

Point to_world(const PlanPoint& p, const Alignment& O_in_W) {
  const auto place = O_in_W.to_world({static_cast<double>(p[0]), static_cast<double>(p[1]), 0.0});
  return {place[0], place[1]};
}

std::vector<Point> body_trace(const RunLog& log, const Alignment& O_in_W) {
  std::vector<Point> points;
  for (std::size_t i = log.walk_begin(); i < log.samples().size(); i += 5) {
    const RunSample& sample = log.samples()[i];
    const auto p = log.has_truth() ? sample.truth.p_WB_m : O_in_W.to_world(sample.telemetry.p_OB_m);
    points.push_back({p[0], p[1]});
  }
  return points;
}

// The outline of a solid in plan: round, or a box that lies along its yaw.
std::vector<Point> outline(const sim::SolidTruth& solid) {
  std::vector<Point> points;
  const bool box = solid.kind == sim::SolidKind::kWall || solid.kind == sim::SolidKind::kLog;
  const int corners = box ? 4 : 16;
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / corners;
    const double stretch = box ? std::numbers::sqrt2 : 1.0;
    const double u = stretch * std::cos(angle) * solid.half_length_m;
    const double v = stretch * std::sin(angle) * solid.half_width_m;
    points.push_back({solid.x_m + u * std::cos(solid.yaw_rad) - v * std::sin(solid.yaw_rad),
                      solid.y_m + u * std::sin(solid.yaw_rad) + v * std::cos(solid.yaw_rad)});
  }
  return points;
}

void draw_solids(const std::vector<sim::SolidTruth>& solids, Drawing& drawing, Axes& axes,
                 double points_per_m) {
  for (const sim::SolidTruth& solid : solids) {
    const bool round = solid.kind == sim::SolidKind::kTrunk ||
                       solid.kind == sim::SolidKind::kBoulder ||
                       solid.kind == sim::SolidKind::kWalker;
    if (round && axes.contains(solid.x_m, solid.y_m)) {
      drawing.dot(axes.at(solid.x_m, solid.y_m), std::max(1.2, solid.half_width_m * points_per_m),
                  solid_colour(solid.kind));
    } else if (!round) {
      axes.path(outline(solid), {solid_colour(solid.kind), 1.6, false});
    }
  }
}

// The strip: limits that hold the way, start and goal.
struct View {
  Limits x;
  Limits y;
};

View view_of(const NavigationFigure& figure, std::span<const Point> way) {
  View view{{-kMargin_m, std::max(figure.goal_x_m, 1.0) + kMargin_m},
            {-kLeastHalfWidth_m, kLeastHalfWidth_m}};
  for (const Point& p : way) {
    view.x = joined(view.x, {p.x - kMargin_m, p.x + kMargin_m});
    view.y = joined(view.y, {p.y - kMargin_m, p.y + kMargin_m});
  }
  return view;
}

Raster cost_raster(const PlanSample& sample, double half_m) {
  const int half = static_cast<int>(half_m / sample.cell_m);
  const int cx = static_cast<int>(
      (static_cast<double>(sample.robot_O_m[0] - sample.corner_O_m[0])) / sample.cell_m);
  const int cy = static_cast<int>(
      (static_cast<double>(sample.robot_O_m[1] - sample.corner_O_m[1])) / sample.cell_m);
  Raster raster{2 * half, 2 * half, {}};
  raster.pixels.reserve(static_cast<std::size_t>(raster.columns) *
                        static_cast<std::size_t>(raster.rows));
  for (int row = cy + half - 1; row >= cy - half; --row) {
    for (int column = cx - half; column < cx + half; ++column) {
      const bool inside = row >= 0 && column >= 0 && row < sample.side && column < sample.side;
      if (!inside) {
        raster.pixels.push_back(palette::kUnknown);
        continue;
      }
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(sample.side) +
                     static_cast<std::size_t>(column);
      const std::uint8_t cost = sample.cost[i];
      const auto grey = static_cast<std::uint8_t>(255 - cost * 3 / 4);
      raster.pixels.push_back(cost == 255 ? Colour{96, 60, 60}
                                          : Colour{255, grey, static_cast<std::uint8_t>(grey)});
    }
  }
  return raster;
}

// Objects, cost map and plan around the robot, in O.
void draw_moment(const PlanSample& sample, TimeNs start, const Rectangle& area, bool first,
                 Drawing& drawing) {
  const double x = static_cast<double>(sample.robot_O_m[0]);
  const double y = static_cast<double>(sample.robot_O_m[1]);
  Axes axes(drawing, area, {x - kMoment_m, x + kMoment_m}, {y - kMoment_m, y + kMoment_m},
            {fmt::format("{:.0f} s", (sample.stamp - start).seconds()), "x [m]",
             first ? "y [m]" : "", 4, 4, true});
  if (sample.cell_m > 0) drawing.raster(area, cost_raster(sample, kMoment_m));
  for (const SeenPoint& point : sample.objects) {
    const double px = static_cast<double>(point.p_O_m[0]);
    const double py = static_cast<double>(point.p_O_m[1]);
    if (!axes.contains(px, py)) continue;
    drawing.dot(axes.at(px, py), 1.8, point.moving ? palette::kRed : palette::kInk);
  }
  std::vector<Point> path;
  for (const PlanPoint& p : sample.path_O_m) {
    path.push_back({static_cast<double>(p[0]), static_cast<double>(p[1])});
  }
  axes.path(path, {palette::kBlue, 2.4, false});
  drawing.ring(axes.at(x, y), 5, {palette::kGreen, 2.4, false});
  axes.frame();
}

void draw_strip(const RunLog& log, const NavigationFigure& figure, std::span<const Point> way,
                const View& view, double height, Drawing& drawing) {
  const Rectangle area{kLeft, kStripTop, kWidth - kLeft - kRight, height};
  Axes axes(drawing, area, view.x, view.y, {"from above", "x [m]", "y [m]", 10, 5, true});
  draw_solids(figure.solids, drawing, axes, area.width / view.x.span());
  if (!figure.plans.empty()) {
    for (const SeenPoint& point : figure.plans.back().objects) {
      const Point p = to_world(point.p_O_m, figure.O_in_W);
      if (axes.contains(p.x, p.y)) drawing.dot(axes.at(p.x, p.y), 1.0, palette::kInk);
    }
  }
  for (const PlanSample& plan : figure.plans) {
    std::vector<Point> path;
    for (const PlanPoint& p : plan.path_O_m) path.push_back(to_world(p, figure.O_in_W));
    axes.path(path, {palette::kSky, 0.7, false});
  }
  if (!log.samples().empty()) {
    const sim::Truth& truth = log.samples().back().truth;
    for (std::size_t i = 0; i < truth.walker_count; ++i) {
      std::vector<Point> walker;
      for (std::size_t k = log.walk_begin(); k < log.samples().size(); k += 25) {
        const auto& p = log.samples()[k].truth.walkers_W_m[i];
        walker.push_back({p[0], p[1]});
      }
      axes.path(walker, {palette::kRed, 1, true});
    }
  }
  axes.path(way, {palette::kGreen, 2.4, false});
  if (axes.contains(figure.goal_x_m, 0)) {
    drawing.ring(axes.at(figure.goal_x_m, 0), 6, {palette::kRed, 2.4, false});
  }
  using Mark = LegendItem::Mark;
  axes.legend({{"trunk", {kTrunk, 1, false}, Mark::kDot},
               {"stone, wall", {kStone, 1, false}, Mark::kDot},
               {"seen and remembered at the end", {palette::kInk, 1, false}, Mark::kDot},
               {"plans", {palette::kSky, 1, false}},
               {"way", {palette::kGreen, 2.4, false}},
               {"goal", {palette::kRed, 2.4, false}, Mark::kRing}});
  axes.frame();
}

}  // namespace

Drawing navigation_figure(const RunLog& log, const NavigationFigure& figure) {
  const std::vector<Point> way = body_trace(log, figure.O_in_W);
  const View view = view_of(figure, way);
  const double width = kWidth - kLeft - kRight;
  const double height = std::min(kTallest, width * view.y.span() / view.x.span());
  const double side = (width - (kMoments - 1) * kGap) / kMoments;
  const double moments_top = kStripTop + height + 74;
  Drawing drawing(kWidth, moments_top + side + 44);
  draw_strip(log, figure, way, view, height, drawing);
  if (figure.plans.empty() || log.samples().empty()) return drawing;
  const TimeNs start = log.samples().front().stamp;
  for (int i = 0; i < kMoments; ++i) {
    const std::size_t at =
        (2 * static_cast<std::size_t>(i) + 1) * figure.plans.size() / (2 * kMoments);
    draw_moment(figure.plans[at], start, {kLeft + i * (side + kGap), moments_top, side, side},
                i == 0, drawing);
  }
  return drawing;
}

}  // namespace surefoot::apps
