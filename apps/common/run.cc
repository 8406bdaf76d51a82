#include "apps/common/run.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include "apps/common/backend.h"
#include "apps/common/perceived_map.h"
#include "apps/common/plan_log.h"
#include "apps/common/progress.h"
#include "apps/common/report.h"
#include "apps/common/run_loop.h"
#include "apps/common/run_pictures.h"
#include "apps/common/summary.h"
#include "hal/candump/file_can_log.h"
#include "hal/linux/clocks.h"
#include "hal/linux/memory_guard.h"
#include "hal/linux/memory_lock.h"
#include "hal/record/record_writer.h"
#include "hal/replay/surefoot_record.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

// Ticks that count as start-up: they fault in code that nothing has touched before.
constexpr std::uint64_t kWarmUpTicks = 50;
// Mission navigate: at the goal is who stands within what it was told, a step, and the drift of
// dead reckoning on the way.
constexpr double kGoalSlack_m = 0.3;
constexpr double kDrift = 0.015;
constexpr double kCorridorHalfWidth_m = 0.25;  // of the map's error: a little wider than the feet

// out/WORLD-MISSION-sSEED, with -2, -3 … behind where it exists.
fs::path new_folder(const RunRequest& request) {
  std::string name = request.world.substr(0, request.world.find_first_of(":/."));
  if (name.empty()) name = "run";
  const fs::path base =
      fs::path("out") /
      fmt::format("{}-{}-s{}", name, fs::path(request.mission).stem().string(), request.seed);
  fs::path folder = base;
  for (int i = 2; fs::exists(folder); ++i) folder = fmt::format("{}-{}", base.string(), i);
  return folder;
}

bool navigates(const Config& config) {
  return config.autonomy.mission.kind == autonomy::MissionConfig::Kind::kNavigate;
}

RefereeRules rules_for(const Config& config, bool has_truth) {
  RefereeRules rules;
  rules.has_truth = has_truth;
  rules.has_goal = goal_x_m(config) >= 0;
  rules.goal_x_m = goal_x_m(config);
  rules.may_recover = config.autonomy.mission.recover;
  rules.lane_half_width_m = lane_half_width_m(config);
  if (navigates(config)) {
    rules.goal_tolerance_m = config.autonomy.navigation.planner.follow.arrive_m + kGoalSlack_m +
                             kDrift * config.autonomy.mission.goal_x_m;
  }
  return rules;
}

// Everything a run needs beside the stack, in the order it is set up.
class Run {
 public:
  Run(const RunOptions& options, const Config& config, Stack& stack)
      : options_(options),
        config_(config),
        stack_(stack),
        runner_(&stopwatch_),
        guard_(kWarmUpTicks) {}

  // Throws std::runtime_error: a file cannot be written. BackendError: wrong configuration.
  void set_up() {
    folder_ = options_.out.empty() ? new_folder(options_.request) : options_.out;
    backend_ = make_backend(options_.request, config_);
    fs::create_directories(folder_);
    hal::Board board = backend_->board();
    board.stopwatch = &stopwatch_;
    if (!navigates(config_)) board.lidar = nullptr;  // nobody would look at it
    if (options_.record) board.record = open_record();
    if (options_.can_log && board.can != nullptr) {
      can_log_ = std::make_unique<hal::FileCanLog>((folder_ / "can.log").string());
      can_port_.emplace(*board.can, *board.clock, *can_log_);
      board.can = &*can_port_;
    }
    const double timeout_s = config_.autonomy.mission.timeout_s;
    max_ticks_ = static_cast<std::uint64_t>((timeout_s + 5.0) / autonomy::kTickPeriod.seconds());
    log_ = std::make_unique<RunLog>(max_ticks_ / kTicksPerSample + 2, backend_->has_truth());
    const Status status = stack_.start(config_, board, runner_, &guard_);
    if (!ok(status)) {
      throw BackendError(
          fmt::format("the autonomy refuses the configuration: {}", to_string(status)));
    }
  }

