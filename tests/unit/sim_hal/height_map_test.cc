// Height maps from files: good ones, damaged ones, and standing on them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "sim_hal/world/grid_contacts.h"
#include "sim_hal/world/height_map_file.h"
#include "sim_hal/world/terrain.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

class HeightMapFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::temp_directory_path() / (std::string("surefoot_sim_") + test->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    const std::string file = (folder_ / name).string();
    std::ofstream(file) << text;
    return file;
  }
  // The message of the error that reading text gives; empty when it was accepted.
  std::string error(const std::string& text) const {
    try {
      read_esri_ascii(write("map.asc", text));
      return "";
    } catch (const SimulatorError& problem) {
      return problem.what();
    }
  }
  std::filesystem::path folder_;
};

constexpr const char* kHead = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.5\n";

TEST_F(HeightMapFile, ReadsAGridWithHoles) {
  const RawHeightMap map = read_esri_ascii(
      write("a.asc", std::string(kHead) + "NODATA_value -9999\n1 2 3\n4 -9999 6.5e0\n"));
  EXPECT_EQ(map.columns, 3u);
  EXPECT_EQ(map.rows, 2u);
  EXPECT_EQ(map.cell_m, 0.5);
  EXPECT_EQ(map.z_m[0], 1);
  EXPECT_EQ(map.z_m[5], 6.5);
  EXPECT_EQ(map.known[4], 0);
  EXPECT_EQ(map.known[3], 1);
}

TEST_F(HeightMapFile, HeaderMayVary) {
  EXPECT_EQ(error("NROWS 2\r\nNCOLS 3\r\nCellSize 1\r\n\r\n1 2 3\r\n4 5 6 \r\n"), "");
}

TEST_F(HeightMapFile, NamesFileAndLineOfWhatIsWrong) {
  const struct {
    const char* text;
    const char* where;
    const char* what;
  } cases[] = {
      {"", "map.asc:0:", "ends before"},
      {"ncols 3\nnrows 2\n1 2 3\n4 5 6\n", "map.asc:3:", "cellsize is missing"},
      {"ncols 3\ncellsize 1\n1 2 3\n", "map.asc:3:", "nrows is missing"},
      {"ncols\nnrows 2\n", "map.asc:1:", "has no value"},
      {"ncols 3.5\n", "map.asc:1:", "not a size"},
      {"ncols 3\nnrows -2\n", "map.asc:2:", "not a size"},
      {"ncols 1e9\n", "map.asc:1:", "not a size"},
      {"ncols 3\nnrows 2\ncellsize 0\n1 2 3\n4 5 6\n", "map.asc:4:", "above 0"},
      {"ncols 3\nnrows 2\ncellsize nan\n", "map.asc:3:", "not a finite number"},
      {"ncols 3\nnrows 2\ncellsize 1\nsize 3\n", "map.asc:4:", "not a key"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2\n4 5 6\n", "map.asc:4:", "row has 2 values"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3 4\n4 5 6\n", "map.asc:4:", "more values"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3\n4 x 6\n", "map.asc:5:", "'x' is not"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3\n4 inf 6\n", "map.asc:5:", "'inf' is not"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3\n4 1,5 6\n", "map.asc:5:", "'1,5' is not"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3\n", "map.asc:4:", "ends after 1 rows"},
      {"ncols 3\nnrows 2\ncellsize 1\n1 2 3\n4 5 6\n7 8 9\n", "map.asc:6:", "more rows"},
      {"ncols 2\nnrows 2\ncellsize 1\nnodata_value 5\n5 5\n5 5\n", "map.asc", "every cell"},
      {"ncols 20000\nnrows 20000\ncellsize 1\n1\n", "map.asc:4:", "25 million"},
  };
  for (const auto& c : cases) {
    const std::string message = error(c.text);
    EXPECT_NE(message.find(c.where), std::string::npos) << c.text << "->" << message;
    EXPECT_NE(message.find(c.what), std::string::npos) << c.text << "->" << message;
  }
  EXPECT_THROW(read_esri_ascii((folder_ / "none.asc").string()), SimulatorError);
  EXPECT_THROW(read_height_map(write("map.tif", "x")), SimulatorError);
}

TEST_F(HeightMapFile, BridgesHolesByTheirLowestNeighbour) {
  RawHeightMap map = read_esri_ascii(write(
      "a.asc", "ncols 5\nnrows 2\ncellsize 1\nNODATA_value -1\n3 -1 -1 -1 7\n2 -1 -1 -1 9\n"));
  EXPECT_EQ(bridge_unknown(map), 6u);
  EXPECT_EQ(map.z_m[1], 2);
  EXPECT_EQ(map.z_m[3], 7);
  EXPECT_EQ(map.z_m[2], 2);  // second ring: the lower of 2 and 7
  EXPECT_EQ(map.z_m[7], 2);
}

