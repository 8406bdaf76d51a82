// The program that runs on the robot: run, replay, can-replay, check, info.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "apps/common/backend.h"
#include "apps/common/config_root.h"
#include "apps/common/run.h"
#include "apps/common/stack.h"
#include "apps/common/version.h"
#include "apps/surefoot/can_replay_command.h"
#include "apps/surefoot/replay_command.h"

namespace surefoot::apps {
namespace {

int check(const RunRequest& request) {
  if (request.robot.empty() && request.world.empty() && request.mission.empty()) {
    std::fputs("check: give --robot, --world or --mission\n", stderr);
    return 2;
  }
  ConfigIssues issues;
  load_config_parts(request, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  std::puts("configuration is valid");
  return 0;
}

int info() {
  std::string text =
      fmt::format("surefoot {}\nbuild     {}\nbackends ", version_text(), build_text());
  for (const std::string& name : backend_names()) text += " " + name;
  text += fmt::format(" replay\nconfig    {}\n\nstatic memory of the autonomy\n",
                      config_folder().string());
  for (const MemoryRow& row : memory_table()) {
    text += fmt::format("  {:<14} {:>12} bytes\n", row.module, row.bytes);
  }
  std::fputs(text.c_str(), stdout);
  return 0;
}

struct Arguments {
  RunOptions run;
  std::string record = "on";
  std::string report = "on";
  std::string input;  // of replay and can-replay
};

void add_set(CLI::App* command, RunRequest& request) {
  command->add_option("--set", request.sets, "key=value, any key of the configuration")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

CLI::App* add_run(CLI::App& app, Arguments& arguments) {
  RunRequest& request = arguments.run.request;
  CLI::App* command =
      app.add_subcommand("run", "one run; exit 0 when the mission reached its goal");
  command->add_option("--robot", request.robot, "name in config/robots, or a file")->required();
  command
      ->add_option("--world", request.world,
                   "name in config/worlds[:parameter=value,...], or a file")
      ->required();
  command->add_option("--mission", request.mission, "name in config/missions, or a file")
      ->required();
  command->add_option("--hal", request.hal, "backend")->capture_default_str();
  command->add_option("--seed", request.seed, "decides every draw")->capture_default_str();
  command->add_option("--out", arguments.run.out, "folder for the results");
  command->add_option("--record", arguments.record, "write record.mcap")
      ->check(CLI::IsMember({"on", "off"}));
  command->add_option("--report", arguments.report, "write report.html and pictures")
      ->check(CLI::IsMember({"on", "off", "failures"}));
  command->add_flag("--can-log", arguments.run.can_log, "write can.log (candump -L)");
  command->add_flag("--realtime", arguments.run.realtime, "hold the simulation to real time");
  command->add_flag("--quiet", arguments.run.quiet, "no progress");
  add_set(command, request);
  return command;
}

CLI::App* add_check(CLI::App& app, Arguments& arguments) {
  RunRequest& request = arguments.run.request;
  CLI::App* command =
      app.add_subcommand("check", "validates configuration; exit 2 when it is wrong");
  command->add_option("--robot", request.robot, "name or file");
  command->add_option("--world", request.world, "name or file");
  command->add_option("--mission", request.mission, "name or file");
  add_set(command, request);
  return command;
}

int dispatch(int argc, char** argv, Stack& stack) {
  CLI::App app("On-board software of a walking robot. Manual: docs/running.md");
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());
  Arguments arguments;
  CLI::App* run_command = add_run(app, arguments);
  CLI::App* check_command = add_check(app, arguments);
  CLI::App* info_command = app.add_subcommand("info", "version, backends, static memory");
  CLI::App* replay_command = app.add_subcommand("replay", "feeds a record back and compares");
  replay_command->add_option("RECORD", arguments.input, "record.mcap of a run")->required();
  replay_command->add_option("--out", arguments.run.out, "folder for replay.json");
  CLI::App* can_command =
      app.add_subcommand("can-replay", "decodes a candump -L log of a robot's buses");
  can_command->add_option("LOG", arguments.input, "candump -L text")->required();
  can_command->add_option("--robot", arguments.run.request.robot, "name or file")->required();
  can_command->add_option("--out", arguments.run.out, "folder for joints.csv");
  add_set(can_command, arguments.run.request);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  arguments.run.record = arguments.record == "on";
  arguments.run.report = arguments.report == "on"    ? Keep::kAlways
                         : arguments.report == "off" ? Keep::kNever
                                                     : Keep::kFailures;
  if (run_command->parsed()) return run(arguments.run, stack);
  if (check_command->parsed()) return check(arguments.run.request);
  if (info_command->parsed()) return info();
  if (replay_command->parsed()) return replay(arguments.input, arguments.run.out, stack);
  return can_command->parsed()
             ? can_replay(arguments.input, arguments.run.request, arguments.run.out)
             : 2;
}

}  // namespace
}  // namespace surefoot::apps

int main(int argc, char** argv) {
  static surefoot::apps::Stack stack;  // .bss: all state of the autonomy
  return surefoot::apps::dispatch(argc, argv, stack);
}
