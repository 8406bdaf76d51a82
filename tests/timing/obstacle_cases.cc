// Obstacles: the most that a window and a full pool of fields can ask for.
#include "core/base/assert.h"
#include "core/obstacles/avoidance.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

// A window of steps, so that every cell is looked at with its whole neighbourhood before one lower
// is found or none; a full pool whose fields are all looked up and none lies near the last cells.
class ObstacleWindow final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({"obstacles.field_radius_m=0.01"});
    window_.cell_size_m = config.autonomy.mapping.cell_size_m;
    window_.first = {-mapping::kWindowSide / 2, -mapping::kWindowSide / 2};
    for (std::size_t i = 0; i < window_.cells.size(); ++i) {
      mapping::WindowCell& cell = window_.cells[i];
      cell.state = mapping::CellState::kMeasured;
      cell.traversability = mapping::Traversability::kSteppable;
      cell.height_m = 0.02F * static_cast<float>(i % mapping::kWindowSide);
    }
    block(0.5);
    pool_.reset(config.autonomy.obstacles);
    pool_.update(window_, {.jump_only = true, .min_rise_m = 0.12}, Vector2::Zero());
    return true;
  }
  void run() override {
    pool_.update(window_, {.jump_only = true, .min_rise_m = 0.12}, Vector2::Zero());
  }
  bool did_the_work() override {
    return pool_.fields().size() == obstacles::kMaxFields && pool_.counters().refused > 1000;
  }

 private:
  // Every second cell of the upper part.
  void block(double share) {
    const auto first = static_cast<std::size_t>(share * static_cast<double>(window_.cells.size()));
    for (std::size_t i = first; i < window_.cells.size(); i += 2) {
      window_.cells[i].traversability = mapping::Traversability::kImpassable;
    }
  }

  mapping::MapWindow window_;
  obstacles::FieldPool pool_;
};

// One tick of avoidance with 64 fields in reach, listed so that each look over them takes one more
// in before a side is chosen.
class AvoidanceTick final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({"obstacles.reach_m=5.0"});
    const double room_m = 0.23;
    for (std::size_t i = obstacles::kMaxFields; i-- > 0;) {
      const double y = 1.9 * room_m * static_cast<double>(i);
      SUREFOOT_ASSERT(ok(fields_.push_back({Vector2(0.7, y), 0})));
    }
    avoidance_.reset(config.autonomy.obstacles, {0.19, 0.13});
    return true;
  }
  void run() override {
    const obstacles::Wish wish{Vector2(0.4, 0.0), Vector2(1, 0), 0.0};
    velocity_ = avoidance_.velocity_O_m_s(fields_, {}, wish);
    free_m_ = avoidance_.free_space_m(fields_, {});
  }
  bool did_the_work() override { return avoidance_.side() == -1 && free_m_ < 1.0; }

 private:
  obstacles::Fields fields_;
  obstacles::Avoidance avoidance_;
  Vector2 velocity_ = Vector2::Zero();
  double free_m_ = 0;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kObstacleCases[] = {
    {"obstacles_window", "objects and fields of a window, pool full", make<ObstacleWindow>},
    {"obstacles_tick", "a velocity past 64 fields, a side chosen", make<AvoidanceTick>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