TEST_F(HeightMapFile, ReadsSixteenBitPngWithItsYaml) {
  cv::Mat image(4, 3, CV_16UC1, cv::Scalar(1000));
  image.at<std::uint16_t>(1, 2) = 1500;
  image.at<std::uint16_t>(3, 0) = 0;
  const std::string file = (folder_ / "map.png").string();
  ASSERT_TRUE(cv::imwrite(file, image));
  EXPECT_THROW(read_height_map(file), SimulatorError);  // no yaml
  write("map.yaml", "metres_per_count: 0.001\ncell_size_m: 0.02\noffset_m: -1\nnodata: 0\n");
  const RawHeightMap map = read_height_map(file);
  EXPECT_EQ(map.columns, 3u);
  EXPECT_EQ(map.rows, 4u);
  EXPECT_EQ(map.cell_m, 0.02);
  EXPECT_NEAR(map.z_m[map.index(1, 2)], 0.5, 1e-12);
  EXPECT_EQ(map.known[map.index(3, 0)], 0);
  write("map.yaml", "metres_per_count: 0.001\n");
  EXPECT_THROW(read_height_map(file), SimulatorError);
  write("map.yaml", "metres_per_count: high\ncell_size_m: 0.02\n");
  try {
    read_height_map(file);
    FAIL();
  } catch (const SimulatorError& problem) {
    EXPECT_NE(std::string(problem.what()).find("map.yaml:1: metres_per_count"), std::string::npos);
  }
  write("map.yaml", "metres_per_count: [\n");
  EXPECT_THROW(read_height_map(file), SimulatorError);
  cv::Mat grey(4, 3, CV_8UC1, cv::Scalar(7));
  ASSERT_TRUE(cv::imwrite(file, grey));
  write("map.yaml", "metres_per_count: 0.001\ncell_size_m: 0.02\n");
  EXPECT_THROW(read_height_map(file), SimulatorError);
}

// North (first row) is +y, east (last column) is +x: checked on a plane that rises to the
// north-east.
TEST_F(HeightMapFile, LiesTheRightWayRound) {
  std::string text = "ncols 60\nnrows 40\ncellsize 0.1\n";
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 60; ++column) {
      text += std::to_string(0.1 * (0.1 * column) + 0.05 * (0.1 * (39 - row))) + " ";
    }
    text += "\n";
  }
  WorldSpec world;
  world.generator = Generator::kHeightMap;
  world.file = write("plane.asc", text);
  const Terrain terrain = make_terrain(world, 1);
  EXPECT_EQ(terrain.tiles, 1u);
  EXPECT_NEAR(terrain.height_m(0, 0), 0, 1e-9);
  EXPECT_NEAR(terrain.height_m(2.5, 0.5) - terrain.height_m(1.5, 0.5), 0.1, 1e-6);
  EXPECT_NEAR(terrain.height_m(2.5, 0.8) - terrain.height_m(2.5, -0.2), 0.05, 1e-6);
  EXPECT_NEAR(terrain.height_m(2.5, 0.5), 0.25 + 0.025, 0.01);
}

// A robot on a random field rests with its feet on the surface that the rays and the summary know.
TEST_F(HeightMapFile, FeetRestOnTheSurfaceTheRaysSee) {
  std::string text = "ncols 50\nnrows 30\ncellsize 0.1\n";
  Random random(3);
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 50; ++column)
      text += std::to_string(random.uniform(0, 0.02)) + " ";
    text += "\n";
  }
  WorldSpec world;
  world.generator = Generator::kHeightMap;
  world.file = write("rough.asc", text);
  Rig rig(world);
  rig.stand(1.0);
  // Sideways slope and bumps begin beyond the pad: push the robot out onto them.
  rig.simulator->set_trunk_force({70, 20, 0});
  for (int i = 0; i < 400; ++i) {
    rig.send_all({0, -1.2, 2.3}, 80, 2);
    rig.tick();
  }
  rig.simulator->set_trunk_force({0, 0, 0});
  for (int i = 0; i < 500; ++i) {
    rig.send_all({0, -1.2, 2.3}, 80, 2);
    rig.tick();
  }
  const Truth truth = rig.simulator->truth();
  EXPECT_GT(truth.p_WB_m[0], 0.4);
  int touching = 0;
  for (const FootTruth& foot : truth.feet) {
    if (!foot.contact) continue;
    ++touching;
    // Gap between the sphere and the surface, by search around the foot.
    double gap = 1;
    for (double dx = -0.015; dx <= 0.015; dx += 0.001) {
      for (double dy = -0.015; dy <= 0.015; dy += 0.001) {
        const double z = rig.simulator->terrain_height_m(foot.p_WF_m[0] + dx, foot.p_WF_m[1] + dy);
        gap = std::min(gap, std::hypot(dx, dy, foot.p_WF_m[2] - z) - 0.015);
      }
    }
    EXPECT_NEAR(gap, 0, 0.0008);
  }
  EXPECT_GE(touching, 3);
}

