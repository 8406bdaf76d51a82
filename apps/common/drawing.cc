#include "apps/common/drawing.h"

#include <utility>

namespace surefoot::apps {

void Drawing::polyline(std::vector<Point> points, const Stroke& stroke) {
  if (points.size() < 2) return;
  Shape shape;
  shape.kind = Shape::Kind::kPolyline;
  shape.points = std::move(points);
  shape.stroke = stroke;
  shapes_.push_back(std::move(shape));
}

void Drawing::line(Point from, Point to, const Stroke& stroke) { polyline({from, to}, stroke); }

void Drawing::fill(const Rectangle& box, Colour colour) {
  Shape shape;
  shape.kind = Shape::Kind::kFill;
  shape.box = box;
  shape.stroke.colour = colour;
  shapes_.push_back(std::move(shape));
}

void Drawing::frame(const Rectangle& box, const Stroke& stroke) {
  polyline({{box.x, box.y},
            {box.right(), box.y},
            {box.right(), box.bottom()},
            {box.x, box.bottom()},
            {box.x, box.y}},
           stroke);
}

void Drawing::dot(Point centre, double radius, Colour colour) {
  Shape shape;
  shape.kind = Shape::Kind::kDot;
  shape.points = {centre};
  shape.radius = radius;
  shape.stroke.colour = colour;
  shapes_.push_back(std::move(shape));
}

void Drawing::ring(Point centre, double radius, const Stroke& stroke) {
  Shape shape;
  shape.kind = Shape::Kind::kRing;
  shape.points = {centre};
  shape.radius = radius;
  shape.stroke = stroke;
  shapes_.push_back(std::move(shape));
}

void Drawing::text(Point at, std::string text, const TextStyle& style) {
  Shape shape;
  shape.kind = Shape::Kind::kText;
  shape.points = {at};
  shape.text = std::move(text);
  shape.style = style;
  shapes_.push_back(std::move(shape));
}

void Drawing::raster(const Rectangle& box, Raster raster) {
  Shape shape;
  shape.kind = Shape::Kind::kRaster;
  shape.box = box;
  shape.raster = std::move(raster);
  shapes_.push_back(std::move(shape));
}

double text_width(std::string_view text, double size) {
  return 0.61 * size * static_cast<double>(text.size());
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t word = static_cast<std::uint32_t>(bytes[i]) << 16u |
                               (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8u : 0u) |
                               (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0u);
    text.push_back(kDigits[word >> 18u & 63u]);
    text.push_back(kDigits[word >> 12u & 63u]);
    text.push_back(left > 1 ? kDigits[word >> 6u & 63u] : '=');
    text.push_back(left > 2 ? kDigits[word & 63u] : '=');
  }
  return text;
}

}  // namespace surefoot::apps
