// How far off the ground the map is, by the feet.
#include "core/control/map_offset.h"

#include <gtest/gtest.h>

#include <memory>

namespace surefoot::control {
namespace {

constexpr double kRadius_m = 0.0175;
constexpr double kMap_m = 0.02;  // its height everywhere

struct Feet {
  Feet() {
    window->stamp = milliseconds(1);
    window->cell_size_m = 0.015;
    window->first = {-50, -50};
    for (mapping::WindowCell& cell : window->cells) {
      cell.state = mapping::CellState::kMeasured;
      cell.height_m = static_cast<float>(kMap_m);
      cell.margin_cells = 3;
      cell.traversability = mapping::Traversability::kSteppable;
    }
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      state.feet[leg].p_O_m = Vector3(0.1 * static_cast<double>(leg), 0.05, 0.0);
    }
    offset.reset(0.1, kRadius_m);
  }
  // The leg has just settled with its sole at this height.
  void land(std::size_t leg, double sole_m) {
    estimation::FootState& foot = state.feet[leg];
    foot.p_O_m[2] = sole_m + kRadius_m;
    foot.in_contact = true;
    for (foot.ticks_since_change = 0; foot.ticks_since_change < 40; ++foot.ticks_since_change) {
      offset.update(state, legs, window.get());
    }
  }
  mapping::WindowCell& under(std::size_t leg) {
    const Vector3& p = state.feet[leg].p_O_m;
    const mapping::CellIndex index = window->locate(p[0], p[1]).value();
    return window
        ->cells[static_cast<std::size_t>((index.iy + 50) * mapping::kWindowSide + index.ix + 50)];
  }

  std::unique_ptr<mapping::MapWindow> window = std::make_unique<mapping::MapWindow>();
  estimation::RobotState state;
  std::array<LegStatus, robot::kLegs> legs;
  MapOffset offset;
};

TEST(MapOffset, IsTheMiddleOfWhatTheFeetFeel) {
  Feet feet;
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
  feet.land(0, kMap_m - 0.01);
  EXPECT_NEAR(feet.offset.offset_m(), -0.01, 1e-7);
  feet.land(1, kMap_m - 0.02);
  EXPECT_NEAR(feet.offset.offset_m(), -0.015, 1e-7);
  feet.land(2, kMap_m + 0.3);  // on something that the map does not show
  EXPECT_NEAR(feet.offset.offset_m(), -0.01, 1e-7);
  feet.land(3, kMap_m - 0.03);
  EXPECT_NEAR(feet.offset.offset_m(), -0.015, 1e-7);
  feet.land(2, kMap_m - 0.012);
  EXPECT_NEAR(feet.offset.offset_m(), -0.016, 1e-7);
}

TEST(MapOffset, IsBoundedAndForgotten) {
  Feet feet;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) feet.land(leg, kMap_m - 0.5);
  EXPECT_EQ(feet.offset.offset_m(), -0.1);
  feet.offset.clear();
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
  feet.offset.reset(0.0, kRadius_m);
  feet.land(0, kMap_m + 0.01);
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
}

// Next to an edge the map's height may be that of the other side; a leg in the air feels nothing.
TEST(MapOffset, TakesNoNoteWhereTheMapIsNotSureOrTheLegDoesNotStand) {
  Feet feet;
  feet.under(0).margin_cells = 1;
  feet.under(1).traversability = mapping::Traversability::kUnsteppable;
  feet.legs[2].mode = LegMode::kSearch;
  for (std::size_t leg = 0; leg < 3; ++leg) feet.land(leg, 0.0);
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
  feet.state.feet[3].p_O_m[0] = 9.0;  // outside the window
  feet.land(3, 0.0);
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
  feet.offset.update(feet.state, feet.legs, nullptr);
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
}

// A foot that has just touched is still on its way down, and later it only repeats itself.
TEST(MapOffset, NotesOnceAStance) {
  Feet feet;
  estimation::FootState& foot = feet.state.feet[0];
  foot.in_contact = true;
  foot.ticks_since_change = 3;
  feet.offset.update(feet.state, feet.legs, feet.window.get());
  EXPECT_EQ(feet.offset.offset_m(), 0.0);
  feet.land(0, kMap_m + 0.01);
  foot.p_O_m[2] += 0.05;
  foot.ticks_since_change = 60;
  feet.offset.update(feet.state, feet.legs, feet.window.get());
  EXPECT_NEAR(feet.offset.offset_m(), 0.01, 1e-7);
}

TEST(MapOffset, AFootFarAboveItsGroundHangs) {
  Feet feet;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) feet.land(leg, kMap_m + 0.01);
  const auto hangs = [&](double sole_m) {
    return feet.offset.hangs(Vector3(0.1, 0.05, sole_m + kRadius_m), feet.window.get());
  };
  EXPECT_FALSE(hangs(kMap_m + 0.01 + 0.0149));
  EXPECT_TRUE(hangs(kMap_m + 0.01 + 0.0151));
  EXPECT_FALSE(feet.offset.hangs(Vector3(0.1, 0.05, 1.0), nullptr));
  feet.under(1).height_m += 0.05F;  // a cell beside it
  EXPECT_FALSE(hangs(kMap_m + 0.05));
  EXPECT_FALSE(feet.offset.hangs(Vector3(5.0, 0.05, 1.0), feet.window.get()));
}

}  // namespace
}  // namespace surefoot::control
