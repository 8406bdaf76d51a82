#include "apps/common/stack.h"

namespace surefoot::apps {

using autonomy::Autonomy;
using autonomy::TickInputs;
using autonomy::TickOutputs;

namespace {

// Budgets on the robot's computer; a campaign's summaries say what was used (docs/timing.md).
constexpr std::uint32_t kControlBudget_us = 1000;
constexpr std::uint32_t kMpcBudget_us = 1000;
constexpr std::uint32_t kMappingBudget_us = 10000;
constexpr std::uint32_t kStereoBudget_us = 120000;
constexpr std::uint32_t kLocalisationBudget_us = 40000;
constexpr std::uint32_t kTerrainBudget_us = 2000;  // a slice
constexpr std::uint32_t kObjectsBudget_us = 5000;
constexpr std::uint32_t kPlanningBudget_us = 50000;

Autonomy& of(void* self) { return *static_cast<Autonomy*>(self); }

using Release = bool (Autonomy::*)(const TickInputs&);
using Action = void (Autonomy::*)();

// Each of the autonomy's tasks has its three functions there.
template <Release kRelease, Action kRun, Action kPublish>
runtime::Task slow_task(Autonomy& autonomy, const char* name, std::uint32_t latency_ticks,
                        std::uint32_t budget_us) {
  runtime::Task task;
  task.name = name;
  task.latency_ticks = latency_ticks;
  task.budget_us = budget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) { return (of(self).*kRelease)(inputs); };
  task.run = [](void* self) { (of(self).*kRun)(); };
  task.publish = [](void* self, TickOutputs&) { (of(self).*kPublish)(); };
  return task;
}

runtime::Task control_task(Autonomy& autonomy) {
  runtime::Task task;
  task.name = "control";
  task.budget_us = kControlBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) {
    of(self).begin_control(inputs);
    return true;
  };
  task.run = [](void* self) { of(self).run_control(); };
  task.publish = [](void* self, TickOutputs& outputs) { of(self).publish_control(outputs); };
  return task;
}

// After control in the table: the problem is that of the tick's own state.
runtime::Task mpc_task(Autonomy& autonomy) {
  runtime::Task task = slow_task<&Autonomy::begin_mpc, &Autonomy::run_mpc, &Autonomy::publish_mpc>(
      autonomy, "mpc", autonomy::kMpcLatencyTicks, kMpcBudget_us);
  task.period_ticks = autonomy::kMpcPeriodTicks;
  return task;
}

// From here on in the order of the data's way: each takes what the one before publishes in the same
// tick. A pair is asked for at most every stereo.least_interval_s.
runtime::Task stereo_task(Autonomy& autonomy) {
  return slow_task<&Autonomy::begin_stereo, &Autonomy::run_stereo, &Autonomy::publish_stereo>(
      autonomy, "stereo", autonomy::kStereoLatencyTicks, kStereoBudget_us);
}

runtime::Task localisation_task(Autonomy& autonomy) {
  return slow_task<&Autonomy::begin_localisation, &Autonomy::run_localisation,
                   &Autonomy::publish_localisation>(
      autonomy, "localisation", autonomy::kLocalisationLatencyTicks, kLocalisationBudget_us);
}

// A frame is mapped with the pose history of the tick that brought it.
runtime::Task mapping_task(Autonomy& autonomy) {
  return slow_task<&Autonomy::begin_mapping, &Autonomy::run_mapping, &Autonomy::publish_mapping>(
      autonomy, "mapping", autonomy::kMapLatencyTicks, kMappingBudget_us);
}

runtime::Task terrain_task(Autonomy& autonomy) {
  return slow_task<&Autonomy::begin_terrain, &Autonomy::run_terrain, &Autonomy::publish_terrain>(
      autonomy, "terrain", autonomy::kTerrainLatencyTicks, kTerrainBudget_us);
}

runtime::Task objects_task(Autonomy& autonomy) {
  return slow_task<&Autonomy::begin_objects, &Autonomy::run_objects, &Autonomy::publish_objects>(
      autonomy, "objects", autonomy::kObjectsLatencyTicks, kObjectsBudget_us);
}

runtime::Task planning_task(Autonomy& autonomy) {
  runtime::Task task =
      slow_task<&Autonomy::begin_planning, &Autonomy::run_planning, &Autonomy::publish_planning>(
          autonomy, "planning", autonomy::kPlanningLatencyTicks, kPlanningBudget_us);
  task.period_ticks = autonomy::kPlanningPeriodTicks;
  return task;
}

}  // namespace

Status Stack::start(const Config& config, const hal::Board& board, runtime::SlowTaskRunner& runner,
                    runtime::TickObserver* observer) {
  const Status ready = autonomy_.reset(config.robot, config.autonomy);
  if (!ok(ready)) return ready;
  tasks_ = {control_task(autonomy_),      mpc_task(autonomy_),     stereo_task(autonomy_),
            localisation_task(autonomy_), mapping_task(autonomy_), terrain_task(autonomy_),
            objects_task(autonomy_),      planning_task(autonomy_)};
  runtime::ExecutiveSetup setup;
  setup.board = board;
  setup.tasks = tasks_;
  setup.period = autonomy::kTickPeriod;
  setup.runner = &runner;
  setup.observer = observer;
  return executive_.start(setup);
}

std::vector<MemoryRow> memory_table() {
  std::vector<MemoryRow> rows{
      {"runtime", sizeof(runtime::Executive)},
      {"mapping", sizeof(autonomy::MapTask)},
      {"stereo", sizeof(autonomy::StereoTask)},
      {"localisation", sizeof(autonomy::LocalisationTask)},
      {"terrain", sizeof(autonomy::TerrainTask)},
      {"estimation", sizeof(estimation::Estimator) + sizeof(autonomy::PoseHistory)},
      {"control", sizeof(control::Locomotion) + sizeof(control::StaticWalk) +
                      sizeof(control::StandUp) + sizeof(autonomy::MpcTask)},
      {"objects", sizeof(autonomy::ObjectTask)},
      {"navigation", sizeof(navigation::Navigator)},
      {"jumping", sizeof(autonomy::JumpPilot)},
      {"actuation", sizeof(actuation::JointBus)},
      {"mission", sizeof(autonomy::Mission)},
      {"configuration", sizeof(robot::RobotModel) + sizeof(autonomy::AutonomyConfig)},
  };
  std::size_t sum = 0;
  for (const MemoryRow& row : rows) sum += row.bytes;
  rows.push_back({"other", sizeof(Stack) - sum});
  rows.push_back({"total", sizeof(Stack)});
  return rows;
}

}  // namespace surefoot::apps
