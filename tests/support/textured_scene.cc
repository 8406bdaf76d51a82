#include "tests/support/textured_scene.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/geometry/rotations.h"

namespace surefoot::tests {

namespace {

constexpr double kFarthest_m = 20;

double ease(double t) { return t * t * (3 - 2 * t); }

// Adds noise of one grid size to a picture that repeats.
void add_octave(std::vector<float>& texture, int side, int cells, double weight, Random& random) {
  std::vector<double> corners(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  for (double& corner : corners) corner = random.uniform(-1, 1);
  const auto corner = [&](int x, int y) {
    return corners[static_cast<std::size_t>((y % cells) * cells + x % cells)];
  };
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      const double x = static_cast<double>(u) * cells / side;
      const double y = static_cast<double>(v) * cells / side;
      const int i = static_cast<int>(x);
      const int j = static_cast<int>(y);
      const double wx = ease(x - i);
      const double wy = ease(y - j);
      const double above = corner(i, j) * (1 - wx) + corner(i + 1, j) * wx;
      const double below = corner(i, j + 1) * (1 - wx) + corner(i + 1, j + 1) * wx;
      texture[static_cast<std::size_t>(v * side + u)] +=
          static_cast<float>(weight * (above * (1 - wy) + below * wy));
    }
  }
}

// Where a ray enters a box, and which of its axes it crosses there.
bool enter(const TexturedBox& box, const Vector3& origin, const Vector3& direction, double& at,
           int& axis) {
  double first = 0;
  double last = kFarthest_m;
  axis = -1;
  for (int i = 0; i < 3; ++i) {
    const double to_low = (box.centre_m[i] - box.half_m[i] - origin[i]) / direction[i];
    const double to_high = (box.centre_m[i] + box.half_m[i] - origin[i]) / direction[i];
    const double near = std::min(to_low, to_high);
    last = std::min(last, std::max(to_low, to_high));
    if (near > first) {
      first = near;
      axis = i;
    }
  }
  at = first;
  return axis >= 0 && first < last;
}

}  // namespace

CameraPlace walking_camera(const Vector3& p_WN_m, double yaw_rad, double pitch_rad,
                           double roll_rad) {
  Matrix3 R_BN;
  R_BN << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {geometry::from_roll_pitch_yaw(roll_rad, pitch_rad, yaw_rad) * R_BN, p_WN_m};
}

TexturedScene::TexturedScene(std::uint64_t seed, double contrast, int boxes)
    : contrast_(contrast), texture_(static_cast<std::size_t>(kSide) * kSide) {
  Random random(seed, 91);
  for (int octave = 0; octave < 7; ++octave) {
    add_octave(texture_, kSide, 8 << octave, 0.35 * std::pow(0.85, octave), random);
  }
  for (int i = 0; i < boxes; ++i) {
    const double x = random.uniform(0.8, 8.0);
    const double side = i % 2 == 0 ? 1 : -1;  // nothing stands in the way
    const double y = side * random.uniform(0.5, 1.5);
    const double half = random.uniform(0.05, 0.2);
    const double height = random.uniform(0.03, 0.25);
    boxes_.push_back({Vector3(x, y, height), Vector3(half, half, height)});
  }
}

double TexturedScene::texture(double x_m, double y_m, std::size_t surface) const {
  const double offset = 0.737 * static_cast<double>(surface);
  const double u = (x_m + offset) / kTexel_m;
  const double v = (y_m + 1.3 * offset) / kTexel_m;
  const double fu = std::floor(u);
  const double fv = std::floor(v);
  const auto wrap = [](double value) {
    return static_cast<std::size_t>(static_cast<std::int64_t>(value) & (kSide - 1));
  };
  const std::size_t i = wrap(fu);
  const std::size_t right = wrap(fu + 1);
  const std::size_t j = wrap(fv) * kSide;
  const std::size_t below = wrap(fv + 1) * kSide;
  const double wu = u - fu;
  const double wv = v - fv;
  const auto at = [&](std::size_t k) { return static_cast<double>(texture_[k]); };
  return (at(j + i) * (1 - wu) + at(j + right) * wu) * (1 - wv) +
         (at(below + i) * (1 - wu) + at(below + right) * wu) * wv;
}

