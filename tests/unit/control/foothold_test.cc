// The Raibert point and its correction by the map.
#include "core/control/foothold.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/robot/kinematics.h"

namespace surefoot::control {
namespace {

robot::RobotModel model() {
  robot::RobotModel m;
  m.abad_x_m = 0.19;
  m.abad_y_m = 0.049;
  m.hip_offset_m = 0.062;
  m.foot_radius_m = 0.0175;
  return m;
}

FootholdConfig config() {
  FootholdConfig c;
  c.velocity_feedback_s = 0.03;
  c.max_offset_m = 0.15;
  c.search_radius_m = 0.10;
  return c;
}

estimation::RobotState moving() {
  estimation::RobotState state;
  state.p_OB_m = Vector3(1.0, 0.2, 0.3);
  state.v_OB_m_s = Vector3(0.4, 0.0, 0.0);
  return state;
}

// A window whose cells are level and steppable but for a band in x that is not.
std::unique_ptr<mapping::MapWindow> window_with_band(double from_x_m, double to_x_m) {
  auto window = std::make_unique<mapping::MapWindow>();
  window->stamp = milliseconds(1);
  window->cell_size_m = 0.015;
  window->first = {20, -40};
  for (std::int32_t iy = 0; iy < mapping::kWindowSide; ++iy) {
    for (std::int32_t ix = 0; ix < mapping::kWindowSide; ++ix) {
      const double x = (20 + ix + 0.5) * 0.015;
      mapping::WindowCell& cell =
          window->cells[static_cast<std::size_t>(iy * mapping::kWindowSide + ix)];
      cell.state = mapping::CellState::kMeasured;
      cell.height_m = 0.02F;
      cell.margin_cells = 3;
      cell.traversability = x > from_x_m && x < to_x_m ? mapping::Traversability::kUnsteppable
                                                       : mapping::Traversability::kSteppable;
    }
  }
  return window;
}

TEST(Footholds, FollowEquationsSevenToNine) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  VelocityCommand command;
  command.forward_m_s = 0.5;
  const Vector3 point = planner.nominal_O_m(robot::kFrontLeft, moving(), command, 0.1, 0.2, 0.05);
  // body + v t_touchdown + hip + v T/2 + k (v - v_command)
  EXPECT_NEAR(point[0], 1.0 + 0.04 + 0.19 + 0.04 - 0.003, 1e-12);
  EXPECT_NEAR(point[1], 0.2 + 0.111, 1e-12);
  EXPECT_NEAR(point[2], 0.05 + 0.0175, 1e-12);
}

TEST(Footholds, TheOffsetIsBoundedHoweverFastTheBodyIs) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  estimation::RobotState state = moving();
  state.v_OB_m_s = Vector3(10.0, -10.0, 0.0);
  const Vector3 point =
      planner.nominal_O_m(robot::kHindRight, state, VelocityCommand{}, 0.0, 0.2, 0.0);
  EXPECT_NEAR(point[0], 1.0 - 0.19 + 0.15, 1e-12);
  EXPECT_NEAR(point[1], 0.2 - 0.111 - 0.15, 1e-12);
}

TEST(Footholds, StayWhereTheGroundIsGoodAndTakeItsHeight) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(9.0, 9.1);
  const Foothold foothold = planner.choose(Vector3(1.0, 0.1, 0.5), window.get(), GroundRule::kGood);
  EXPECT_EQ(foothold.reason, FootholdReason::kNominal);
  EXPECT_EQ(foothold.position_O_m[0], 1.0);
  EXPECT_NEAR(foothold.position_O_m[2], 0.02 + 0.0175, 1e-6);
}

TEST(Footholds, MoveOffBadGroundByTheShorterWay) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.94, 1.02);
  const Foothold foothold = planner.choose(Vector3(1.0, 0.1, 0.0), window.get(), GroundRule::kGood);
  EXPECT_EQ(foothold.reason, FootholdReason::kMoved);
  EXPECT_GT(foothold.position_O_m[0], 1.02);
  EXPECT_LT(foothold.position_O_m[0], 1.05);
}

