// Rock fields with few bodies: hulls, rest, repeatability, and a cache that mends itself.
#include "sim_hal/world/rock_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "core/base/random.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/convex_hull.h"

namespace surefoot::sim {
namespace {

namespace fs = std::filesystem;

RockFieldOptions few(int bodies = 6) {
  RockFieldOptions options;
  options.bodies = bodies;
  options.length_m = 0.40;
  options.width_m = 0.35;
  return options;
}

class Folder {
 public:
  Folder()
      : path_(fs::temp_directory_path() /
              ("surefoot-rocks-" +
               std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(ConvexHull, EveryPointLiesBehindEveryTriangleAndTheSurfaceIsClosed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<Vector3> points;
    for (int i = 0; i < 20; ++i) {
      points.push_back(Vector3{random.normal(), random.normal(), random.normal()});
    }
    const ConvexBody hull = convex_hull(points);
    for (const auto& t : hull.triangles) {
      const Vector3& a = hull.points_m[t[0]];
      const Vector3 normal = (hull.points_m[t[1]] - a).cross(hull.points_m[t[2]] - a);
      for (const Vector3& p : points) EXPECT_LE(normal.dot(p - a), 1e-12);
    }
    // Euler: V - E + F = 2 with E = 3 F / 2; every directed edge has its opposite once.
    EXPECT_EQ(2 * hull.points_m.size(), 4 + hull.triangles.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& t : hull.triangles) {
      for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
    }
    EXPECT_EQ(edges.size(), 3 * hull.triangles.size());
    for (const auto& [from, to] : edges) EXPECT_EQ(edges.count({to, from}), 1u);
  }
}

TEST(ConvexHull, VolumeAndCentroidOfATetrahedron) {
  const ConvexBody hull = convex_hull({{1, 1, 1}, {4, 1, 1}, {1, 3, 1}, {1, 1, 2}});
  const Solid solid = solid_of(hull);
  EXPECT_NEAR(solid.volume_m3, 3.0 * 2.0 * 1.0 / 6, 1e-12);
  EXPECT_TRUE(solid.centroid_m.isApprox(Vector3(1.75, 1.5, 1.25), 1e-12));
}

TEST(RockField, RestsInsideItsBoxAndHasTheHeightAskedFor) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RockField field = make_rock_field(few(), seed);
    ASSERT_EQ(field.columns, 400u);
    ASSERT_EQ(field.rows, 350u);
    ASSERT_EQ(field.z_m.size(), 400u * 350u);
    const auto [low, high] = std::minmax_element(field.z_m.begin(), field.z_m.end());
    EXPECT_EQ(*low, 0.0f);
    EXPECT_NEAR(*high, 0.14, 1e-6);
    EXPECT_EQ(field.lost_bodies, 0u);
    EXPECT_LT(field.rest_speed_m_s, 0.005);
    EXPECT_LT(field.deepest_contact_m, 0.0015);
    EXPECT_LT(field.simulated_s, 7.9);  // it came to rest and was not broken off
    // A mean of 20 x 20 samples: neighbours differ by little more than a twentieth of a rock.
    float steepest = 0;
    for (std::size_t j = 0; j < field.rows; ++j) {
      for (std::size_t i = 1; i < field.columns; ++i) {
        steepest = std::max(steepest, std::abs(field.at(i, j) - field.at(i - 1, j)));
      }
    }
    EXPECT_GT(steepest, 0.001f);
    EXPECT_LT(steepest, 0.02f);
  }
}

TEST(RockField, SameSeedSameBitsOtherSeedOtherRocks) {
  const RockField first = make_rock_field(few(), 5);
  const RockField other = make_rock_field(few(), 6);
  const RockField again = make_rock_field(few(), 5);
  EXPECT_EQ(first.z_m, again.z_m);
  EXPECT_EQ(first.simulated_s, again.simulated_s);
  EXPECT_NE(first.z_m, other.z_m);
}

TEST(RockField, OptionsThatMakeNoFieldAreRefused) {
  const auto refused = [](auto&& change) {
    RockFieldOptions options = few();
    change(options);
    EXPECT_THROW((void)make_rock_field(options, 1), SimulatorError);
  };
  refused([](RockFieldOptions& o) { o.bodies = 0; });
  refused([](RockFieldOptions& o) { o.points_per_body = 3; });
  refused([](RockFieldOptions& o) { o.length_m = 0.1; });
  refused([](RockFieldOptions& o) { o.height_range_m = 0; });
  refused([](RockFieldOptions& o) { o.kernel_side = 0; });
}

TEST(RockCache, KeepsAFieldAndMendsADamagedOne) {
  const Folder folder;
  const RockFieldOptions options = few(3);
  const RockField made = cached_rock_field(folder.path(), options, 9);
  const fs::path file = rock_field_file(folder.path(), options, 9);
  ASSERT_TRUE(fs::exists(file));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  const fs::file_time_type written = fs::last_write_time(file);
  const RockField kept = cached_rock_field(folder.path(), options, 9);
  EXPECT_EQ(fs::last_write_time(file), written);
  EXPECT_EQ(kept.z_m, made.z_m);
  EXPECT_EQ(kept.simulated_s, made.simulated_s);
  EXPECT_EQ(kept.scale, made.scale);

  // One bit in the middle; then cut short; then nothing.
  std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekg(200'000);
  const char byte = static_cast<char>(damaged.get());
  damaged.seekp(200'000);
  damaged.put(static_cast<char>(byte ^ 1));
  damaged.close();
  EXPECT_EQ(cached_rock_field(folder.path(), options, 9).z_m, made.z_m);
  fs::resize_file(file, 1000);
  EXPECT_EQ(cached_rock_field(folder.path(), options, 9).z_m, made.z_m);
  fs::resize_file(file, 0);
  EXPECT_EQ(cached_rock_field(folder.path(), options, 9).z_m, made.z_m);
  EXPECT_EQ(cached_rock_field(folder.path(), options, 9).z_m, made.z_m);  // whole again
}

TEST(RockCache, NamesTellSeedsAndOptionsApart) {
  RockFieldOptions other = few();
  other.point_deviation_m += 1e-9;
  const std::set<fs::path> names{rock_field_file("a", few(), 1), rock_field_file("a", few(), 2),
                                 rock_field_file("a", other, 1), rock_field_file("b", few(), 1)};
  EXPECT_EQ(names.size(), 4u);
}

TEST(RockCache, AFolderThatCannotBeWrittenIsAnError) {
  EXPECT_THROW((void)cached_rock_field("/proc/surefoot", few(1), 1), SimulatorError);
}

}  // namespace
}  // namespace surefoot::sim
