// The ground: as it is, as it was perceived, and the difference; with everything that walked on it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "apps/common/axes.h"
#include "apps/common/figures.h"
#include "apps/common/leg_curves.h"

namespace surefoot::apps {
namespace {

constexpr double kWidth = 1000;
constexpr double kLeft = 66;
constexpr double kBar = 120;  // right of the maps: colour bar and its numbers

using Scale = Colour (*)(double share);

template <std::size_t N>
Colour interpolate(const std::array<Colour, N>& stops, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(N - 1);
  const auto i = std::min(static_cast<std::size_t>(at), N - 2);
  const double part = at - static_cast<double>(i);
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
  };
  return {mix(stops[i].red, stops[i + 1].red), mix(stops[i].green, stops[i + 1].green),
          mix(stops[i].blue, stops[i + 1].blue)};
}

// Dark to light with even steps of lightness, readable in grey print.
Colour height_colour(double share) {
  static constexpr std::array<Colour, 6> kStops{{{36, 33, 84},
                                                 {46, 84, 128},
                                                 {52, 129, 133},
                                                 {93, 172, 118},
                                                 {171, 206, 103},
                                                 {251, 236, 138}}};
  return interpolate(kStops, share);
}

Colour difference_colour(double share) {
  static constexpr std::array<Colour, 5> kStops{
      {{33, 87, 153}, {146, 188, 220}, {247, 247, 247}, {238, 166, 130}, {168, 44, 38}}};
  return interpolate(kStops, share);
}

Raster to_raster(const HeightGrid& grid, Limits scale, Scale colour) {
  Raster raster{grid.columns, grid.rows, {}};
  raster.pixels.reserve(grid.height_m.size());
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = grid.index(column, row);
      raster.pixels.push_back(
          grid.known[i] == 0
              ? palette::kUnknown
              : colour((static_cast<double>(grid.height_m[i]) - scale.low) / scale.span()));
    }
  }
  return raster;
}

void colour_bar(Drawing& drawing, const Rectangle& map, Limits scale, Scale colour,
                const std::string& label) {
  const Rectangle bar{map.right() + 18, map.y, 14, map.height};
  Raster raster{1, 128, {}};
  for (int i = 0; i < raster.rows; ++i)
    raster.pixels.push_back(colour(1 - (i + 0.5) / raster.rows));
  drawing.raster(bar, std::move(raster));
  drawing.frame(bar, {palette::kFaint, 1, false});
  const std::vector<double> values = ticks(scale, 4);
  const double step = values.size() > 1 ? values[1] - values[0] : 1;
  for (const double value : values) {
    const double y = bar.bottom() - (value - scale.low) / scale.span() * bar.height;
    drawing.line({bar.right(), y}, {bar.right() + 4, y}, {palette::kFaint, 1, false});
    drawing.text({bar.right() + 8, y + 4}, tick_text(value, step),
                 {11, palette::kFaint, Anchor::kStart, false, false});
  }
  drawing.text({bar.right() + 58, bar.y + bar.height / 2}, label,
               {12, palette::kInk, Anchor::kMiddle, false, true});
}

Colour class_colour(mapping::Traversability ground) {
  switch (ground) {
    case mapping::Traversability::kSteppable: return {152, 205, 158};
    case mapping::Traversability::kUnsteppable: return {244, 196, 92};
    case mapping::Traversability::kJumpOnly: return {120, 120, 190};
    case mapping::Traversability::kImpassable: return {84, 28, 44};
    case mapping::Traversability::kUnknown: break;
  }
  return palette::kUnknown;
}

Raster to_raster(const ClassGrid& grid) {
  Raster raster{grid.columns, grid.rows, {}};
  raster.pixels.reserve(grid.classes.size());
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      raster.pixels.push_back(class_colour(grid.at(column, row)));
    }
  }
  return raster;
}

