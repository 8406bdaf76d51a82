// The parts of jumping: the look for an edge, and a tick of a motion.
#include "core/autonomy/ledge.h"
#include "core/motions/jump.h"
#include "tests/support/jump_parts.h"
#include "tests/support/ledge_map.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

// All lines run to the end of the window, where they find the edge of a gap and its far side last.
class Look final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    window_ = tests::window_of(0.0, 0.0,
                               [](double x, double) { return x > 0.60 && x < 0.68 ? -0.3 : 0.0; });
    const apps::Config config = load({});
    query_.from_m = 0.0;
    query_.half_width_m = config.autonomy.jump_pilot.half_width_m;
    query_.min_rise_m = config.autonomy.jump_pilot.min_rise_m;
    query_.min_drop_m = config.autonomy.jump_pilot.min_drop_m;
    return true;
  }
  void run() override { found_ = autonomy::find_ledge(*window_, query_).ok(); }
  bool did_the_work() override { return found_; }

 private:
  std::unique_ptr<mapping::MapWindow> window_;
  autonomy::LedgeQuery query_;
  bool found_ = false;
};

// The last ticks of flight: the motion's row and four legs that reach for the ground.
class Flight final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    model_ = robot::full_mini_cheetah();
    motion_ = tests::small_motion();
    state_ = tests::robot_at(model_, -0.8, 1.6);
    jump_.reset(tests::jump_config(), model_, 0.29);
    jump_.begin(motion_, state_);
    for (int tick = 0; tick < 1000 && jump_.stage() != motions::JumpStage::kFlight; ++tick) {
      tests::follow(model_, jump_.update(state_, 0.002), state_);
      if (jump_.holds()) jump_.play();
    }
    for (int tick = 0; tick < 120; ++tick) jump_.update(state_, 0.002);
    return true;
  }
  void run() override { jump_.update(state_, 0.002); }
  bool did_the_work() override { return jump_.stage() == motions::JumpStage::kFlight; }

 private:
  robot::RobotModel model_;
  motions::Motion motion_;
  estimation::RobotState state_;
  motions::JumpController jump_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kJumpCases[] = {
    {"jump_look", "the look for an edge, 25 lines to the window's end", make<Look>},
    {"jump_flight", "a tick of a jump, four legs reach for the ground", make<Flight>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
