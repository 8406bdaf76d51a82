// Pictures of textured ground with boxes on it, from anywhere: what a stereo camera sees that
// walks. World: z up, ground at 0. A pixel is the mean of four rays.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/linear.h"
#include "core/stereo/calibration.h"
#include "core/stereo/images.h"

namespace surefoot::tests {

struct TexturedBox {
  Vector3 centre_m = Vector3::Zero();
  Vector3 half_m = Vector3::Constant(0.1);
};

struct CameraPlace {
  Matrix3 R_WN = Matrix3::Identity();
  Vector3 p_WN_m = Vector3::Zero();
};

// At (x, y, height), looking along `yaw` and down by `pitch`, tilted to the right by `roll`.
CameraPlace walking_camera(const Vector3& p_WN_m, double yaw_rad, double pitch_rad,
                           double roll_rad);

struct Exposure {
  double gain = 1;
  double offset = 0;
  double grey_noise = 2;  // one sigma
  std::uint64_t noise_seed = 1;
};

struct StereoPictures {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
  std::vector<float> disparity_px;  // truth, of the middle of each left pixel

  stereo::GreyView left_view() const { return {left.data(), width_px, height_px}; }
  stereo::GreyView right_view() const { return {right.data(), width_px, height_px}; }
};

class TexturedScene {
 public:
  // contrast: grey levels between the darkest and the brightest of the pattern, about.
  TexturedScene(std::uint64_t seed, double contrast, int boxes);

  std::vector<TexturedBox>& boxes() { return boxes_; }
  StereoPictures render(const stereo::RectifiedPair& pair, const CameraPlace& camera,
                        const Exposure& exposure) const;

 private:
  struct Hit {
    double depth_m = 0;
    double grey = 0;
  };
  // The part of the picture that a box may fill.
  struct Frame {
    double left_px = 0;
    double right_px = 0;
    double top_px = 0;
    double bottom_px = 0;
  };
  Frame frame_of(const stereo::RectifiedPair& pair, const CameraPlace& camera,
                 const TexturedBox& box) const;
  Hit cast(const Vector3& origin, const Vector3& direction,
           const std::vector<std::size_t>& near) const;
  double texture(double x_m, double y_m, std::size_t surface) const;
  void render_one(const stereo::RectifiedPair& pair, const CameraPlace& camera,
                  const Exposure& exposure, bool right, StereoPictures& out) const;

  static constexpr int kSide = 1024;
  static constexpr double kTexel_m = 0.002;
  double contrast_;
  std::vector<float> texture_;
  std::vector<TexturedBox> boxes_;
};

// 320 x 240, 64 degrees wide, 6 cm apart.
stereo::RectifiedPair small_pair();

}  // namespace surefoot::tests