  Outcome execute() {
    Referee referee(rules_for(config_, backend_->has_truth()));
    Progress progress(options_.quiet);
    block_signals();
    hal::lock_memory();
    const LoopResult loop = run_loop(stack_, *backend_, {*log_, plans_, referee, progress},
                                     max_ticks_, options_.realtime);
    progress.finish();
    collect(referee, loop);
    return facts_.verdict.outcome;
  }

  // Throws std::runtime_error.
  void write() {
    if (options_.record && !ok(record_.close())) throw std::runtime_error(record_.error());
    if (can_log_ != nullptr && !ok(can_log_->flush())) {
      throw std::runtime_error("can.log could not be written");
    }
    std::ofstream file(folder_ / "summary.json");
    file << summary_json(facts_).dump(2) << "\n";
    file.close();
    if (!file)
      throw std::runtime_error((folder_ / "summary.json").string() + ": cannot be written");
    if (draws()) draw();
  }

  void print_verdict() const {
    const RunMeasures& m = facts_.measures;
    std::fputs(
        fmt::format("{}: {}\n  {:.2f} m at {:.2f} m/s, drift {:.2f} %, map error {:.1f} mm, "
                    "{:.1f} x real time, hash {}\n  {}\n",
                    to_string(facts_.verdict.outcome), facts_.verdict.reason, m.path_length_m,
                    m.mean_speed_m_s, m.estimate.drift_percent, 1000 * facts_.map.rmse_m,
                    facts_.sim_time_s / std::max(1e-9, facts_.wall_time_s), hex16(facts_.hash),
                    (folder_ / (draws() ? "report.html" : "summary.json")).string())
            .c_str(),
        stdout);
  }

 private:
  bool draws() const {
    return options_.report == Keep::kAlways ||
           (options_.report == Keep::kFailures && facts_.verdict.outcome != Outcome::kGoal);
  }

  hal::RecordSink* open_record() {
    if (!ok(record_.open((folder_ / "record.mcap").string(), hal::surefoot_record_layout()))) {
      throw std::runtime_error(record_.error());
    }
    const std::string text = record_text(options_.request, config_);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    if (!ok(record_.write(hal::RecordChannel::kConfiguration, TimeNs{}, {bytes, text.size()}))) {
      throw std::runtime_error("record.mcap: the configuration could not be stored");
    }
    return &record_;
  }

