#include "tests/real_data/kinect_sequence.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace surefoot::real_data {
namespace {

constexpr const char* kImageEnding = ".depth.png";

PosedFrame read_pose(const std::filesystem::path& image) {
  PosedFrame frame;
  frame.image_path = image.string();
  const std::string stem =
      frame.image_path.substr(0, frame.image_path.size() - std::string(kImageEnding).size());
  std::ifstream file(stem + ".pose.txt");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) file >> frame.R_WC(row, column);
    file >> frame.p_WC_m[row];
  }
  return frame;
}

}  // namespace

std::vector<PosedFrame> list_frames(const std::string& folder) {
  std::vector<PosedFrame> frames;
  if (!std::filesystem::is_directory(folder)) return frames;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().string().ends_with(kImageEnding)) frames.push_back(read_pose(entry.path()));
  }
  std::sort(frames.begin(), frames.end(),
            [](const auto& a, const auto& b) { return a.image_path < b.image_path; });
  return frames;
}

hal::PinholeIntrinsics read_intrinsics(const std::string& folder) {
  std::ifstream file(folder + "/camera-intrinsics.txt");
  double k[9] = {};
  for (double& value : k) file >> value;
  return {640, 480, k[0], k[4], k[2], k[5]};
}

bool read_depth(const std::string& path, hal::DepthFrame& out) {
  const cv::Mat image = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (image.empty() || image.type() != CV_16UC1) return false;
  if (image.cols > static_cast<int>(hal::kMaxDepthWidth_px)) return false;
  if (image.rows > static_cast<int>(hal::kMaxDepthHeight_px)) return false;
  std::size_t i = 0;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u, ++i) {
      const auto value = image.at<std::uint16_t>(v, u);
      out.depth[i] = value == 65535 ? std::uint16_t{0} : value;
    }
  }
  out.intrinsics.width_px = static_cast<std::uint16_t>(image.cols);
  out.intrinsics.height_px = static_cast<std::uint16_t>(image.rows);
  out.depth_unit_m = 0.001F;
  return true;
}

}  // namespace surefoot::real_data
