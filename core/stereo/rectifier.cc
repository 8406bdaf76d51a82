#include "core/stereo/rectifier.h"

#include <cstddef>

namespace surefoot::stereo {

namespace {

constexpr std::int32_t kPlaces = 64;  // per pixel
static_assert(kMaxWidth_px * kPlaces <= 0x10000 && kMaxHeight_px * kPlaces <= 0x10000);

}  // namespace

void Rectifier::fill(const CameraModel& camera, const Matrix3& R_NC, const RectifiedPair& pair,
                     Table& table) {
  const Matrix3 R_CN = R_NC.transpose();
  // Beyond these the bilinear look-up would leave the picture.
  const double last_u = kPlaces * (camera.width_px - 1.0);
  const double last_v = kPlaces * (camera.height_px - 1.0);
  std::size_t pixel = 0;
  for (std::size_t v = 0; v < pair.height_px; ++v) {
    for (std::size_t u = 0; u < pair.width_px; ++u, ++pixel) {
      const Vector3 ray_N((static_cast<double>(u) - pair.cx_px) / pair.focal_px,
                          (static_cast<double>(v) - pair.cy_px) / pair.focal_px, 1.0);
      const Vector3 ray_C = R_CN * ray_N;
      table[pixel] = {kUnseen, kUnseen};
      if (!(ray_C.z() > 1e-3)) continue;
      const Vector2 at = kPlaces * camera.project(ray_C.x() / ray_C.z(), ray_C.y() / ray_C.z());
      const double u_64 = at.x() + 0.5;
      const double v_64 = at.y() + 0.5;
      if (!(u_64 >= 0.0 && u_64 < last_u && v_64 >= 0.0 && v_64 < last_v)) continue;
      table[pixel] = {static_cast<std::uint16_t>(u_64), static_cast<std::uint16_t>(v_64)};
    }
  }
}

Status Rectifier::configure(const StereoCalibration& calibration, const RectifiedPair& pair) {
  const CameraModel& left = calibration.left;
  const CameraModel& right = calibration.right;
  if (left.width_px != right.width_px || left.height_px != right.height_px || left.width_px < 16 ||
      left.width_px > kMaxWidth_px || left.height_px < 16 || left.height_px > kMaxHeight_px ||
      pair.width_px < 16 || pair.width_px > kMaxWidth_px || pair.height_px < 16 ||
      pair.height_px > kMaxHeight_px || !(pair.focal_px > 0.0)) {
    return Status::kInvalid;
  }
  pair_ = pair;
  camera_width_px_ = left.width_px;
  camera_height_px_ = left.height_px;
  fill(left, pair.R_NV, pair, left_);
  fill(right, pair.R_NE, pair, right_);
  return Status::kOk;
}

void Rectifier::remap(const GreyView& in, const Table& table, GreyImage& out) {
  const std::size_t width = in.width_px;
  for (std::size_t pixel = 0; pixel < static_cast<std::size_t>(out.width_px) * out.height_px;
       ++pixel) {
    const Place place = table[pixel];
    if (place.u == kUnseen) {
      out.pixels[pixel] = 0;
      continue;
    }
    const std::uint8_t* from =
        in.pixels + static_cast<std::size_t>(place.v / kPlaces) * width + place.u / kPlaces;
    const std::int32_t right = place.u % kPlaces;
    const std::int32_t down = place.v % kPlaces;
    const std::int32_t above = (kPlaces - right) * from[0] + right * from[1];
    const std::int32_t below = (kPlaces - right) * from[width] + right * from[width + 1];
    const std::int32_t sum = (kPlaces - down) * above + down * below;
    out.pixels[pixel] =
        static_cast<std::uint8_t>((sum + kPlaces * kPlaces / 2) / kPlaces / kPlaces);
  }
}

Status Rectifier::run(const GreyView& left, const GreyView& right, GreyImage& left_out,
                      GreyImage& right_out) const {
  const auto fits = [&](const GreyView& view) {
    return view.width_px == camera_width_px_ && view.height_px == camera_height_px_;
  };
  if (camera_width_px_ == 0 || !fits(left) || !fits(right)) return Status::kInvalid;
  for (GreyImage* out : {&left_out, &right_out}) {
    out->width_px = pair_.width_px;
    out->height_px = pair_.height_px;
  }
  remap(left, left_, left_out);
  remap(right, right_, right_out);
  return Status::kOk;
}

bool Rectifier::sees(const Table& table, std::int32_t u, std::int32_t v) const {
  if (u < 0 || v < 0 || u >= pair_.width_px || v >= pair_.height_px) return false;
  return table[static_cast<std::size_t>(v * pair_.width_px + u)].u != kUnseen;
}

// The corners of the window stand for all of it: what a camera sees has no holes.
std::uint32_t Rectifier::clear_unseen(std::uint16_t radius_px, DisparityImage& image) const {
  if (image.width_px != pair_.width_px || image.height_px != pair_.height_px) return 0;
  const std::int32_t r = radius_px;
  std::uint32_t cleared = 0;
  for (std::int32_t v = 0; v < image.height_px; ++v) {
    std::int16_t* row = image.row(static_cast<std::size_t>(v));
    for (std::int32_t u = 0; u < image.width_px; ++u) {
      if (row[u] == kNoDisparity) continue;
      const std::int32_t other = u - (row[u] + kSubpixels / 2) / kSubpixels;
      const bool seen = sees(left_, u - r, v - r) && sees(left_, u + r, v - r) &&
                        sees(left_, u - r, v + r) && sees(left_, u + r, v + r) &&
                        sees(right_, other - r, v - r) && sees(right_, other + r, v - r) &&
                        sees(right_, other - r, v + r) && sees(right_, other + r, v + r);
      if (seen) continue;
      row[u] = kNoDisparity;
      ++cleared;
    }
  }
  return cleared;
}

}  // namespace surefoot::stereo
