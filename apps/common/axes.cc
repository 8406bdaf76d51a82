#include "apps/common/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace surefoot::apps {
namespace {

constexpr double kTickSize = 11;
constexpr double kLabelSize = 12;
constexpr double kTitleSize = 13.5;

double tick_step(Limits limits, int count) {
  const double raw = limits.span() / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double share = raw / power;
  return (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0) * power;
}

}  // namespace

Limits limits_of(std::span<const double> values, double margin, double smallest_span) {
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double span = std::max(*high - *low, smallest_span);
  const double middle = 0.5 * (*low + *high);
  const double half = (0.5 + margin) * span;
  return {middle - half, middle + half};
}

Limits joined(Limits a, Limits b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }

std::vector<double> ticks(Limits limits, int count) {
  const double step = tick_step(limits, count);
  std::vector<double> values;
  for (double k = std::ceil(limits.low / step - 1e-9); k * step <= limits.high + 1e-9 * step; ++k) {
    values.push_back(k * step);
  }
  return values;
}

std::string tick_text(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.find_first_not_of("-0.") == std::string::npos ? fmt::format("{:.{}f}", 0.0, digits)
                                                            : text;
}

Axes::Axes(Drawing& drawing, const Rectangle& area, Limits x, Limits y, const AxesLabels& labels)
    : drawing_(drawing), area_(area), x_(x), y_(y) {
  draw_grid(labels);
  frame();
  if (!labels.title.empty()) {
    drawing_.text({area_.x, area_.y - 8}, labels.title,
                  {kTitleSize, palette::kInk, Anchor::kStart, true, false});
  }
  if (!labels.x_label.empty()) {
    drawing_.text({area_.x + area_.width / 2, area_.bottom() + 34}, labels.x_label,
                  {kLabelSize, palette::kInk, Anchor::kMiddle, false, false});
  }
  if (!labels.y_label.empty()) {
    drawing_.text({area_.x - 46, area_.y + area_.height / 2}, labels.y_label,
                  {kLabelSize, palette::kInk, Anchor::kMiddle, false, true});
  }
}

void Axes::draw_grid(const AxesLabels& labels) {
  const Stroke grid{palette::kGrid, 1, false};
  if (labels.x_ticks > 0) {
    for (const double x : ticks(x_, labels.x_ticks)) {
      const Point foot = at(x, y_.low);
      drawing_.line({foot.x, area_.y}, {foot.x, area_.bottom()}, grid);
      if (!labels.x_numbers) continue;
      drawing_.text({foot.x, area_.bottom() + 16}, tick_text(x, tick_step(x_, labels.x_ticks)),
                    {kTickSize, palette::kFaint, Anchor::kMiddle, false, false});
    }
  }
  if (labels.y_ticks > 0) {
    for (const double y : ticks(y_, labels.y_ticks)) {
      const Point foot = at(x_.low, y);
      drawing_.line({area_.x, foot.y}, {area_.right(), foot.y}, grid);
      drawing_.text({area_.x - 7, foot.y + 4}, tick_text(y, tick_step(y_, labels.y_ticks)),
                    {kTickSize, palette::kFaint, Anchor::kEnd, false, false});
    }
  }
}

void Axes::frame() { drawing_.frame(area_, {palette::kFaint, 1, false}); }

Point Axes::at(double x, double y) const {
  return {area_.x + (x - x_.low) / x_.span() * area_.width,
          area_.bottom() - (y - y_.low) / y_.span() * area_.height};
}

bool Axes::contains(double x, double y) const {
  return x >= x_.low && x <= x_.high && y >= y_.low && y <= y_.high;
}

void Axes::path(std::span<const Point> points, const Stroke& stroke) {
  std::vector<Point> run;
  for (const Point& point : points) {
    if (contains(point.x, point.y)) {
      run.push_back(at(point.x, point.y));
    } else {
      drawing_.polyline(std::exchange(run, {}), stroke);
    }
  }
  drawing_.polyline(std::move(run), stroke);
}

void Axes::series(std::span<const double> x, std::span<const double> y, const Stroke& stroke) {
  std::vector<Point> line;
  const std::size_t count = std::min(x.size(), y.size());
  std::size_t i = 0;
  while (i < count) {
    const double column = std::floor(at(x[i], 0).x * 2);
    std::size_t low = i;
    std::size_t high = i;
    std::size_t next = i;
    while (next < count && std::floor(at(x[next], 0).x * 2) == column) {
      if (y[next] < y[low]) low = next;
      if (y[next] > y[high]) high = next;
      ++next;
    }
    for (const std::size_t k : {std::min(low, high), std::max(low, high)}) {
      if (x[k] < x_.low || x[k] > x_.high || (low == high && k != low)) continue;
      line.push_back(at(x[k], std::clamp(y[k], y_.low, y_.high)));
      if (low == high) break;
    }
    i = next;
  }
  drawing_.polyline(std::move(line), stroke);
}

void Axes::horizontal(double y, const Stroke& stroke) {
  if (y < y_.low || y > y_.high) return;
  drawing_.line(at(x_.low, y), at(x_.high, y), stroke);
}

void Axes::vertical(double x, const Stroke& stroke) {
  if (x < x_.low || x > x_.high) return;
  drawing_.line(at(x, y_.low), at(x, y_.high), stroke);
}

void Axes::band(double x_begin, double x_end, double y_begin, double y_end, Colour colour) {
  const Point from = at(std::max(x_begin, x_.low), std::min(y_end, y_.high));
  const Point to = at(std::min(x_end, x_.high), std::max(y_begin, y_.low));
  if (to.x <= from.x || to.y <= from.y) return;
  drawing_.fill({from.x, from.y, to.x - from.x, to.y - from.y}, colour);
}

void Axes::legend(const std::vector<LegendItem>& items) {
  double x = area_.right();
  const double y = area_.y - 12;
  for (auto item = items.rbegin(); item != items.rend(); ++item) {
    x -= text_width(item->text, kTickSize);
    drawing_.text({x, y + 4}, item->text, {kTickSize, palette::kInk, Anchor::kStart, false, false});
    x -= 8;
    switch (item->mark) {
      case LegendItem::Mark::kLine: {
        Stroke stroke = item->stroke;
        stroke.width = std::max(1.5, stroke.width);
        drawing_.line({x - 18, y}, {x, y}, stroke);
        break;
      }
      case LegendItem::Mark::kDot: drawing_.dot({x - 6, y}, 4, item->stroke.colour); break;
      case LegendItem::Mark::kRing: drawing_.ring({x - 6, y}, 4, item->stroke); break;
      case LegendItem::Mark::kBox:
        drawing_.fill({x - 13, y - 5, 13, 10}, item->stroke.colour);
        break;
    }
    x -= item->mark == LegendItem::Mark::kLine ? 36 : 28;
  }
}

}  // namespace surefoot::apps
