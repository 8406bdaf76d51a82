// PNG of a Drawing, by OpenCV. Drawn at twice the size and averaged down, so that thin lines and
// the stroke font look smooth.
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/common/drawing.h"

namespace surefoot::apps {
namespace {

constexpr double kOversampling = 2;
// Cap height of cv::FONT_HERSHEY_SIMPLEX is 21 at scale 1; a cap is 0.72 of a font's size.
constexpr double kFontScalePerSize = 0.72 / 21.0;
constexpr double kDash = 5;
constexpr double kGap = 4;

cv::Scalar bgr(Colour colour) { return cv::Scalar(colour.blue, colour.green, colour.red); }

class Painter {
 public:
  Painter(cv::Mat& image, double scale) : image_(image), scale_(scale) {}

  void paint(const Shape& shape) {
    switch (shape.kind) {
      case Shape::Kind::kPolyline: polyline(shape); break;
      case Shape::Kind::kFill:
        cv::rectangle(image_, pixels(shape.box), bgr(shape.stroke.colour), cv::FILLED);
        break;
      case Shape::Kind::kDot: circle(shape, cv::FILLED); break;
      case Shape::Kind::kRing: circle(shape, thickness(shape.stroke.width)); break;
      case Shape::Kind::kText: text(shape); break;
      case Shape::Kind::kRaster: raster(shape); break;
    }
  }

 private:
  static constexpr int kShift = 4;  // sub-pixel bits of OpenCV's drawing functions

  int fixed(double value) const { return static_cast<int>(std::lround(value * scale_ * 16)); }
  cv::Point fixed(Point point) const { return {fixed(point.x), fixed(point.y)}; }
  int thickness(double width) const {
    return std::max(1, static_cast<int>(std::lround(width * scale_)));
  }
  cv::Rect pixels(const Rectangle& box) const {
    const auto x = static_cast<int>(std::lround(box.x * scale_));
    const auto y = static_cast<int>(std::lround(box.y * scale_));
    const auto right = static_cast<int>(std::lround(box.right() * scale_));
    const auto bottom = static_cast<int>(std::lround(box.bottom() * scale_));
    return {x, y, std::max(1, right - x), std::max(1, bottom - y)};
  }

  void segment(Point from, Point to, const Stroke& stroke) {
    cv::line(image_, fixed(from), fixed(to), bgr(stroke.colour), thickness(stroke.width),
             cv::LINE_AA, kShift);
  }

  // Dashes run on over the corners of the line.
  void polyline(const Shape& shape) {
    double phase = 0;
    for (std::size_t i = 1; i < shape.points.size(); ++i) {
      const Point a = shape.points[i - 1];
      const Point b = shape.points[i];
      if (!shape.stroke.dashed) {
        segment(a, b, shape.stroke);
        continue;
      }
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      double at = 0;
      while (at < length) {
        const bool ink = phase < kDash;
        const double step = std::min(length - at, (ink ? kDash : kDash + kGap) - phase);
        const auto point = [&](double s) {
          return Point{a.x + (b.x - a.x) * s / length, a.y + (b.y - a.y) * s / length};
        };
        if (ink) segment(point(at), point(at + step), shape.stroke);
        at += step;
        phase += step;
        if (phase >= kDash + kGap) phase = 0;
      }
    }
  }

  void circle(const Shape& shape, int line) {
    cv::circle(image_, fixed(shape.points[0]), fixed(shape.radius), bgr(shape.stroke.colour), line,
               cv::LINE_AA, kShift);
  }

  // Through a mask, because OpenCV cannot turn text.
  void text(const Shape& shape) {
    const double font_scale = shape.style.size * scale_ * kFontScalePerSize;
    const int line = std::max(1, static_cast<int>(std::lround(shape.style.size * scale_ *
                                                              (shape.style.bold ? 0.1 : 0.066))));
    int baseline = 0;
    const cv::Size size =
        cv::getTextSize(shape.text, cv::FONT_HERSHEY_SIMPLEX, font_scale, line, &baseline);
    const int pad = line + 2;
    cv::Mat mask(size.height + baseline + 2 * pad, size.width + 2 * pad, CV_8UC1, cv::Scalar(0));
    cv::putText(mask, shape.text, {pad, pad + size.height}, cv::FONT_HERSHEY_SIMPLEX, font_scale,
                cv::Scalar(255), line, cv::LINE_AA);
    const double share = shape.style.anchor == Anchor::kStart    ? 0.0
                         : shape.style.anchor == Anchor::kMiddle ? 0.5
                                                                 : 1.0;
    const auto before = static_cast<int>(std::lround(share * size.width)) + pad;
    const auto above = size.height + pad;
    const auto x = static_cast<int>(std::lround(shape.points[0].x * scale_));
    const auto y = static_cast<int>(std::lround(shape.points[0].y * scale_));
    if (shape.style.vertical) {
      cv::Mat turned;
      cv::rotate(mask, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
      blend(turned, x - above, y - (mask.cols - before), shape.style.colour);
    } else {
      blend(mask, x - before, y - above, shape.style.colour);
    }
  }

  void blend(const cv::Mat& mask, int left, int top, Colour colour) {
    const int channels[3] = {colour.blue, colour.green, colour.red};
    for (int row = 0; row < mask.rows; ++row) {
      for (int column = 0; column < mask.cols; ++column) {
        const int x = left + column;
        const int y = top + row;
        const int share = mask.at<std::uint8_t>(row, column);
        if (share == 0 || x < 0 || y < 0 || x >= image_.cols || y >= image_.rows) continue;
        auto& pixel = image_.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c) {
          pixel[c] =
              static_cast<std::uint8_t>((pixel[c] * (255 - share) + channels[c] * share) / 255);
        }
      }
    }
  }

  void raster(const Shape& shape);

  cv::Mat& image_;
  double scale_;
};

cv::Mat to_mat(const Raster& raster) {
  cv::Mat image(raster.rows, raster.columns, CV_8UC3);
  for (int row = 0; row < raster.rows; ++row) {
    for (int column = 0; column < raster.columns; ++column) {
      const Colour colour =
          raster.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(raster.columns) +
                        static_cast<std::size_t>(column)];
      image.at<cv::Vec3b>(row, column) = cv::Vec3b(colour.blue, colour.green, colour.red);
    }
  }
  return image;
}

void Painter::raster(const Shape& shape) {
  const cv::Rect box = pixels(shape.box) & cv::Rect(0, 0, image_.cols, image_.rows);
  if (box.area() == 0 || shape.raster.pixels.empty()) return;
  cv::resize(to_mat(shape.raster), image_(box), box.size(), 0, 0, cv::INTER_NEAREST);
}

std::vector<std::uint8_t> encode(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> to_png(const Drawing& drawing, double scale) {
  const double large = scale * kOversampling;
  cv::Mat image(static_cast<int>(std::lround(drawing.height() * large)),
                static_cast<int>(std::lround(drawing.width() * large)), CV_8UC3,
                bgr(palette::kPaper));
  Painter painter(image, large);
  for (const Shape& shape : drawing.shapes()) painter.paint(shape);
  cv::Mat small;
  cv::resize(image, small, {}, 1 / kOversampling, 1 / kOversampling, cv::INTER_AREA);
  return encode(small);
}

std::vector<std::uint8_t> to_png(const Raster& raster) { return encode(to_mat(raster)); }

}  // namespace surefoot::apps
