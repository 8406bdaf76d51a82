// SVG of a Drawing.
#include <fmt/format.h>

#include <iterator>

#include "apps/common/drawing.h"
#include "apps/common/markup.h"

namespace surefoot::apps {
namespace {

std::string hex(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

std::string stroke_attributes(const Stroke& stroke) {
  return fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"{}", hex(stroke.colour), stroke.width,
                     stroke.dashed ? " stroke-dasharray=\"5 4\"" : "");
}

std::string polyline(const Shape& shape) {
  std::string points;
  for (const Point& point : shape.points) {
    fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ", point.x, point.y);
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" {} stroke-linejoin=\"round\"/>", points,
                     stroke_attributes(shape.stroke));
}

std::string text(const Shape& shape) {
  const TextStyle& style = shape.style;
  const Point at = shape.points[0];
  const char* anchor = style.anchor == Anchor::kStart    ? "start"
                       : style.anchor == Anchor::kMiddle ? "middle"
                                                         : "end";
  const std::string turn =
      style.vertical ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", at.x, at.y) : "";
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:.1f}\" fill=\"{}\" text-anchor=\"{}\"{}{}>{}"
      "</text>",
      at.x, at.y, style.size, hex(style.colour), anchor, style.bold ? " font-weight=\"600\"" : "",
      turn, escaped(shape.text));
}

std::string box_attributes(const Rectangle& box) {
  return fmt::format("x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"", box.x, box.y,
                     box.width, box.height);
}

std::string element(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::kPolyline: return polyline(shape);
    case Shape::Kind::kFill:
      return fmt::format("<rect {} fill=\"{}\"/>", box_attributes(shape.box),
                         hex(shape.stroke.colour));
    case Shape::Kind::kDot:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>",
                         shape.points[0].x, shape.points[0].y, shape.radius,
                         hex(shape.stroke.colour));
    case Shape::Kind::kRing:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"none\" {}/>",
                         shape.points[0].x, shape.points[0].y, shape.radius,
                         stroke_attributes(shape.stroke));
    case Shape::Kind::kText: return text(shape);
    case Shape::Kind::kRaster:
      return fmt::format(
          "<image {} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" "
          "href=\"data:image/png;base64,{}\"/>",
          box_attributes(shape.box), base64(to_png(shape.raster)));
  }
  return {};
}

}  // namespace

std::string to_svg(const Drawing& drawing) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" "
      "font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\">\n",
      drawing.width(), drawing.height());
  for (const Shape& shape : drawing.shapes()) svg += element(shape) + "\n";
  return svg + "</svg>\n";
}

}  // namespace surefoot::apps