TEST(GridContacts, SphereTouchesFacesEdgesAndCorners) {
  // A flat roof with one raised node: a pyramid.
  HeightGrid grid;
  grid.nx = grid.ny = 11;
  grid.cell_m = 0.1;
  grid.z_m.assign(121, 0.0);
  grid.z_m[5 * 11 + 5] = 0.05;
  std::array<GridContact, 4> found;
  ASSERT_EQ(sphere_on_grid(grid, {0.23, 0.27, 0.014}, 0.015, found), 1u);  // face
  EXPECT_NEAR(found[0].depth_m, 0.001, 1e-12);
  EXPECT_NEAR(found[0].normal.z(), 1.0, 1e-12);
  ASSERT_EQ(sphere_on_grid(grid, {0.5, 0.5, 0.064}, 0.015, found), 1u);  // the top, a corner
  EXPECT_NEAR(found[0].depth_m, 0.001, 1e-12);
  EXPECT_NEAR(found[0].normal.z(), 1.0, 1e-12);
  EXPECT_EQ(sphere_on_grid(grid, {0.5, 0.5, 0.066}, 0.015, found), 0u);
  ASSERT_EQ(sphere_on_grid(grid, {0.2, 0.2, -0.02}, 0.015, found), 1u);  // buried
  EXPECT_NEAR(found[0].depth_m, 0.035, 1e-9);
  EXPECT_NEAR(found[0].normal.z(), 1.0, 1e-9);
  // A trench: both walls at once.
  for (std::size_t j = 0; j < 11; ++j) grid.z_m[j * 11 + 5] = -0.1;
  EXPECT_EQ(sphere_on_grid(grid, {0.5, 0.25, -0.08}, 0.015, found), 2u);
}

TEST(GridContacts, DepthAgreesWithADenseSearch) {
  HeightGrid grid;
  grid.nx = grid.ny = 21;
  grid.cell_m = 0.02;
  Random random(8);
  for (int i = 0; i < 441; ++i) grid.z_m.push_back(random.uniform(0, 0.01));
  std::array<GridContact, 4> found;
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    Vector3 centre;
    centre.x() = random.uniform(0.05, 0.35);
    centre.y() = random.uniform(0.05, 0.35);
    centre.z() = grid.height_m(centre.x(), centre.y()) + random.uniform(0.008, 0.016);
    double nearest = 1;
    for (double dx = -0.016; dx <= 0.016; dx += 0.0002) {
      for (double dy = -0.016; dy <= 0.016; dy += 0.0002) {
        const double z = grid.height_m(centre.x() + dx, centre.y() + dy);
        nearest = std::min(nearest, std::hypot(dx, dy, centre.z() - z));
      }
    }
    const std::size_t count = sphere_on_grid(grid, centre, 0.015, found);
    if (std::fabs(nearest - 0.015) < 0.00002) continue;
    ASSERT_EQ(count > 0, nearest < 0.015);
    if (count == 0) continue;
    ++touching;
    EXPECT_NEAR(found[0].depth_m, 0.015 - nearest, 0.00002);
  }
  EXPECT_GT(touching, 100);
}

TEST_F(HeightMapFile, ScalesMirrorsAndReportsWhatItInvented) {
  std::string text = "ncols 10\nnrows 10\ncellsize 0.5\nNODATA_value -9\n";
  for (int i = 0; i < 100; ++i)
    text += (i == 55 ? "-9" : std::to_string(i % 7)) + (i % 10 == 9 ? "\n" : " ");
  WorldSpec world;
  world.generator = Generator::kHeightMap;
  world.file = write("small.asc", text);
  world.scale = 0.1;
  const Terrain terrain = make_terrain(world, 1);
  EXPECT_EQ(terrain.bridged_cells, 1u);
  EXPECT_EQ(terrain.tiles, 50u);  // 0.5 m tiles under 4.6 m x 2.4 m
  for (double x = -0.7; x < 3.6; x += 0.01) {
    EXPECT_TRUE(terrain.grid.contains(x, 0.6));
    // No cliff between tiles steeper than inside one.
    EXPECT_LT(std::fabs(terrain.height_m(x + 0.01, 0.3) - terrain.height_m(x, 0.3)), 0.13);
  }
  for (double r = 0; r < 0.3; r += 0.02) EXPECT_NEAR(terrain.height_m(r, 0), 0, 1e-12);
}

TEST(RealHeightMap, BoulderBedLoadsAndCarriesTheRobot) {
  const std::string file = std::string(SUREFOOT_SHARED_DATA) + "/terrain/otira_rocks_a_2cm.asc";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  WorldSpec world;
  world.generator = Generator::kHeightMap;
  world.file = file;
  world.scale = 0.1;
  Rig rig(world);
  const TerrainFigures figures = rig.simulator->terrain_figures();
  EXPECT_GT(figures.bridged_cells, 1000u);
  EXPECT_GT(figures.rms_m, 0.005);
  EXPECT_LT(figures.rms_m, 0.06);
  rig.stand(2.0);
  EXPECT_NEAR(rig.simulator->truth().p_WB_m[2], 0.29, 0.02);
}

}  // namespace
}  // namespace surefoot::sim
