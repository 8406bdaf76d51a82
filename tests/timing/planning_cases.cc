// Footsteps: one plan of four steps with LittleDog's settings.
#include "core/base/assert.h"
#include "core/planning/footsteps.h"
#include "tests/support/rough_footsteps.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

class Footsteps : public WorkCase {
 public:
  void run() override { status_ = planner_.plan(problem_, *map_, plan_); }

 protected:
  void reset(const planning::FootstepConfig& config) {
    planner_.reset(config, model_, tests::footstep_shape());
  }

  robot::RobotModel model_ = robot::little_dog();
  planning::FootstepPlanner planner_;
  planning::FootstepProblem problem_;
  planning::FootstepPlan plan_;
  std::unique_ptr<terrain::TerrainMap> map_;
  Status status_ = Status::kNotFound;
};

class RoughGround final : public Footsteps {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    reset(tests::footstep_config());
    map_ = tests::rough_terrain(1);
    problem_ = tests::rough_problem(1, model_, *map_);
    return true;
  }
  bool did_the_work() override { return ok(status_) && plan_.steps.size() == 4; }
};

// Ground that gets better with the distance from every nominal place, so that each candidate is
// better than those before it, and legs that are short by most of their length, so that hardly any
// place is reached and none drops out for its cost.
class WorstGround : public Footsteps {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    lay_ground(0.0475, 0.0);
    return true;
  }
  bool did_the_work() override { return ok(status_) && plan_.steps.size() < 4; }

 protected:
  // With a wall of that height along the way, under the belly.
  void lay_ground(double reach_margin_m, double wall_m) {
    planning::FootstepConfig config = tests::footstep_config();
    config.deviation_scale_m = 1.0;
    config.terrain_weight_m = 1.0;
    config.reach_margin_m = reach_margin_m;
    reset(config);
    problem_.feet_O_m = tests::standing_feet(model_);
    problem_.stride_O_m = Vector2(0.06, 0.01);
    const planning::Hips hips =
        planning::stance_hips_O_m(model_, tests::footstep_shape().lateral_offset_m, 0.0);
    std::array<Vector3, robot::kLegs> places;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      places[leg] = planning::nominal_place_O_m(problem_.feet_O_m, hips, leg, problem_.stride_O_m);
    }
    map_ = tests::terrain_of([&](mapping::CellIndex i) {
      const Vector2 cell(mapping::cell_centre(i.ix, 0.01), mapping::cell_centre(i.iy, 0.01));
      double nearest_m = 0.15;
      for (const Vector3& place : places) {
        nearest_m = std::min(nearest_m, (cell - place.head<2>()).norm());
      }
      const double height_m = i.iy >= -2 && i.iy <= 2 ? wall_m : 0.0;
      return tests::GroundCell{.height_m = height_m, .cost = 0.7 - 0.7 / 0.15 * nearest_m};
    });
  }
};

// The same with good legs, and whatever the trunk does it is in the ground.
class CrowdedGround final : public WorstGround {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    lay_ground(0.004, 0.14);
    return true;
  }
  bool did_the_work() override { return ok(status_) && plan_.steps.size() == 4; }
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kPlanningCases[] = {
    {"footsteps_rough", "a plan of four steps on rough ground", make<RoughGround>},
    {"footsteps_worst", "every place dearer to test than the last, few in reach",
     make<WorstGround>},
    {"footsteps_crowded", "the same with all in reach and the trunk in the ground",
     make<CrowdedGround>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
