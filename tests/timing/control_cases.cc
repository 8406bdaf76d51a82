// The control task as a whole.
#include <algorithm>

#include "core/base/assert.h"
#include "tests/timing/kinematic_robot.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

using autonomy::MissionPhase;

// Short waits: they take no work of interest, and the whole way up runs under callgrind.
std::vector<std::string> quick(const std::vector<std::string>& more) {
  // The kinematic robot's feet do not hold its trunk: what they say of the ground is not true.
  std::vector<std::string> sets{"mission.rest_s=0.1", "mission.settle_s=0.1",
                                "control.stand_up.fold_s=0.1", "control.stand_up.rise_s=0.2",
                                "control.foothold.max_map_offset_m=0.0"};
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

// A pad of 4 x 4 m: every cell of the window has a height and can bear a foot.
const std::vector<std::string> kLargePad{"start_pad.length_m=4.0", "start_pad.width_m=4.0"};

class Standing final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    SUREFOOT_ASSERT(robot_.reach(MissionPhase::kSettle, 500));
    for (int i = 0; i < 20; ++i) robot_.tick();
    robot_.prepare();
    return true;
  }
  void run() override { robot_.run(); }
  bool did_the_work() override {
    for (const estimation::FootState& foot : robot_.autonomy().estimator().state().feet) {
      if (!foot.in_contact) return false;
    }
    return true;
  }

 private:
  KinematicRobot robot_{load(quick(kLargePad))};
};

// A whole period of the trot, so that each leg lifts, swings and lands once.
class Trot final : public WorkCase {
 public:
  static constexpr std::size_t kPeriod_ticks = 150;

  bool prepare(std::size_t round) override {
    if (round == 0) {
      SUREFOOT_ASSERT(robot_.reach(MissionPhase::kWalk, 700));
      for (std::size_t i = 0; i < 2 * kPeriod_ticks; ++i) robot_.tick();
    } else {
      robot_.apply();
      count();
    }
    if (round == kPeriod_ticks) return false;
    robot_.prepare();
    return true;
  }
  void run() override { robot_.run(); }
  bool did_the_work() override {
    const bool walking = robot_.telemetry().phase == MissionPhase::kWalk;
    const auto moved = [](std::size_t ticks) { return ticks > 38 && ticks < 112; };
    return walking && std::all_of(swing_ticks_.begin(), swing_ticks_.end(), moved) &&
           std::all_of(contact_ticks_.begin(), contact_ticks_.end(), moved);
  }

 private:
  void count() {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const autonomy::LegTelemetry& telemetry = robot_.telemetry().legs[leg];
      swing_ticks_[leg] += telemetry.stance_planned ? 0u : 1u;
      contact_ticks_[leg] += telemetry.contact ? 1u : 0u;
    }
  }

  KinematicRobot robot_{load(quick(kLargePad))};
  std::array<std::size_t, robot::kLegs> swing_ticks_{};
  std::array<std::size_t, robot::kLegs> contact_ticks_{};
};

// The tick at which all four legs want to lift and the map has nothing for any of them within the
// largest radius; all feet stand, so that every leg costs the estimator its full update, and both
// input lists are full.
class AllLift final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const std::size_t tick = rehearse();
    for (std::size_t i = 0; i < tick; ++i) robot_.tick();
    robot_.prepare({autonomy::kMaxImuSamplesPerTick, autonomy::kMaxCanFramesPerTick});
    return true;
  }
  void run() override { robot_.run(); }
  bool did_the_work() override {
    robot_.apply();
    const auto& feet = robot_.autonomy().estimator().state().feet;
    const bool stand =
        std::all_of(feet.begin(), feet.end(), [](const auto& foot) { return foot.in_contact; });
    return stand && refused(robot_) == robot::kLegs;
  }

 private:
  static apps::Config config() {
    return load(quick({"start_pad.length_m=0.0", "start_pad.width_m=0.0",
                       "control.gaits.trot.offset=[0.0, 0.0, 0.0, 0.0]",
                       "control.foothold.search_radius_m=0.30"}));
  }
  static std::size_t refused(const KinematicRobot& robot) {
    const auto& legs = robot.telemetry().legs;
    return static_cast<std::size_t>(
        std::count_if(legs.begin(), legs.end(), [](const autonomy::LegTelemetry& leg) {
          return leg.foothold_reason == control::FootholdReason::kNone;
        }));
  }
  // A robot's twin says at which tick it happens.
  static std::size_t rehearse() {
    const auto twin = std::make_unique<KinematicRobot>(config());
    for (std::size_t tick = 0; tick < 1500; ++tick) {
      twin->tick();
      if (refused(*twin) > 0) return tick;
    }
    return 0;
  }

  KinematicRobot robot_{config()};
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kControlCases[] = {
    {"control_standing", "control task, four feet on the ground", make<Standing>},
    {"control_trot", "control task, 150 ticks: one period of the trot", make<Trot>},
    {"control_worst",
     "control task, four foothold searches without success, 64 CAN frames, 16 IMU samples",
     make<AllLift>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