  void collect(const Referee& referee, const LoopResult& loop) {
    const runtime::Executive& executive = stack_.executive();
    facts_.request = options_.request;
    facts_.config_hash = config_hash(config_);
    facts_.verdict = referee.verdict();
    if (loop.interrupted) facts_.verdict = {Outcome::kAborted, "interrupted"};
    if (!ok(loop.status)) facts_.verdict = {Outcome::kFault, to_string(loop.status)};
    facts_.falls = referee.falls();
    facts_.sim_time_s = static_cast<double>(executive.ticks()) * autonomy::kTickPeriod.seconds();
    facts_.wall_time_s = loop.wall_time_s;
    facts_.measures = measure(*log_, goal_x_m(config_), course_m(config_));
    facts_.measures.recovery = recovery_figures();
    facts_.jump = measure_jumps(*log_, torque_limits_Nm());
    if (facts_.verdict.outcome == Outcome::kNoPath && facts_.jump.refusals > 0) {
      facts_.verdict.reason += fmt::format(" ({})", facts_.jump.last_refusal);
    }
    if (facts_.verdict.outcome == Outcome::kGoal && facts_.jump.landed_feet < 4) {
      facts_.verdict = {Outcome::kFall,
                        fmt::format("arrived, but landed on {} feet", facts_.jump.landed_feet)};
    }
    facts_.terrain = backend_->terrain();
    if (backend_->has_truth()) {
      facts_.map = map_error(stack_.autonomy().map().mapper(), align_at_start(*log_), *log_,
                             ground(), kCorridorHalfWidth_m);
    }
    facts_.static_bytes = memory_table().back().bytes;
    facts_.heap_calls = guard_.counts().heap_calls;
    facts_.page_faults = guard_.counts().page_faults;
    for (std::size_t i = 0; i < executive.task_count(); ++i) {
      facts_.tasks.push_back(executive.task_report(i));
    }
    facts_.tasks.push_back(executive.tick_report());
    facts_.ticks = executive.ticks();
    facts_.hash = executive.hash();
    facts_.samples_dropped = log_->dropped();
    facts_.counters = executive.counters();
    facts_.map_frames_bounded = stack_.autonomy().map().counters().frames_bounded;
    facts_.stereo = executive.outputs().telemetry.stereo;
    facts_.stereo.valid_share = stack_.autonomy().stereo().mean_valid_share();
    facts_.visual_odometry = executive.outputs().telemetry.visual_odometry;
    facts_.localisation = stack_.autonomy().localisation().counters();
    facts_.fill = stack_.autonomy().terrain().counters();
    facts_.static_walk = stack_.autonomy().static_walk().counters();
    facts_.navigation = executive.outputs().telemetry.navigation;
    facts_.least_clearance_m = least_clearance_m(*log_);
    facts_.plant = backend_->plant();
    facts_.tracking = stack_.autonomy().estimator().drift().counters();
  }

  std::array<double, robot::kJoints> torque_limits_Nm() const {
    std::array<double, robot::kJoints> limit_Nm{};
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      limit_Nm[i] = config_.robot.actuators[i % robot::kJointsPerLeg].torque_limit_Nm;
    }
    return limit_Nm;
  }

  RecoveryFigures recovery_figures() const {
    const double height_m = config_.autonomy.control.body.height_m - config_.robot.foot_radius_m;
    return measure_recovery(*log_, height_m, torque_limits_Nm());
  }

  TrueGround ground() const {
    return [this](double x, double y) { return backend_->ground_m(x, y); };
  }

  void draw() const {
    const mapping::Mapper& mapper = stack_.autonomy().map().mapper();
    const TrueGround true_ground = backend_->has_truth() ? ground() : TrueGround{};
    std::string problem;
    if (!write_report(folder_, facts_,
                      run_pictures(*log_, config_, mapper, true_ground, backend_->solids(),
                                   plans_.samples(), facts_.tasks),
                      config_text(config_), problem)) {
      throw std::runtime_error(problem);
    }
  }

  const RunOptions& options_;
  const Config& config_;
  Stack& stack_;
  fs::path folder_;
  hal::MonotonicClock stopwatch_;
  runtime::InlineRunner runner_;
  hal::TickMemoryGuard guard_;
  std::unique_ptr<Backend> backend_;
  hal::RecordWriter record_;
  std::unique_ptr<hal::FileCanLog> can_log_;
  std::optional<hal::LoggedCanPort> can_port_;
  std::unique_ptr<RunLog> log_;
  PlanLog plans_;
  std::uint64_t max_ticks_ = 0;
  RunFacts facts_;
};

}  // namespace

int refuse(const ConfigIssues& issues) {
  std::fputs(to_string(issues).c_str(), stderr);
  return 2;
}

int run(const RunOptions& options, Stack& stack) {
  ConfigIssues issues;
  const Config config = load_config(options.request, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  try {
    Run run(options, config, stack);
    run.set_up();
    const Outcome outcome = run.execute();
    run.write();
    if (!options.quiet) run.print_verdict();
    return exit_code(outcome);
  } catch (const BackendError& error) {
    std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
    return 2;
  } catch (const std::exception& error) {
    std::fputs((std::string("surefoot: ") + error.what() + "\n").c_str(), stderr);
    return 3;
  }
}

}  // namespace surefoot::apps
