// How deep a robot is in the ground, against points all over its underside and its legs.
#include "core/planning/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/mapping/foothold.h"
#include "tests/support/footstep_parts.h"

namespace surefoot::planning {
namespace {

using tests::GroundCell;

std::unique_ptr<terrain::TerrainMap> blocks(Random& random) {
  std::vector<double> heights(10000, 0.0);
  for (int k = 0; k < 60; ++k) {
    const auto left = random.below(90);
    const auto low = random.below(90);
    const double height_m = random.uniform(0.0, 0.14);
    for (std::size_t i = 0; i < 100; ++i) heights[100 * (low + i / 10) + left + i % 10] = height_m;
  }
  return tests::terrain_of([&](mapping::CellIndex i) {
    return GroundCell{.height_m = heights[static_cast<std::size_t>(100 * (i.iy + 50) + i.ix + 40)]};
  });
}

// Of trunk and legs together; 0: none is in the ground.
double deepest_contact_m(const robot::RobotModel& model, const PlanningGround& ground,
                         const Matrix3& R_OB, const Vector3& p_OB_m, const Feet& feet_O_m) {
  double deepest_m = std::max(0.0, trunk_depth_m(model, ground, R_OB, p_OB_m));
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 foot_B = R_OB.transpose() * (feet_O_m[leg] - p_OB_m);
    const robot::LegVector q_rad = robot::solve_leg(model, leg, foot_B).q_rad;
    deepest_m = std::max(deepest_m, leg_depth_m(model, ground, R_OB, p_OB_m, leg, q_rad));
  }
  return deepest_m;
}

struct Placed {
  Matrix3 R_OB;
  Vector3 p_OB_m;
  Feet feet_O_m;
};

Placed placed(Random& random, const robot::RobotModel& model) {
  Placed robot;
  const Vector3 rpy{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                    random.uniform(-3.0, 3.0)};
  robot.R_OB = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
  robot.p_OB_m =
      Vector3{random.uniform(-0.1, 0.3), random.uniform(-0.2, 0.2), random.uniform(0.10, 0.17)};
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 hip_B = robot::hip_joint_B_m(model, leg);
    const Vector3 down{random.uniform(-0.03, 0.03), random.uniform(-0.02, 0.02), -0.12};
    robot.feet_O_m[leg] = robot.R_OB * (hip_B + down) + robot.p_OB_m;
  }
  return robot;
}

// Every millimetre or so; legs against the cells next to theirs as well.
double searched_m(const robot::RobotModel& model, const terrain::TerrainMap& map, double offset_m,
                  const Placed& robot) {
  double deepest_m = 0;
  const auto look = [&](const Vector3& p_B, double radius_m) {
    const Vector3 p_O = robot.R_OB * p_B + robot.p_OB_m;
    const Result<double> ground = map.ground.height_at(p_O[0], p_O[1]);
    if (!ground.ok()) return;
    deepest_m = std::max(deepest_m, ground.value() + offset_m + radius_m - p_O[2]);
  };
  const auto look_beside = [&](const Vector3& p_B, double radius_m) {
    const Vector3 p_O = robot.R_OB * p_B + robot.p_OB_m;
    const mapping::CellIndex under = mapping::cell_index(p_O[0], p_O[1], map.ground.cell_size_m);
    const Result<float> ground = mapping::highest_ground_m(map.ground, under);
    if (!ground.ok()) return;
    const double under_m = p_O[2] - radius_m - kLegMargin_m;
    deepest_m = std::max(deepest_m, static_cast<double>(ground.value()) + offset_m - under_m);
  };
  constexpr int kParts = 100;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      look(Vector3((i / 100.0 - 0.5) * model.trunk_size_m[0],
                   (j / 100.0 - 0.5) * model.trunk_size_m[1], -0.5 * model.trunk_size_m[2]),
           0.0);
    }
  }
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 foot_B = robot.R_OB.transpose() * (robot.feet_O_m[leg] - robot.p_OB_m);
    const robot::LegVector q = robot::solve_leg(model, leg, foot_B).q_rad;
    const auto p_B = robot::leg_points_B(model, leg, q).p_B_m;
    for (int i = 0; i <= kParts; ++i) {
      const double s = i / 100.0;
      look_beside(p_B[1] + s * (p_B[2] - p_B[1]), model.thigh_radius_m);
      look_beside(p_B[2] + s * (p_B[3] - p_B[2]), model.shank_radius_m);
    }
  }
  return deepest_m;
}

TEST(Clearance, FindsMostOfWhatManyPointsFindAndNeverMore) {
  const robot::RobotModel model = robot::little_dog();
  Random random(1);
  int touching = 0;
  int found = 0;
  double missed_m = 0;
  for (int i = 0; i < 300; ++i) {
    const auto map = blocks(random);
    const Placed robot = placed(random, model);
    const double offset_m = random.uniform(-0.01, 0.01);
    const double all_m = searched_m(model, *map, offset_m, robot);
    const double few_m =
        deepest_contact_m(model, {map.get(), offset_m}, robot.R_OB, robot.p_OB_m, robot.feet_O_m);
    ASSERT_LE(few_m, all_m + 1e-9);
    ASSERT_GE(few_m, 0.0);
    if (all_m < 0.01) continue;
    ++touching;
    found += few_m > 0 ? 1 : 0;
    missed_m += all_m - few_m;
  }
  EXPECT_GE(touching, 50);
  EXPECT_GE(found, touching * 7 / 10);
  RecordProperty("touching", touching);
  RecordProperty("found", found);
  RecordProperty("mean_missed_um", static_cast<int>(1e6 * missed_m / touching));
}

