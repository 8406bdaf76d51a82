#include "apps/surefoot/can_replay_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "apps/common/run.h"
#include "core/actuation/joint_bus.h"
#include "core/autonomy/autonomy.h"
#include "core/estimation/estimator.h"
#include "core/math/gravity.h"
#include "hal/candump/candump_reader.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLegNames[] = {"FR", "FL", "HR", "HL"};
constexpr const char* kJointNames[] = {"abad", "hip", "knee"};
constexpr TimeNs kLongPause =
    milliseconds(1000);  // a longer one in the log is not filled with ticks

// The estimation path needs an IMU and a bus log has none: the trunk is taken as level and still.
class LevelEstimator {
 public:
  LevelEstimator(const fs::path& file, const Config& config) : out_(file), config_(config) {
    out_ << "time_s,x_O_m,y_O_m,z_O_m,vx_O_m_s,vy_O_m_s,vz_O_m_s";
    for (const char* leg : kLegNames) {
      out_ << fmt::format(",{0}_x_B_m,{0}_y_B_m,{0}_z_B_m,{0}_contact,{0}_force_z_N", leg);
    }
    out_ << "\n";
    estimator_.reset(config.autonomy.estimation, config.robot, autonomy::kTickPeriod.seconds());
  }

  void tick(TimeNs stamp, const actuation::JointStates& joints) {
    hal::ImuSample level;
    level.stamp = stamp;
    level.sequence = ++sequence_;
    level.specific_force_I_m_s2 = {0, 0, kGravity_m_s2};
    estimator_.update(stamp, {&level, 1}, joints, gait_, false);
    if (!estimator_.ready()) return;
    if (!placed_) estimator_.place(Vector3(0, 0, config_.autonomy.control.body.height_m));
    placed_ = true;
    const estimation::RobotState& state = estimator_.state();
    out_ << fmt::format("{:.6f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f}", stamp.seconds(),
                        state.p_OB_m[0], state.p_OB_m[1], state.p_OB_m[2], state.v_OB_m_s[0],
                        state.v_OB_m_s[1], state.v_OB_m_s[2]);
    for (const estimation::FootState& foot : state.feet) {
      out_ << fmt::format(",{:.5f},{:.5f},{:.5f},{},{:.2f}", foot.p_B_m[0], foot.p_B_m[1],
                          foot.p_B_m[2], foot.in_contact ? 1 : 0, foot.force_O_N[2]);
    }
    out_ << "\n";
  }

  bool close() {
    out_.close();
    return static_cast<bool>(out_);
  }

 private:
  std::ofstream out_;
  const Config& config_;
  estimation::Estimator estimator_;
  std::array<estimation::GaitPhase, robot::kLegs> gait_;
  std::uint32_t sequence_ = 0;
  bool placed_ = false;
};

// Frames to rows of joints.csv, and every 2 ms of the log to the estimator.
class Decoder {
 public:
  Decoder(const fs::path& folder, const Config& config)
      : config_(config),
        joints_(folder / "joints.csv"),
        estimator_(folder / "estimate.csv", config) {
    joints_ << "time_s,joint,name,position_rad,velocity_rad_s,torque_Nm\n";
  }

  Status configure() { return bus_.configure(config_.robot, config_.autonomy.actuation); }

  void take(hal::CanFrame frame) {
    if (!begun_) first_ = frame.stamp;
    begun_ = true;
    frame.stamp = frame.stamp - first_;  // from the log's begin
    if (frame.stamp - tick_end_ > kLongPause) tick_end_ = frame.stamp;
    while (frame.stamp >= tick_end_) end_tick();
    const std::uint64_t before = bus_.counters().replies;
    bus_.listen({&frame, 1});
    if (bus_.counters().replies != before) write_row(frame);
  }

  bool close() {
    if (begun_) end_tick();
    joints_.close();
    return static_cast<bool>(joints_) && estimator_.close();
  }

  const actuation::BusCounters& counters() const { return bus_.counters(); }

 private:
  void end_tick() {
    if (bus_.all_valid()) estimator_.tick(tick_end_, bus_.measured());
    tick_end_ = tick_end_ + autonomy::kTickPeriod;
  }

  void write_row(const hal::CanFrame& frame) {
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      const robot::JointWiring& wire = config_.robot.wiring[joint];
      if (wire.bus != frame.bus || wire.can_id != frame.data[0]) continue;
      const actuation::JointState& state = bus_.states()[joint];
      joints_ << fmt::format("{:.6f},{},{}_{},{:.9g},{:.9g},{:.9g}\n", frame.stamp.seconds(), joint,
                             kLegNames[joint / robot::kJointsPerLeg],
                             kJointNames[joint % robot::kJointsPerLeg], state.position_rad,
                             state.velocity_rad_s, state.torque_Nm);
    }
  }

  const Config& config_;
  std::ofstream joints_;
  LevelEstimator estimator_;
  actuation::JointBus bus_;
  bool begun_ = false;
  TimeNs first_;
  TimeNs tick_end_ = autonomy::kTickPeriod;
};

void report_issues(const std::string& log, const hal::CandumpReader& reader) {
  for (const hal::CandumpIssue& issue : reader.issues()) {
    std::fputs(fmt::format("{}:{}: malformed ({}), skipped\n", log, issue.line,
                           hal::to_string(issue.fault))
                   .c_str(),
               stderr);
  }
  const std::uint64_t malformed = reader.counters().malformed;
  if (malformed > reader.issues().size()) {
    std::fputs(fmt::format("{}: {} malformed lines in all\n", log, malformed).c_str(), stderr);
  }
}

}  // namespace

int can_replay(const std::string& log, const RunRequest& request, const fs::path& out) {
  ConfigIssues issues;
  const Config config = load_config_parts(request, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  std::ifstream file(log, std::ios::binary);
  if (!file) {
    std::fputs((log + ": cannot be read\n").c_str(), stderr);
    return 2;
  }
  const fs::path folder =
      out.empty() ? fs::path("out") / ("can-" + fs::path(log).stem().string()) : out;
  std::error_code error;
  fs::create_directories(folder, error);
  Decoder decoder(folder, config);
  if (const Status status = decoder.configure(); !ok(status)) {
    std::fputs(
        fmt::format("{}: the wiring is refused: {}\n", request.robot, to_string(status)).c_str(),
        stderr);
    return 2;
  }
  hal::CandumpReader reader(file);
  hal::CanFrame frame;
  while (ok(reader.next(frame))) decoder.take(frame);
  report_issues(log, reader);
  const bool written = decoder.close();
  const actuation::BusCounters& counters = decoder.counters();
  std::fputs(fmt::format("{} lines, {} frames: {} replies, {} commands, {} of unknown drives, "
                         "{} invalid, {} missed\n{}\n",
                         reader.counters().lines, reader.counters().frames, counters.replies,
                         counters.commands, counters.unknown, counters.invalid, counters.missed,
                         (folder / "joints.csv").string())
                 .c_str(),
             stdout);
  if (!written) {
    std::fputs((folder.string() + ": cannot be written\n").c_str(), stderr);
    return 3;
  }
  return reader.counters().frames > 0 ? 0 : 1;
}

}  // namespace surefoot::apps
