// A picture as a list of shapes, drawn once and stored twice: as SVG text for report.html and as
// PNG. Units: points of the finished page, origin at the top left, y down.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::apps {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  bool operator==(const Colour&) const = default;
};

// Paper white to ink, and eight line colours that stay apart for colour-blind eyes (Okabe and Ito).
namespace palette {
inline constexpr Colour kPaper{255, 255, 255};
inline constexpr Colour kInk{38, 43, 51};
inline constexpr Colour kFaint{112, 119, 130};
inline constexpr Colour kGrid{228, 231, 235};
inline constexpr Colour kUnknown{214, 217, 222};
inline constexpr Colour kBlue{0, 114, 178};
inline constexpr Colour kOrange{230, 159, 0};
inline constexpr Colour kGreen{0, 158, 115};
inline constexpr Colour kRed{213, 94, 0};
inline constexpr Colour kPurple{170, 68, 153};
inline constexpr Colour kSky{86, 180, 233};
}  // namespace palette

struct Point {
  double x = 0;
  double y = 0;
};

struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

struct Stroke {
  Colour colour = palette::kInk;
  double width = 1;
  bool dashed = false;
};

enum class Anchor : std::uint8_t { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 12;
  Colour colour = palette::kInk;
  Anchor anchor = Anchor::kStart;
  bool bold = false;
  bool vertical = false;  // reads upwards
};

// Rows from the top, each pixel a colour.
struct Raster {
  int columns = 0;
  int rows = 0;
  std::vector<Colour> pixels;
};

struct Shape {
  enum class Kind : std::uint8_t { kPolyline, kFill, kDot, kRing, kText, kRaster };

  Kind kind = Kind::kPolyline;
  std::vector<Point>
      points;         // kPolyline: the line; kDot, kRing: centre; kText: the baseline's anchor
  Rectangle box;      // kFill, kRaster
  double radius = 0;  // kDot, kRing
  Stroke stroke;      // kFill, kDot: its colour fills
  std::string text;
  TextStyle style;
  Raster raster;
};

class Drawing {
 public:
  Drawing(double width, double height) : width_(width), height_(height) {}

  double width() const { return width_; }
  double height() const { return height_; }
  const std::vector<Shape>& shapes() const { return shapes_; }

  void polyline(std::vector<Point> points, const Stroke& stroke);
  void line(Point from, Point to, const Stroke& stroke);
  void fill(const Rectangle& box, Colour colour);
  void frame(const Rectangle& box, const Stroke& stroke);
  void dot(Point centre, double radius, Colour colour);
  void ring(Point centre, double radius, const Stroke& stroke);
  void text(Point at, std::string text, const TextStyle& style);
  void raster(const Rectangle& box, Raster raster);

 private:
  double width_;
  double height_;
  std::vector<Shape> shapes_;
};

// Width of a text, good enough to place a legend.
double text_width(std::string_view text, double size);

std::string to_svg(const Drawing& drawing);
// The encoded PNG file, `scale` pixels per point.
std::vector<std::uint8_t> to_png(const Drawing& drawing, double scale = 1.5);
std::vector<std::uint8_t> to_png(const Raster& raster);

std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace surefoot::apps
