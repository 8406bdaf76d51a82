// Real depth frames through the mapper of the robot: half of the frames builds the map, the other
// half is predicted by it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/mapping/mapper.h"
#include "tests/real_data/kinect_sequence.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::real_data {
namespace {

using mapping::CameraPose;
using mapping::Mapper;

const std::string kDepthFolder = std::string(SUREFOOT_SHARED_DATA) + "/depth";

// Kinect: disparity noise of about 1/8 px / (585 px * 0.075 m); ranges as the data set uses them.
constexpr mapping::DepthSensorModel kKinect{
    .inverse_depth_sigma_per_m = 0.0028, .min_range_m = 0.4, .max_range_m = 4.0};

Vector3 back_project(const hal::DepthFrame& frame, int u, int v) {
  const hal::PinholeIntrinsics& k = frame.intrinsics;
  const double z =
      0.001 * frame.depth[static_cast<std::size_t>(v) * k.width_px + static_cast<std::size_t>(u)];
  return {(u - k.cx_px) / k.fx_px * z, (v - k.cy_px) / k.fy_px * z, z};
}

// Surface normal in C from the pixels four away, towards the camera; zero where one is missing or
// the surface is broken there.
Vector3 normal_at(const hal::DepthFrame& frame, int u, int v) {
  constexpr int kStep = 4;
  if (u < kStep || v < kStep || u + kStep >= 640 || v + kStep >= 480) return Vector3::Zero();
  const Vector3 middle = back_project(frame, u, v);
  const Vector3 left = back_project(frame, u - kStep, v);
  const Vector3 right = back_project(frame, u + kStep, v);
  const Vector3 up = back_project(frame, u, v - kStep);
  const Vector3 down = back_project(frame, u, v + kStep);
  for (const Vector3& p : {left, right, up, down}) {
    if (p.z() <= 0 || std::fabs(p.z() - middle.z()) > 0.1) return Vector3::Zero();
  }
  const Vector3 normal = (right - left).cross(up - down);
  return normal.dot(middle) > 0 ? Vector3(-normal.normalized()) : Vector3(normal.normalized());
}

// Which way is up, from the building frames alone: starts against the mean image-down direction of
// the hand-held camera and moves to the mean of the surface normals around it, the cone narrowing
// from 25 to 5 degrees: floor and table tops are the dominant surfaces facing up.
Vector3 find_up(const std::vector<PosedFrame>& frames, hal::DepthFrame& scratch) {
  std::vector<Vector3> normals;
  Vector3 up = Vector3::Zero();
  for (std::size_t i = 1; i < frames.size(); i += 4) {
    if (!read_depth(frames[i].image_path, scratch)) continue;
    up -= frames[i].R_WC.col(1);
    for (int v = 8; v < 472; v += 8) {
      for (int u = 8; u < 632; u += 8) {
        const Vector3 normal = normal_at(scratch, u, v);
        if (normal.norm() > 0.5) normals.push_back(frames[i].R_WC * normal);
      }
    }
  }
  up.normalize();
  for (const double cone_deg : {25.0, 20.0, 15.0, 10.0, 10.0, 7.0, 5.0, 5.0, 5.0}) {
    Vector3 sum = Vector3::Zero();
    for (const Vector3& normal : normals) {
      if (normal.dot(up) > std::cos(cone_deg * 3.14159265 / 180)) sum += normal;
    }
    up = sum.normalized();
  }
  return up;
}

Matrix3 level_axes(const Vector3& up_W, const Vector3& forward_W) {
  const Vector3 left = up_W.cross(forward_W).normalized();
  Matrix3 R_OW;
  R_OW.row(0) = left.cross(up_W).transpose();
  R_OW.row(1) = left.transpose();
  R_OW.row(2) = up_W.transpose();
  return R_OW;
}

CameraPose pose_in_O(const PosedFrame& frame, const Matrix3& R_OW, const Vector3& origin_W) {
  CameraPose pose;
  // The file's rotation is rounded: one Gram-Schmidt pass makes it orthonormal.
  Matrix3 R = R_OW * frame.R_WC;
  R.col(0).normalize();
  R.col(1) = (R.col(1) - R.col(1).dot(R.col(0)) * R.col(0)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  pose.rotation.matrix = R;
  pose.origin.m = R_OW * (frame.p_WC_m - origin_W);
  return pose;
}

// Errors of the points that fall on measured cells.
struct Comparison {
  std::vector<double> all_m;      // |point height - map height|, every point
  std::vector<double> facing_m;   // the same, points on surfaces facing up within 45 degrees
  std::vector<double> surface_m;  // every point, to the map's surface with its vertical faces
  std::size_t points = 0;
  std::size_t facing_points = 0;
};

// A height map says that between neighbours of different height stands a vertical face. The
// distance in height from z to the cell's own height or to such a face (steps of 3 cm and more)
// beside it.
double to_surface(const mapping::ControlMap& map, mapping::CellIndex index, double z) {
  const double height = static_cast<double>(map.at(index).height_m);
  double low = height;
  double high = height;
  for (int i = 0; i < 9; ++i) {
    const mapping::MapCell* cell = map.find(index + mapping::CellIndex{i % 3 - 1, i / 3 - 1});
    if (cell == nullptr || cell->state != mapping::CellState::kMeasured) continue;
    const double other = static_cast<double>(cell->height_m);
    if (std::fabs(other - height) < 0.03) continue;
    low = std::min(low, other);
    high = std::max(high, other);
  }
  return std::max({0.0, low - z, z - high});
}

double percentile(std::vector<double> values, double share) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Every eighth pixel and row within the sensor's range, below the height limit of the map. Whether
// a point counts is decided from its own frame (range, height, normal), never from the map's
// height.
void compare(const Mapper& mapper, const hal::DepthFrame& frame, const CameraPose& pose,
             double max_z, Comparison& out) {
  for (int v = 4; v < 480; v += 8) {
    for (int u = 4; u < 640; u += 8) {
      const Vector3 p_C = back_project(frame, u, v);
      if (p_C.z() < kKinect.min_range_m || p_C.z() > kKinect.max_range_m) continue;
      const Vector3 p = pose.rotation.matrix * p_C + pose.origin.m;
      if (p.z() > max_z) continue;
      const Vector3 normal = pose.rotation.matrix * normal_at(frame, u, v);
      const bool facing = normal.z() > 0.7071;
      ++out.points;
      out.facing_points += facing ? 1 : 0;
      const mapping::MapCell* cell =
          mapper.map().find(mapping::cell_index(p.x(), p.y(), mapper.cell_size_m()));
      if (cell == nullptr || cell->state != mapping::CellState::kMeasured) continue;
      const double error = std::fabs(p.z() - static_cast<double>(cell->height_m));
      out.all_m.push_back(error);
      const mapping::CellIndex index = mapping::cell_index(p.x(), p.y(), mapper.cell_size_m());
      out.surface_m.push_back(to_surface(mapper.map(), index, p.z()));
      if (facing) out.facing_m.push_back(error);
    }
  }
}

Comparison run_kitchen(const std::string& folder, const std::vector<PosedFrame>& frames) {
  auto frame = std::make_unique<hal::DepthFrame>();
  frame->intrinsics = read_intrinsics(folder);
  const Vector3 up = find_up(frames, *frame);
  const Matrix3 R_OW = level_axes(up, frames[0].R_WC.col(2));
  const Vector3 origin = frames[0].p_WC_m;
  const mapping::MappingConfig config = mapping::test::recommended_config();
  auto mapper = std::make_unique<Mapper>();
  EXPECT_EQ(mapper->configure(config, kKinect, mapping::test::limits_of(config)), Status::kOk);
  for (std::size_t i = 1; i < frames.size(); i += 2) {
    EXPECT_TRUE(read_depth(frames[i].image_path, *frame)) << frames[i].image_path;
    frame->stamp = milliseconds(200 * static_cast<std::int64_t>(i) + 1);  // every 6th of 30 Hz
    const CameraPose pose = pose_in_O(frames[i], R_OW, origin);
    mapping::SelfModel camera_as_body;
    camera_as_body.X_OB.origin.m = pose.origin.m;
    mapping::IntegrationReport report;
    EXPECT_EQ(mapper->integrate(*frame, pose, camera_as_body, &report), Status::kOk);
    EXPECT_LE(report.pixels, mapping::kMaxPixels);  // stride 4: 160 x 120
  }
  Comparison comparison;
  for (std::size_t i = 0; i < frames.size(); i += 2) {
    EXPECT_TRUE(read_depth(frames[i].image_path, *frame)) << frames[i].image_path;
    const CameraPose pose = pose_in_O(frames[i], R_OW, origin);
    compare(*mapper, *frame, pose, pose.origin.m.z() + config.max_height_above_body_m, comparison);
  }
  std::printf("up in the recording's world: %.4f %.4f %.4f\n", up.x(), up.y(), up.z());
  return comparison;
}

void print(const char* name, std::size_t points, const std::vector<double>& errors_m) {
  std::printf("%s: %zu points, %.1f %% on measured cells, error median %.1f mm, p75 %.1f mm\n",
              name, points,
              100.0 * static_cast<double>(errors_m.size()) / static_cast<double>(points),
              1e3 * percentile(errors_m, 0.5), 1e3 * percentile(errors_m, 0.75));
}

// Two figures must hold. Points on ground-like surfaces (normal within 45 degrees of up, from their
// own frame) against the height of their cell; and every point, walls, chair legs and all, against
// the map's surface including its vertical faces. The third, every point against the height of its
// cell, is printed and not judged: a wall's points hang below the height of their cell by nature.
TEST(KitchenSequence, HalfOfTheFramesPredictsTheOther) {
  const std::string folder = kDepthFolder + "/kitchen_a";
  const std::vector<PosedFrame> frames = list_frames(folder);
  if (frames.empty()) GTEST_SKIP() << "no recordings at " << folder;
  const Comparison comparison = run_kitchen(folder, frames);
  print("facing up, to the cell", comparison.facing_points, comparison.facing_m);
  print("all, to the surface", comparison.points, comparison.surface_m);
  print("all, to the cell (not judged)", comparison.points, comparison.all_m);
  EXPECT_GT(comparison.facing_m.size(), 9 * comparison.facing_points / 10);
  EXPECT_GT(comparison.facing_points, comparison.points / 5);
  EXPECT_LE(percentile(comparison.facing_m, 0.5), 0.015);
  EXPECT_LE(percentile(comparison.surface_m, 0.5), 0.015);
}

// The sensor family of the robot. The recording has no pose: taken as a level camera, the frames
// must be read and inserted, and the second must fall on the cells of the first. Heights are not
// judged.
TEST(RealSenseFrames, AreReadAndInserted) {
  const std::string folder = kDepthFolder + "/realsense";
  std::ifstream file(folder + "/intrinsics.json");
  if (!file) GTEST_SKIP() << "no recordings at " << folder;
  const auto json = nlohmann::json::parse(file);
  auto frame = std::make_unique<hal::DepthFrame>();
  auto mapper = std::make_unique<Mapper>();
  const double focal_px = json.at("fx");
  const double baseline_m = 1e-3 * json.at("stereo_baseline_mm").get<double>();
  const mapping::DepthSensorModel sensor{
      .inverse_depth_sigma_per_m = 0.08 / (focal_px * baseline_m),
      .min_range_m = 0.17,
      .max_range_m = 4.0};
  const mapping::MappingConfig config = mapping::test::recommended_config();
  ASSERT_EQ(mapper->configure(config, sensor, mapping::test::limits_of(config)), Status::kOk);
  const CameraPose pose = mapping::test::look({0, 0, 0.5}, 0, 0);
  mapping::IntegrationReport report;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(read_depth(folder + "/depth_" + std::to_string(i) + ".png", *frame));
    frame->intrinsics.fx_px = focal_px;
    frame->intrinsics.fy_px = json.at("fy");
    frame->intrinsics.cx_px = json.at("cx");
    frame->intrinsics.cy_px = json.at("cy");
    frame->depth_unit_m = json.at("depth_units_m");
    frame->stamp = milliseconds(33 * (i + 1));
    ASSERT_EQ(mapper->integrate(*frame, pose, mapping::test::bodiless(0, 0, 0.5), &report),
              Status::kOk);
    std::printf("depth_%d: %u pixels, %u without depth, %u mixed, %u used, %u cells\n", i,
                report.pixels, report.no_depth, report.mixed, report.points, report.cells_hit);
    EXPECT_GT(report.points, report.pixels / 4);
    EXPECT_LT(report.mixed, report.pixels / 10);
  }
  EXPECT_LT(report.cells_new, report.cells_hit / 2);  // the second frame falls on the first's cells
  EXPECT_EQ(report.cells_cleared, 0u);
}

}  // namespace
}  // namespace surefoot::real_data