// A trot that has to catch itself may step on ground that nobody has seen, never on bad ground that
// was seen.
TEST(Footholds, GroundRuleIsTakenOnlyWhereAllowed) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.8, 1.2);
  const Foothold seen =
      planner.choose(Vector3(1.0, 0.1, 0.0), window.get(), GroundRule::kGoodOrUnseen);
  EXPECT_EQ(seen.reason, FootholdReason::kNone);
  const Foothold unseen =
      planner.choose(Vector3(9.0, 0.1, 0.0), window.get(), GroundRule::kGoodOrUnseen);
  EXPECT_EQ(unseen.reason, FootholdReason::kUnseen);
  EXPECT_EQ(unseen.position_O_m, Vector3(9.0, 0.1, 0.0));
}

// A foot drawn in to the edge of the seen ground would make the stance narrow.
TEST(Footholds, UnseenGroundThatIsAllowedIsNotLeftForSeenGroundBesideIt) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.0, 0.0);
  const Vector3 place(1.0, 0.1, 0.0);
  for (std::size_t i = 0; i < window->cells.size(); ++i) {
    const double x_m = (20.5 + static_cast<double>(i % mapping::kWindowSide)) * 0.015;
    if (x_m > 0.95) window->cells[i].traversability = mapping::Traversability::kUnknown;
  }
  EXPECT_EQ(planner.choose(place, window.get(), GroundRule::kGood).reason, FootholdReason::kMoved);
  const Foothold unseen = planner.choose(place, window.get(), GroundRule::kGoodOrUnseen);
  EXPECT_EQ(unseen.reason, FootholdReason::kUnseen);
  EXPECT_EQ(unseen.position_O_m, place);
}

// A body too fast for a leg to wait.
TEST(Footholds, BadGroundIsTakenOnlyWhereAStepIsDueAtAnyRate) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.8, 1.2);
  const Vector3 place(1.0, 0.1, 0.0);
  const Foothold bad = planner.choose(place, window.get(), GroundRule::kAny);
  EXPECT_EQ(bad.reason, FootholdReason::kForced);
  EXPECT_EQ(bad.position_O_m, place);
  EXPECT_EQ(planner.choose(Vector3(9.0, 0.1, 0.0), window.get(), GroundRule::kAny).reason,
            FootholdReason::kUnseen);
}

// A cell with a height and nothing around it: the map cannot say what it is.
TEST(Footholds, GroundThatIsNotClassedCountsAsUnseen) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.8, 1.2);
  for (mapping::WindowCell& cell : window->cells) {
    cell.traversability = mapping::Traversability::kUnknown;
  }
  const Vector3 place(1.0, 0.1, 0.0);
  EXPECT_EQ(planner.choose(place, window.get(), GroundRule::kGoodOrUnseen).reason,
            FootholdReason::kUnseen);
  EXPECT_EQ(planner.choose(place, window.get(), GroundRule::kGood).reason, FootholdReason::kNone);
}

TEST(Footholds, AreRefusedWhereNothingInReachBearsAFoot) {
  FootholdPlanner planner;
  planner.reset(config(), model());
  const auto window = window_with_band(0.8, 1.2);
  EXPECT_EQ(planner.choose(Vector3(1.0, 0.1, 0.0), window.get(), GroundRule::kGood).reason,
            FootholdReason::kNone);
  // Outside the window nothing is known.
  EXPECT_EQ(planner.choose(Vector3(9.0, 0.1, 0.0), window.get(), GroundRule::kGood).reason,
            FootholdReason::kNone);
  EXPECT_EQ(planner.choose(Vector3(1.0, 0.1, 0.0), nullptr, GroundRule::kGood).reason,
            FootholdReason::kMapOff);
}

}  // namespace
}  // namespace surefoot::control