// Where the colour bar stands beside the maps of heights.
void class_key(Drawing& drawing, const Rectangle& map) {
  using mapping::Traversability;
  static constexpr std::array<std::pair<Traversability, const char*>, 5> kRows{
      {{Traversability::kSteppable, "steppable"},
       {Traversability::kUnsteppable, "unsteppable"},
       {Traversability::kJumpOnly, "jump only"},
       {Traversability::kImpassable, "impassable"},
       {Traversability::kUnknown, "unknown"}}};
  double y = map.y + 10;
  for (const auto& [ground, name] : kRows) {
    const Rectangle box{map.right() + 18, y, 14, 14};
    drawing.fill(box, class_colour(ground));
    drawing.frame(box, {palette::kFaint, 1, false});
    drawing.text({box.right() + 8, y + 11}, name,
                 {11, palette::kInk, Anchor::kStart, false, false});
    y += 24;
  }
}

Limits height_scale(const TerrainFigure& figure) {
  std::vector<double> heights;
  for (const HeightGrid* grid : {&figure.truth, &figure.perceived}) {
    for (std::size_t i = 0; i < grid->height_m.size(); ++i) {
      if (grid->known[i] != 0) heights.push_back(static_cast<double>(grid->height_m[i]));
    }
  }
  if (heights.empty()) return {-0.05, 0.05};
  // Half a percent at either end may be off the scale: one wild cell must not grey out the rest.
  std::sort(heights.begin(), heights.end());
  const auto cut = heights.size() / 200;
  const Limits scale{heights[cut], heights[heights.size() - 1 - cut]};
  const double middle = 0.5 * (scale.low + scale.high);
  const double half = std::max(0.55 * scale.span(), 0.02);
  return {middle - half, middle + half};
}

Limits difference_scale(const HeightGrid& grid) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < grid.height_m.size(); ++i) {
    if (grid.known[i] != 0) sizes.push_back(std::fabs(static_cast<double>(grid.height_m[i])));
  }
  double largest = 0.01;
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() * 98 / 100);
    std::nth_element(sizes.begin(), std::min(at, sizes.end() - 1), sizes.end());
    largest = std::max(largest, *std::min(at, sizes.end() - 1));
  }
  return {-largest, largest};
}

class TerrainPanels {
 public:
  TerrainPanels(Drawing& drawing, const TerrainFigure& figure, const HeightGrid& raster)
      : drawing_(drawing), figure_(figure), grid_(raster) {
    width_ = kWidth - kLeft - kBar;
    height_ = width_ * (grid_.rows * grid_.cell_m) / (grid_.columns * grid_.cell_m);
  }

  double panel_height() const { return height_ + 74; }

  Axes heights(int row, const HeightGrid& grid, Limits scale, Scale colour,
               const std::string& title, const std::string& bar_label, bool last) {
    // Ink is lost on the dark low ground, red on the red side of the difference.
    const Colour goal = colour == height_colour ? palette::kRed : palette::kInk;
    Axes axes = panel(row, to_raster(grid, scale, colour), title, goal, last);
    colour_bar(drawing_, axes.area(), scale, colour, bar_label);
    return axes;
  }

  Axes classes(int row, const ClassGrid& grid, const std::string& title, bool last) {
    Axes axes = panel(row, to_raster(grid), title, palette::kInk, last);
    class_key(drawing_, axes.area());
    return axes;
  }

 private:
  Axes panel(int row, Raster raster, const std::string& title, Colour goal, bool last) {
    const Rectangle area{kLeft, 42 + row * panel_height(), width_, height_};
    Axes axes(drawing_, area, {grid_.x_m, grid_.right_m()}, {grid_.y_m, grid_.top_m()},
              {title, last ? "x [m]" : "", "y [m]", 10, 4, true});
    drawing_.raster(area, std::move(raster));
    if (figure_.lane_half_width_m > 0) {
      const Stroke lane{palette::kPaper, 1.2, true};
      axes.horizontal(figure_.lane_half_width_m, lane);
      axes.horizontal(-figure_.lane_half_width_m, lane);
    }
    if (figure_.goal_x_m > 0) axes.vertical(figure_.goal_x_m, {goal, 1.6, true});
    axes.frame();
    return axes;
  }