// Against nine look-ups by hand, at the window's borders and around holes as well.
TEST(Clearance, TheMapKnowsTheHighestOfNine) {
  Random random(3);
  auto map = blocks(random);
  for (std::size_t i = 0; i < map->ground.cells.size(); i += 3) {
    map->ground.cells[i] = mapping::WindowCell{};
  }
  for (std::size_t i = 3000; i < 4000; ++i) map->ground.cells[i] = mapping::WindowCell{};
  map->raise_crests();
  int none = 0;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      float highest_m = terrain::TerrainMap::kNoCrest_m;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, 99); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, 99); ++x) {
          const mapping::WindowCell& cell =
              map->ground.cells[static_cast<std::size_t>(100 * y + x)];
          if (cell.has_height()) highest_m = std::max(highest_m, cell.height_m);
        }
      }
      none += highest_m == terrain::TerrainMap::kNoCrest_m ? 1 : 0;
      ASSERT_EQ(map->crest_m[static_cast<std::size_t>(100 * row + column)], highest_m)
          << row << ' ' << column;
    }
  }
  EXPECT_GT(none, 700);
}

// A plane that rises: the lowest point of the trunk, the lowest of the legs.
TEST(Clearance, LevelGroundIsTouchedByWhatIsLowest) {
  const robot::RobotModel model = robot::little_dog();
  const Feet feet = tests::standing_feet(model);
  const Vector3 p_OB_m(0, 0, 0.13);
  double shank_m = 1;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const robot::LegVector q = robot::solve_leg(model, leg, feet[leg] - p_OB_m).q_rad;
    const auto p_B = robot::leg_points_B(model, leg, q).p_B_m;
    const double lower_m = 0.13 + 0.4 * p_B[2][2] + 0.6 * p_B[3][2] - model.shank_radius_m;
    shank_m = std::min(shank_m, lower_m - kLegMargin_m);
  }
  for (double ground_m = -0.02; ground_m < 0.15; ground_m += 0.005) {
    const auto map =
        tests::terrain_of([&](mapping::CellIndex) { return GroundCell{.height_m = ground_m}; });
    const double deepest_m =
        deepest_contact_m(model, {map.get(), 0.0}, Matrix3::Identity(), p_OB_m, feet);
    EXPECT_NEAR(deepest_m, std::max({0.0, ground_m - 0.10, ground_m - shank_m}), 1e-6) << ground_m;
  }
}

TEST(Clearance, FlatGroundIsNotTouchedAndUnknownGroundIsPassedOver) {
  const robot::RobotModel model = robot::little_dog();
  const Feet feet = tests::standing_feet(model);
  const Vector3 p_OB_m(0, 0, 0.13);
  const auto deepest = [&](const terrain::TerrainMap* map) {
    return deepest_contact_m(model, {map, 0.0}, Matrix3::Identity(), p_OB_m, feet);
  };
  EXPECT_EQ(deepest(tests::flat_terrain().get()), 0.0);
  EXPECT_EQ(deepest(nullptr), 0.0);
  const auto high = [](std::int32_t known_from) {
    return tests::terrain_of([known_from](mapping::CellIndex i) {
      return GroundCell{.known = i.ix >= known_from, .height_m = 0.13};
    });
  };
  EXPECT_EQ(deepest(high(1000).get()), 0.0);
  EXPECT_GT(deepest(high(5).get()), 0.0);
  const auto elsewhere = tests::terrain_of(
      [](mapping::CellIndex) { return GroundCell{.height_m = 0.13}; }, {500, 500});
  EXPECT_EQ(deepest(elsewhere.get()), 0.0);  // outside of the window
}

// Beyond reach a leg is taken as stretched: finite, whatever is asked.
TEST(Clearance, LegsOutOfReachCountAsStretched) {
  const robot::RobotModel model = robot::little_dog();
  Feet feet = tests::standing_feet(model);
  for (Vector3& foot : feet) foot[2] -= 1.0;
  const auto map =
      tests::terrain_of([](mapping::CellIndex) { return GroundCell{.height_m = 0.05}; });
  const double deepest_m =
      deepest_contact_m(model, {map.get(), 0.0}, Matrix3::Identity(), Vector3(0, 0, 0.13), feet);
  const double shank_m = 0.13 - model.thigh_length_m - 0.6 * model.shank_length_m -
                         model.shank_radius_m - kLegMargin_m;
  EXPECT_NEAR(deepest_m, 0.05 - shank_m, 0.002);
}

}  // namespace
}  // namespace surefoot::planning