TexturedScene::Frame TexturedScene::frame_of(const stereo::RectifiedPair& pair,
                                             const CameraPlace& camera,
                                             const TexturedBox& box) const {
  Frame frame{1e9, -1e9, 1e9, -1e9};
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vector3 p_W = box.centre_m + signs.cwiseProduct(box.half_m);
    const Vector3 p = camera.R_WN.transpose() * (p_W - camera.p_WN_m);
    if (p.z() < 0.05) return {-1e9, 1e9, -1e9, 1e9};
    const double u = pair.cx_px + pair.focal_px * p.x() / p.z();
    const double v = pair.cy_px + pair.focal_px * p.y() / p.z();
    frame.left_px = std::min(frame.left_px, u - 1);
    frame.right_px = std::max(frame.right_px, u + 1);
    frame.top_px = std::min(frame.top_px, v - 1);
    frame.bottom_px = std::max(frame.bottom_px, v + 1);
  }
  return frame;
}

TexturedScene::Hit TexturedScene::cast(const Vector3& origin, const Vector3& direction,
                                       const std::vector<std::size_t>& near) const {
  double nearest = direction.z() < -1e-6 ? -origin.z() / direction.z() : kFarthest_m;
  nearest = std::min(nearest, kFarthest_m);
  std::size_t surface = 0;
  int axis = 2;
  for (const std::size_t i : near) {
    double at = 0;
    int crossed = 0;
    if (!enter(boxes_[i], origin, direction, at, crossed) || at >= nearest) continue;
    nearest = at;
    surface = i + 1;
    axis = crossed;
  }
  Vector3 p = origin + nearest * direction;
  if (surface > 0) p -= boxes_[surface - 1].centre_m;
  const double x = axis == 0 ? p.y() : p.x();
  const double y = axis == 2 ? p.y() : p.z();
  return {nearest, texture(x, y, 3 * surface + static_cast<std::size_t>(axis))};
}

void TexturedScene::render_one(const stereo::RectifiedPair& pair, const CameraPlace& camera,
                               const Exposure& exposure, bool right, StereoPictures& out) const {
  Random random(exposure.noise_seed, right ? 2 : 1);
  const Vector3 origin = camera.p_WN_m + camera.R_WN.col(0) * (right ? pair.baseline_m : 0.0);
  std::vector<std::uint8_t>& picture = right ? out.right : out.left;
  picture.reserve(static_cast<std::size_t>(pair.width_px) * pair.height_px);
  CameraPlace eye = camera;
  eye.p_WN_m = origin;
  std::vector<Frame> frames;
  for (const TexturedBox& box : boxes_) frames.push_back(frame_of(pair, eye, box));
  std::vector<std::size_t> near;
  for (int v = 0; v < pair.height_px; ++v) {
    for (int u = 0; u < pair.width_px; ++u) {
      near.clear();
      for (std::size_t i = 0; i < frames.size(); ++i) {
        const Frame& frame = frames[i];
        if (u >= frame.left_px && u <= frame.right_px && v >= frame.top_px &&
            v <= frame.bottom_px) {
          near.push_back(i);
        }
      }
      const auto direction = [&](double du, double dv) -> Vector3 {
        return camera.R_WN * Vector3((u + du - pair.cx_px) / pair.focal_px,
                                     (v + dv - pair.cy_px) / pair.focal_px, 1);
      };
      double sum = 0;
      for (int ray = 0; ray < 4; ++ray) {
        sum += cast(origin, direction(ray % 2 * 0.5 - 0.25, ray / 2 * 0.5 - 0.25), near).grey;
      }
      const double grey = 120 + 0.5 * contrast_ * sum / 4;
      double noise = -3 * exposure.grey_noise;
      for (int i = 0; i < 3; ++i) noise += 2 * exposure.grey_noise * random.uniform();
      const double seen = exposure.gain * grey + exposure.offset + noise;
      picture.push_back(static_cast<std::uint8_t>(std::clamp(std::floor(seen + 0.5), 0.0, 255.0)));
      if (right) continue;
      const double depth = cast(origin, direction(0, 0), near).depth_m;
      out.disparity_px.push_back(static_cast<float>(pair.focal_px * pair.baseline_m / depth));
    }
  }
}

StereoPictures TexturedScene::render(const stereo::RectifiedPair& pair, const CameraPlace& camera,
                                     const Exposure& exposure) const {
  StereoPictures out;
  out.width_px = pair.width_px;
  out.height_px = pair.height_px;
  render_one(pair, camera, exposure, false, out);
  render_one(pair, camera, exposure, true, out);
  return out;
}

stereo::RectifiedPair small_pair() {
  stereo::RectifiedPair pair;
  pair.width_px = 320;
  pair.height_px = 240;
  pair.focal_px = 260;
  pair.cx_px = 159.5;
  pair.cy_px = 119.5;
  pair.baseline_m = 0.06;
  return pair;
}

}  // namespace surefoot::tests