  Drawing& drawing_;
  const TerrainFigure& figure_;
  const HeightGrid& grid_;
  double width_ = 0;
  double height_ = 0;
};

std::vector<Point> trace(const RunLog& log, const auto& place) {
  std::vector<Point> points;
  for (std::size_t i = log.walk_begin(); i < log.samples().size(); ++i) {
    const std::array<double, 3> p = place(log.samples()[i]);
    points.push_back({p[0], p[1]});
  }
  return points;
}

void draw_true_traces(const RunLog& log, Axes& axes) {
  std::vector<LegendItem> legend;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Stroke thin{kLegColours[leg], 1, false};
    axes.path(trace(log, [&](const RunSample& s) { return s.truth.feet[leg].p_WF_m; }), thin);
    legend.push_back({kLegNames[leg], thin});
  }
  const std::vector<Point> body = trace(log, [](const RunSample& s) { return s.truth.p_WB_m; });
  axes.path(body, {palette::kInk, 3.4, false});
  axes.path(body, {palette::kPaper, 1.8, false});
  legend.push_back({"body (white)", {palette::kInk, 3.4, false}});
  axes.legend(legend);
}

std::vector<Point> outline(const std::array<double, 3>& place, const sim::ObstacleConfig& size) {
  constexpr std::array<std::array<double, 2>, 5> kCorners{
      {{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}}};
  std::vector<Point> points;
  for (const auto& corner : kCorners) {
    const double u = corner[0] * size.length_m;
    const double v = corner[1] * size.width_m;
    points.push_back({place[0] + u * std::cos(place[2]) - v * std::sin(place[2]),
                      place[1] + u * std::sin(place[2]) + v * std::cos(place[2])});
  }
  return points;
}

// Everywhere it stood, numbered.
void draw_obstacle(Drawing& drawing, const RunLog& log, const sim::ObstacleConfig& size,
                   Axes& axes) {
  if (size.places.empty()) return;
  std::array<double, 3> last{};
  int number = 0;
  for (const RunSample& sample : log.samples()) {
    const std::array<double, 3>& place = sample.truth.obstacle;
    if (number > 0 && place == last) continue;
    last = place;
    ++number;
    axes.path(outline(place, size), {palette::kRed, 2, false});
    if (!axes.contains(place[0], place[1])) continue;
    drawing.text(axes.at(place[0], place[1]), fmt::format("{}", number),
                 {14, palette::kRed, Anchor::kMiddle, true, false});
  }
}

// Discs that repelled the robot at the end.
void draw_fields(const RunLog& log, const Alignment& O_in_W, Drawing& drawing, const Axes& axes) {
  if (log.samples().empty()) return;
  for (const auto& centre : log.samples().back().telemetry.obstacles.fields_O_m) {
    const auto place = O_in_W.to_world({centre[0], centre[1], 0});
    if (!axes.contains(place[0], place[1])) continue;
    drawing.ring(axes.at(place[0], place[1]), 5, {palette::kPurple, 2, false});
  }
}

struct FootholdCounts {
  int nominal = 0;
  int moved = 0;
  int unseen = 0;
  int none = 0;
};

