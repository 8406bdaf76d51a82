// Points two at a time against one at a time, and the one height that a cell gets from them.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/geometry/rotations.h"
#include "core/mapping/scan_cells.h"
#include "core/mapping/scan_points.h"
#include "core/math/elementary.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping::test {
namespace {

double place_of(double x_O_m, double y_O_m, double size_m, CellIndex first) {
  const CellIndex index = cell_index(x_O_m, y_O_m, size_m);
  const std::int32_t column = index.ix - first.ix;
  const std::int32_t row = index.iy - first.iy;
  const bool inside = column >= 0 && row >= 0 && column < kMapSide && row < kMapSide;
  return inside ? row * kMapSide + column : -1;
}

TEST(ScanPoints, AreThoseOfOnePixelAtATime) {
  Random random(3);
  MappingConfig config = recommended_config();
  const DepthSensorModel sensor{0.0006, 0.17, 40.0};
  const auto image = std::make_unique<DepthImage>();
  const auto frame = std::make_unique<hal::DepthFrame>();
  int outside = 0;
  for (int round = 0; round < 40; ++round) {
    config.cell_size_m = random.uniform(0.005, 0.1);
    const auto width = static_cast<std::uint16_t>(1 + random.below(50));
    frame->intrinsics = {width, 9, 30.0, 31.0, 0.4 * width, 4.0};
    for (std::size_t i = 0; i < frame->pixel_count(); ++i) {
      frame->depth[i] = static_cast<std::uint16_t>(random.below(45000));
    }
    prepare(*frame, config, sensor, *image);
    CameraPose X_OC;
    const double roll_rad = random.uniform(-3, 3);
    const double pitch_rad = random.uniform(-1.5, 1.5);
    X_OC.rotation.matrix =
        geometry::from_roll_pitch_yaw(roll_rad, pitch_rad, random.uniform(-3, 3));
    const double x_O_m = random.uniform(-9e4, 9e4);
    X_OC.origin.m = Vector3(x_O_m, random.uniform(-9e4, 9e4), 0.3);
    const CellIndex first =
        ControlMap::corner(cell_index(X_OC.origin.m.x(), X_OC.origin.m.y(), config.cell_size_m));
    const PointMaker maker(*image, X_OC, config, sensor, first);
    ScanPoints points;
    for (std::int32_t v = 0; v < image->height; ++v) {
      for (std::int32_t u = 0; u < image->width; ++u) {
        const double z = static_cast<double>(image->z_m[image->at(u, v)]);
        if (!(z > 0) || z > sensor.max_range_m) continue;
        const std::int32_t begin = u / ScanPoints::kCount * ScanPoints::kCount;
        maker.make(begin, v, std::min(image->width - begin, ScanPoints::kCount), points);
        const auto i = static_cast<std::size_t>(u - begin);
        const Vector3 ray = X_OC.rotation.matrix *
                            Vector3((u - image->cx) / image->fx, (v - image->cy) / image->fy, 1.0);
        const Vector3 p = X_OC.origin.m + z * ray;
        ASSERT_NEAR(points.x_O_m[i], p.x(), 1e-10);
        ASSERT_NEAR(points.y_O_m[i], p.y(), 1e-10);
        ASSERT_NEAR(points.z_O_m[i], p.z(), 1e-13);
        ASSERT_EQ(points.place[i],
                  place_of(points.x_O_m[i], points.y_O_m[i], config.cell_size_m, first));
        outside += points.place[i] < 0 ? 1 : 0;
        const double sigma = z * z * sensor.inverse_depth_sigma_per_m;
        const double noise = sigma * sigma + math::square(config.depth_noise_floor_m);
        ASSERT_NEAR(points.variance_m2[i], noise * ray.z() * ray.z() + 1e-8,
                    1e-12 * points.variance_m2[i]);
        ASSERT_EQ(points.weight[i], 1.0 / points.variance_m2[i]);
      }
    }
  }
  EXPECT_GT(outside, 100);
}

// Straight down, the middle pixel's point lies exactly below the camera.
TEST(ScanPoints, OnABorderBelongToTheCellThatBeginsThere) {
  Random random(4);
  MappingConfig config = recommended_config();
  const DepthSensorModel sensor{0.0006, 0.17, 4.0};
  const auto image = std::make_unique<DepthImage>();
  const auto frame = std::make_unique<hal::DepthFrame>();
  frame->intrinsics = {3, 3, 30.0, 30.0, 1.0, 1.0};
  for (std::size_t i = 0; i < 9; ++i) frame->depth[i] = 1000;
  CameraPose X_OC;
  X_OC.rotation.matrix << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  ScanPoints points;
  for (int round = 0; round < 20000; ++round) {
    config.cell_size_m = round % 2 == 0 ? 0.015 : random.uniform(0.005, 0.2);
    prepare(*frame, config, sensor, *image);
    const auto ix = static_cast<std::int32_t>(random.below(200000)) - 100000;
    const double border = ix * config.cell_size_m;
    const double x = round % 3 == 0   ? border
                     : round % 3 == 1 ? std::nextafter(border, -1e9)
                                      : std::nextafter(border, 1e9);
    X_OC.origin.m = Vector3(x, -x, 1.0);
    const CellIndex first{ix - 500, -ix - 500};
    PointMaker(*image, X_OC, config, sensor, first).make(1, 1, 1, points);
    ASSERT_EQ(points.x_O_m[0], x);
    ASSERT_EQ(points.place[0], place_of(x, -x, config.cell_size_m, first));
  }
}

CellPoint point(double height_m, double sigma_m) {
  const double variance_m2 = sigma_m * sigma_m;
  return {height_m, variance_m2, 1.0 / variance_m2, 1e-6};
}

TEST(ScanCells, AverageWhatAgreesAndKeepTheHighest) {
  const auto scan = std::make_unique<ScanCells>();
  constexpr double kGate2 = 9.0;
  ASSERT_EQ(scan->add(7, point(0.100, 0.01), kGate2), Status::kOk);
  ASSERT_EQ(scan->add(7, point(0.110, 0.01), kGate2), Status::kOk);
  ASSERT_EQ(scan->add(7, point(0.020, 0.01), kGate2), Status::kOk);  // below: left out
  ASSERT_EQ(scan->size(), 1u);
  EXPECT_NEAR((*scan)[0].height_m(), 0.105, 1e-15);
  EXPECT_NEAR((*scan)[0].variance_m2(), 0.5e-4 + 1e-6, 1e-12);
  ASSERT_EQ(scan->add(8, point(0.5, 0.01), kGate2), Status::kOk);
  ASSERT_EQ(scan->add(7, point(0.300, 0.02), kGate2), Status::kOk);  // above: takes the cell
  EXPECT_NEAR((*scan)[0].height_m(), 0.300, 1e-15);
  EXPECT_EQ((*scan)[0].place, 7u);
  EXPECT_EQ((*scan)[1].place, 8u);
  scan->clear();
  EXPECT_EQ(scan->size(), 0u);
  ASSERT_EQ(scan->add(7, point(0.2, 0.01), kGate2), Status::kOk);
  EXPECT_EQ((*scan)[0].height_m(), 0.2);  // nothing is left of the last frame
}

TEST(ScanCells, RefuseNewCellsWhenFull) {
  const auto scan = std::make_unique<ScanCells>();
  for (std::uint32_t i = 0; i < kMaxScanCells; ++i) {
    ASSERT_EQ(scan->add(i * 48, point(0.1, 0.01), 9.0), Status::kOk);
  }
  EXPECT_EQ(scan->add(1, point(0.1, 0.01), 9.0), Status::kExhausted);
  EXPECT_EQ(scan->add(0, point(0.1, 0.01), 9.0), Status::kOk);  // a cell it has
  EXPECT_EQ(scan->size(), kMaxScanCells);
}

}  // namespace
}  // namespace surefoot::mapping::test
