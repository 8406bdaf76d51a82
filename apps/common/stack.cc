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

Autonomy& of(void* self) { return *static_cast<Autonomy*>(self); }

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
  runtime::Task task;
  task.name = "mpc";
  task.period_ticks = autonomy::kMpcPeriodTicks;
  task.latency_ticks = autonomy::kMpcLatencyTicks;
  task.budget_us = kMpcBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) { return of(self).begin_mpc(inputs); };
  task.run = [](void* self) { of(self).run_mpc(); };
  task.publish = [](void* self, TickOutputs&) { of(self).publish_mpc(); };
  return task;
}

// Before mapping in the table, which takes what it publishes. A pair is asked for at most every
// stereo.least_interval_s.
runtime::Task stereo_task(Autonomy& autonomy) {
  runtime::Task task;
  task.name = "stereo";
  task.latency_ticks = autonomy::kStereoLatencyTicks;
  task.budget_us = kStereoBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) { return of(self).begin_stereo(inputs); };
  task.run = [](void* self) { of(self).run_stereo(); };
  task.publish = [](void* self, TickOutputs&) { of(self).publish_stereo(); };
  return task;
}

// Between stereo and mapping in the table: it takes what the one publishes, and the other takes
// what it publishes.
runtime::Task localisation_task(Autonomy& autonomy) {
  runtime::Task task;
  task.name = "localisation";
  task.latency_ticks = autonomy::kLocalisationLatencyTicks;
  task.budget_us = kLocalisationBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) {
    return of(self).begin_localisation(inputs);
  };
  task.run = [](void* self) { of(self).run_localisation(); };
  task.publish = [](void* self, TickOutputs&) { of(self).publish_localisation(); };
  return task;
}

// After control in the table: a frame is mapped with the pose history of the tick that brought it.
runtime::Task mapping_task(Autonomy& autonomy) {
  runtime::Task task;
  task.name = "mapping";
  task.latency_ticks = autonomy::kMapLatencyTicks;
  task.budget_us = kMappingBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) {
    return of(self).begin_mapping(inputs);
  };
  task.run = [](void* self) { of(self).run_mapping(); };
  task.publish = [](void* self, TickOutputs&) { of(self).publish_mapping(); };
  return task;
}

// After mapping in the table: it takes the window that is published in the same tick.
runtime::Task terrain_task(Autonomy& autonomy) {
  runtime::Task task;
  task.name = "terrain";
  task.latency_ticks = autonomy::kTerrainLatencyTicks;
  task.budget_us = kTerrainBudget_us;
  task.self = &autonomy;
  task.release = [](void* self, const TickInputs& inputs) {
    return of(self).begin_terrain(inputs);
  };
  task.run = [](void* self) { of(self).run_terrain(); };
  task.publish = [](void* self, TickOutputs&) { of(self).publish_terrain(); };
  return task;
}

}  // namespace

Status Stack::start(const Config& config, const hal::Board& board, runtime::SlowTaskRunner& runner,
                    runtime::TickObserver* observer) {
  const Status ready = autonomy_.reset(config.robot, config.autonomy);
  if (!ok(ready)) return ready;
  tasks_ = {control_task(autonomy_),      mpc_task(autonomy_),     stereo_task(autonomy_),
            localisation_task(autonomy_), mapping_task(autonomy_), terrain_task(autonomy_)};
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
