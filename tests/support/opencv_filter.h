// What OpenCV makes of a height grid: the oracle of core/mapping's height filter.
#pragma once

#include <limits>
#include <opencv2/imgproc.hpp>

namespace surefoot::oracle {

// An unknown cell, as cells outside of the image are to cv::erode.
inline constexpr float kNothing = std::numeric_limits<float>::max();

// Paper 002, equation (4).
inline cv::Mat ellipse() { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}); }

struct Filtered {
  cv::Mat opened;    // -kNothing where nothing is known in reach
  cv::Mat gradient;  // larger magnitude of equations (5) and (6); meaningless beside -kNothing
};

// CV_32F in; unknown cells take part in no minimum and in no maximum.
inline Filtered filter(const cv::Mat& heights) {
  cv::Mat eroded;
  cv::erode(heights, eroded, ellipse());
  eroded.setTo(-kNothing, eroded == kNothing);
  Filtered result;
  cv::dilate(eroded, result.opened, ellipse());
  cv::Mat gx;
  cv::Mat gy;
  cv::Sobel(result.opened, gx, CV_32F, 1, 0);
  cv::Sobel(result.opened, gy, CV_32F, 0, 1);
  cv::absdiff(gx, cv::Scalar::all(0), gx);
  cv::absdiff(gy, cv::Scalar::all(0), gy);
  cv::max(gx, gy, result.gradient);
  return result;
}

}  // namespace surefoot::oracle