FootholdCounts draw_footholds(Drawing& drawing, const std::vector<Touchdown>& touchdowns,
                              const Alignment& O_in_W, const Axes& axes) {
  FootholdCounts counts;
  for (const Touchdown& touchdown : touchdowns) {
    const auto nominal = O_in_W.to_world(touchdown.nominal_O_m);
    const auto chosen = O_in_W.to_world(touchdown.chosen_O_m);
    const bool visible =
        axes.contains(chosen[0], chosen[1]) && axes.contains(nominal[0], nominal[1]);
    const Point to = axes.at(chosen[0], chosen[1]);
    switch (touchdown.reason) {
      case control::FootholdReason::kMoved:
      case control::FootholdReason::kPlanned:
        ++counts.moved;
        if (!visible) break;
        drawing.line(axes.at(nominal[0], nominal[1]), to, {palette::kInk, 1.2, false});
        drawing.ring(axes.at(nominal[0], nominal[1]), 2.6, {palette::kInk, 1, false});
        drawing.dot(to, 3.2, palette::kRed);
        break;
      case control::FootholdReason::kForced:
      case control::FootholdReason::kNone:
        ++counts.none;
        if (visible) drawing.ring(to, 4, {palette::kPurple, 2, false});
        break;
      case control::FootholdReason::kUnseen:
      case control::FootholdReason::kMapOff:
        ++counts.unseen;
        if (visible) drawing.ring(to, 2.6, {palette::kBlue, 1.4, false});
        break;
      case control::FootholdReason::kNominal:
        ++counts.nominal;
        if (visible) drawing.dot(to, 2.2, palette::kInk);
        break;
    }
  }
  return counts;
}

std::vector<LegendItem> foothold_legend(const FootholdCounts& counts) {
  using Mark = LegendItem::Mark;
  return {
      {fmt::format("nominal place ({})", counts.nominal), {palette::kInk, 1, false}, Mark::kDot},
      {fmt::format("moved to bear a foot ({})", counts.moved),
       {palette::kRed, 1, false},
       Mark::kDot},
      {fmt::format("unseen ({})", counts.unseen), {palette::kBlue, 1.4, false}, Mark::kRing},
      {fmt::format("none in reach ({})", counts.none), {palette::kPurple, 2, false}, Mark::kRing}};
}

}  // namespace

Drawing terrain_figure(const RunLog& log, const TerrainFigure& figure) {
  const bool with_truth = figure.truth.columns > 0;
  const HeightGrid& raster = with_truth ? figure.truth : figure.perceived;
  Drawing sizing(kWidth, 1);
  const double height = TerrainPanels(sizing, figure, raster).panel_height();
  Drawing drawing(kWidth, (with_truth ? 4 : 2) * height + 32);
  TerrainPanels panels(drawing, figure, raster);
  const Limits heights = height_scale(figure);

  int row = 0;
  if (with_truth) {
    Axes axes =
        panels.heights(row++, figure.truth, heights, height_colour,
                       "True ground, with the true traces of body and feet", "height [m]", false);
    draw_true_traces(log, axes);
    draw_obstacle(drawing, log, figure.obstacle, axes);
  }
  const bool fields =
      !log.samples().empty() && !log.samples().back().telemetry.obstacles.fields_O_m.empty();
  Axes map = panels.heights(
      row++, figure.perceived, heights, height_colour,
      fields ? "Perceived map, with the fields of obstacles (rings) at the end" : "Perceived map",
      "height [m]", false);
  draw_fields(log, figure.O_in_W, drawing, map);
  Axes axes = panels.classes(row++, figure.classes, "Classes and footholds", !with_truth);
  axes.legend(foothold_legend(draw_footholds(drawing, log.touchdowns(), figure.O_in_W, axes)));
  if (with_truth) {
    const HeightGrid off = difference(figure.perceived, figure.truth);
    Axes last = panels.heights(row++, off, difference_scale(off), difference_colour,
                               "Perceived minus true", "difference [m]", true);
    last.legend({{"unseen", {palette::kUnknown, 1, false}, LegendItem::Mark::kBox},
                 {"goal", {palette::kInk, 1.6, true}}});
  }
  return drawing;
}

Drawing ground_figure(const HeightGrid& heights, const ClassGrid& classes) {
  TerrainFigure figure;
  figure.perceived = heights;
  Drawing sizing(kWidth, 1);
  const double height = TerrainPanels(sizing, figure, heights).panel_height();
  Drawing drawing(kWidth, 2 * height + 32);
  TerrainPanels panels(drawing, figure, heights);
  panels.heights(0, heights, height_scale(figure), height_colour, "Heights", "height [m]", false);
  panels.classes(1, classes, "Classes", true);
  return drawing;
}

}  // namespace surefoot::apps
