// A rectangle of a Drawing with data coordinates: ticks, grid, labels, series.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/common/drawing.h"

namespace surefoot::apps {

struct Limits {
  double low = 0;
  double high = 1;

  double span() const { return high - low; }
};

// The smallest interval with all values that is at least `smallest_span` wide, widened by `margin`
// of its span at either end.
Limits limits_of(std::span<const double> values, double margin = 0.05, double smallest_span = 0.02);
Limits joined(Limits a, Limits b);

// Round numbers (1, 2, 5 times a power of ten) inside the limits, about `count` of them.
std::vector<double> ticks(Limits limits, int count);
std::string tick_text(double value, double step);

struct AxesLabels {
  std::string title;
  std::string x_label;
  std::string y_label;
  int x_ticks = 8;
  int y_ticks = 4;
  bool x_numbers = true;  // false: a row above another that shares its x axis
};

struct LegendItem {
  std::string text;
  Stroke stroke;
  enum class Mark : std::uint8_t { kLine, kDot, kRing, kBox } mark = Mark::kLine;
};

class Axes {
 public:
  // Draws background, grid, ticks, frame, labels and title (above the area).
  Axes(Drawing& drawing, const Rectangle& area, Limits x, Limits y, const AxesLabels& labels);

  const Rectangle& area() const { return area_; }
  Point at(double x, double y) const;
  bool contains(double x, double y) const;

  // A line through the points; long series are thinned to the extremes of each half point of width,
  // so nothing that could be seen is lost. Parts outside the limits are cut off.
  void series(std::span<const double> x, std::span<const double> y, const Stroke& stroke);
  // The same without thinning, for curves that are not functions of x.
  void path(std::span<const Point> points, const Stroke& stroke);
  void horizontal(double y, const Stroke& stroke);
  void vertical(double x, const Stroke& stroke);
  void band(double x_begin, double x_end, double y_begin, double y_end, Colour colour);
  // In one line above the area, right-aligned.
  void legend(const std::vector<LegendItem>& items);
  void frame();  // again, over what was drawn

 private:
  void draw_grid(const AxesLabels& labels);

  Drawing& drawing_;
  Rectangle area_;
  Limits x_;
  Limits y_;
};

}  // namespace surefoot::apps
