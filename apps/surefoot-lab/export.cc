#include "apps/surefoot-lab/export.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <memory>

#include "apps/common/config_values.h"
#include "apps/common/run.h"
#include "apps/common/run_pictures.h"
#include "apps/common/summary.h"
#include "hal/candump/file_can_log.h"
#include "hal/record/record_reader.h"
#include "hal/replay/replay_board.h"

namespace surefoot::apps {
namespace {

namespace fs = std::filesystem;

// Names or values of a struct's scalars, in the order of its fields.
class CsvRow : public FieldVisitor<CsvRow> {
 public:
  enum class What : std::uint8_t { kNames, kValues };
  explicit CsvRow(What what) : what_(what) {}

  template <class T>
  void scalar(const char* name, const T& value) {
    if (!out_.empty()) out_ += ",";
    if (what_ == What::kNames) {
      // An item of a list has no name of its own: its path ends with the index and a dot.
      const bool unnamed = *name == '\0' && !path_.empty();
      out_ += unnamed ? path_.substr(0, path_.size() - 1) : path_ + name;
    } else if constexpr (std::is_floating_point_v<T>) {
      out_ += number_text(static_cast<double>(value));
    } else if constexpr (std::is_enum_v<T>) {
      out_ += std::to_string(static_cast<int>(value));
    } else {
      out_ += std::to_string(value);
    }
  }
  void enter(const char* name) {
    lengths_.push_back(path_.size());
    path_ += std::string(name) + ".";
  }
  void leave() { pop(); }
  void enter_index(std::size_t index) {
    lengths_.push_back(path_.size());
    path_ += std::to_string(index) + ".";
  }
  void leave_index() { pop(); }
  std::string text() const { return out_; }

 private:
  void pop() {
    path_.resize(lengths_.back());
    lengths_.pop_back();
  }

  What what_;
  std::string path_;
  std::string out_;
  std::vector<std::size_t> lengths_;
};

std::string csv_text(const autonomy::Telemetry& telemetry, CsvRow::What what) {
  CsvRow row(what);
  row.members(telemetry);
  return row.text();
}

// Calls visit(tick) for every tick of the record. False: the record is damaged somewhere.
template <class Visit>
bool for_every_tick(hal::RecordReader& reader, Visit&& visit) {
  hal::RecordMessage message;
  auto tick = std::make_unique<runtime::TickRecord>();
  for (;;) {
    const Status status = reader.next(message);
    if (status == Status::kEndOfData) return reader.damages() == 0;
    if (!ok(status) || message.channel != hal::RecordChannel::kTick) continue;
    if (ok(runtime::decode_tick(message.bytes, *tick))) visit(*tick);
  }
}

int to_candump(hal::RecordReader& reader, const fs::path& file) {
  hal::FileCanLog log(file.string());
  bool written = true;
  const auto write = [&](const hal::CanFrame& frame, TimeNs stamp) {
    written = ok(log.write(frame, stamp)) && written;
  };
  const bool complete = for_every_tick(reader, [&](const runtime::TickRecord& tick) {
    for (const hal::CanFrame& frame : tick.inputs.can) write(frame, frame.stamp);
    for (const hal::CanFrame& frame : tick.outputs.can) write(frame, tick.inputs.stamp);
  });
  if (!ok(log.flush()) || !written) return 3;
  return complete ? 0 : 1;
}

int to_csv(hal::RecordReader& reader, const fs::path& file) {
  std::ofstream out(file);
  bool first = true;
  const bool complete = for_every_tick(reader, [&](const runtime::TickRecord& tick) {
    const autonomy::Telemetry& telemetry = tick.outputs.telemetry;
    if (first) out << "tick,time_s," << csv_text(telemetry, CsvRow::What::kNames) << "\n";
    first = false;
    out << tick.inputs.tick << "," << number_text(tick.inputs.stamp.seconds()) << ","
        << csv_text(telemetry, CsvRow::What::kValues) << "\n";
  });
  out.close();
  if (!out) return 3;
  return complete ? 0 : 1;
}

// Replays the record: the map is not stored in it, but made again.
int to_html(const std::string& record, const fs::path& folder, Stack& stack) {
  hal::ReplayBoard board;
  if (!ok(board.open(record))) {
    std::fputs((board.message() + "\n").c_str(), stderr);
    return 2;
  }
  RunFacts facts;
  Config config;
  ConfigIssues issues;
  read_record_text(board.configuration(), facts.request, config, issues);
  if (!issues.empty()) return refuse(issues);
  runtime::RecordedRunner runner(nullptr, board.overruns());
  if (!ok(stack.start(config, board.board(autonomy::kTickPeriod), runner, nullptr))) return 2;
  constexpr std::uint64_t kEvery = 4;
  const double timeout_s = config.autonomy.mission.timeout_s;
  RunLog log(static_cast<std::size_t>((timeout_s + 5) / autonomy::kTickPeriod.seconds()) / kEvery,
             false);
  PlanLog plans;
  const runtime::Executive& executive = stack.executive();
  while (ok(stack.executive().run_tick())) {
    plans.observe(executive.inputs().stamp, stack.autonomy());
    if (executive.ticks() % kEvery != 0) continue;
    log.add(executive.inputs().stamp, executive.outputs().telemetry, nullptr);
  }
  const autonomy::Telemetry& last = executive.outputs().telemetry;
  facts.verdict = {
      last.phase == autonomy::MissionPhase::kArrived ? Outcome::kGoal : Outcome::kAborted,
      "from the record, without ground truth"};
  facts.config_hash = config_hash(config);
  facts.measures = measure(log, goal_x_m(config), course_m(config));
  facts.ticks = executive.ticks();
  facts.hash = executive.hash();
  facts.sim_time_s = static_cast<double>(facts.ticks) * autonomy::kTickPeriod.seconds();
  facts.static_bytes = memory_table().back().bytes;
  std::string problem;
  const auto pictures = run_pictures(log, config, stack.autonomy().map().mapper(), TrueGround{}, {},
                                     plans.samples(), {});
  if (!write_report(folder, facts, pictures, config_text(config), problem)) {
    std::fputs((problem + "\n").c_str(), stderr);
    return 3;
  }
  return board.end() == hal::ReplayEnd::kComplete ? 0 : 1;
}

}  // namespace

int export_record(const std::string& record, const std::string& to, const fs::path& out,
                  Stack& stack) {
  const fs::path folder = out.empty() ? fs::path(record).parent_path() : out;
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (to == "html") return to_html(record, folder, stack);
  hal::RecordReader reader;
  if (!ok(reader.open(record))) {
    std::fputs(fmt::format("{}: {}\n", record, reader.damage().reason).c_str(), stderr);
    return 2;
  }
  const fs::path file = folder / (to == "csv" ? "ticks.csv" : "can.log");
  try {
    const int code = to == "csv" ? to_csv(reader, file) : to_candump(reader, file);
    if (code == 1) {
      std::fputs(fmt::format("{}: damaged at byte {}: {}\n", record, reader.damage().offset,
                             reader.damage().reason)
                     .c_str(),
                 stderr);
    }
    if (code == 3) std::fputs((file.string() + ": cannot be written\n").c_str(), stderr);
    if (code != 3) std::fputs((file.string() + "\n").c_str(), stdout);
    return code;
  } catch (const std::exception& problem) {
    std::fputs((std::string(problem.what()) + "\n").c_str(), stderr);
    return 3;
  }
}

}  // namespace surefoot::apps
