// Rectification of pictures: for every pixel of the rectified pair the place in the camera's
// picture, computed once, then one bilinear look-up a pixel.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
#include "core/stereo/calibration.h"
#include "core/stereo/images.h"

namespace surefoot::stereo {

class Rectifier {
 public:
  // Builds both tables. kInvalid: the pair was not made by rectify() from this calibration's sizes;
  // nothing is changed. Cost: O(pixels), for start-up.
  Status configure(const StereoCalibration& calibration, const RectifiedPair& pair);

  // Rectifies both pictures; what the cameras do not see is 0. kInvalid: not configured, or the
  // pictures have another size than the calibration; outputs unchanged. Cost: O(pixels).
  Status run(const GreyView& left, const GreyView& right, GreyImage& left_out,
             GreyImage& right_out) const;

  // Removes disparities whose window (radius_px around) a camera does not wholly see. Returns how
  // many. Cost: O(pixels).
  std::uint32_t clear_unseen(std::uint16_t radius_px, DisparityImage& image) const;

  const RectifiedPair& pair() const { return pair_; }

 private:
  // In 1/64 px, kUnseen outside of the picture. The last row and column count as outside.
  struct Place {
    std::uint16_t u;
    std::uint16_t v;
  };
  static constexpr std::uint16_t kUnseen = 0xFFFF;
  using Table = std::array<Place, kMaxPixels>;

  static void fill(const CameraModel& camera, const Matrix3& R_NC, const RectifiedPair& pair,
                   Table& table);
  static void remap(const GreyView& in, const Table& table, GreyImage& out);
  bool sees(const Table& table, std::int32_t u, std::int32_t v) const;

  RectifiedPair pair_;
  std::uint16_t camera_width_px_ = 0;
  std::uint16_t camera_height_px_ = 0;
  Table left_{};
  Table right_{};
};

}  // namespace surefoot::stereo
