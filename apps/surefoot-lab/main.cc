// Campaigns, benchmarks and conversions around the surefoot binary.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "apps/common/version.h"
#include "apps/surefoot-lab/bench.h"
#include "apps/surefoot-lab/campaign.h"
#include "apps/surefoot-lab/eval_registration.h"
#include "apps/surefoot-lab/eval_terrain_fill.h"
#include "apps/surefoot-lab/eval_traversability.h"
#include "apps/surefoot-lab/export.h"
#include "apps/surefoot-lab/jump/motion_command.h"
#include "apps/surefoot-lab/learn_terrain.h"
#include "sim_hal/world/rock_field.h"

namespace surefoot::apps {
namespace {

struct Arguments {
  CampaignOptions campaign;
  std::string seeds;
  std::string input;
  std::string to;
  std::string bench_name;
  std::filesystem::path out;
  MotionOptions motion;
  TraversabilityOptions traversability;
  RegistrationOptions registration;
  TerrainFillOptions terrain_fill;
  LearnTerrainOptions learn_terrain;
  std::string library_seeds;
  std::string test_seeds;
};

struct EvalCommands {
  CLI::App* traversability = nullptr;
  CLI::App* registration = nullptr;
  CLI::App* terrain_fill = nullptr;
};

CLI::App* add_campaign(CLI::App& app, Arguments& arguments) {
  RunRequest& request = arguments.campaign.request;
  CLI::App* command = app.add_subcommand("campaign", "many runs; writes campaign.json");
  command->add_option("--robot", request.robot, "name or file")->required();
  command->add_option("--world", request.world, "name[:parameters] or file")->required();
  command->add_option("--mission", request.mission, "name or file")->required();
  command->add_option("--hal", request.hal, "backend")->capture_default_str();
  command->add_option("--seeds", arguments.seeds, "A..B, both included")->required();
  command->add_option("--jobs", arguments.campaign.jobs, "runs at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--out", arguments.out, "folder for the results");
  command->add_option("--record", arguments.campaign.record, "whose record is kept")
      ->check(CLI::IsMember({"off", "failures", "all"}))
      ->capture_default_str();
  command->add_option("--set", request.sets, "key=value, any key of the configuration")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  return command;
}

CLI::App* add_eval_registration(CLI::App& eval, Arguments& arguments) {
  CLI::App* command = eval.add_subcommand(
      "registration", "alignment of synthetic rocky boards; JSON and a picture");
  RegistrationOptions& options = arguments.registration;
  arguments.seeds = "1..10";
  command->add_option("--seeds", arguments.seeds, "A..B, both included")->capture_default_str();
  command->add_option("--points", options.points, "of each scan")
      ->check(CLI::Range(100, 200000))
      ->capture_default_str();
  command->add_option("--slope", options.slope, "of the board")
      ->check(CLI::Range(-1.0, 1.0))
      ->capture_default_str();
  command->add_option("--out", options.out, "folder for the results");
  return command;
}

CLI::App* add_eval_terrain_fill(CLI::App& eval, Arguments& arguments) {
  CLI::App* command =
      eval.add_subcommand("terrain-fill", "fills of unseen rocks compared; JSON and pictures");
  TerrainFillOptions& options = arguments.terrain_fill;
  arguments.library_seeds = "1..10";
  arguments.test_seeds = "11..20";
  command->add_option("--library-seeds", arguments.library_seeds, "A..B, what is learned from")
      ->capture_default_str();
  command->add_option("--test-seeds", arguments.test_seeds, "C..D, what is filled")
      ->capture_default_str();
  command->add_option("--resolution", options.resolution_m, "side of a cell, m")
      ->capture_default_str();
  command->add_option("--noise", options.noise_m, "standard deviation of heights and ceilings, m")
      ->check(CLI::Range(0.0, 0.1))
      ->capture_default_str();
  command->add_option("--jobs", options.jobs, "terrains at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--bodies", options.bodies, "rocks of a generated square metre")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  command->add_option(
      "--terrain", options.terrain,
      "recorded grid (.asc, .png) to take library and tests from, instead of rocks");
  command->add_option("--scale", options.scale, "of the recorded grid")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  command->add_flag("!--gaps-unknown", options.bridge_gaps,
                    "leaves the recorded grid's gaps unknown instead of bridging them");
  command->add_option("--cache", options.cache, "folder that keeps generated terrain")
      ->capture_default_str();
  command->add_option("--out", options.out, "folder for the results");
  return command;
}

EvalCommands add_eval(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand("eval", "experiments on data");
  command->require_subcommand(1);
  CLI::App* classes = command->add_subcommand(
      "traversability", "height filter and classes of a height grid; JSON and a picture");
  TraversabilityOptions& options = arguments.traversability;
  classes->add_option("FILE", options.file, "ESRI ASCII grid (.asc) or 16-bit PNG")->required();
  classes->add_option("--robot", options.robot, "name or file")->required();
  classes->add_option("--scale", options.scale, "of lengths and heights")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  classes->add_option("--out", options.out, "folder for the results");
  return {classes, add_eval_registration(*command, arguments),
          add_eval_terrain_fill(*command, arguments)};
}

CLI::App* add_learn(CLI::App& app, Arguments& arguments) {
  LearnTerrainOptions& options = arguments.learn_terrain;
  CLI::App* command = app.add_subcommand("learn", "what a robot takes along");
  command->require_subcommand(1);
  CLI::App* terrain = command->add_subcommand("terrain", "rocks and the prior of unseen ground");
  terrain->add_option("--robot", options.robot, "name or file")->required();
  terrain->add_option("--seeds", arguments.seeds, "A..B, of the generated rocks")->required();
  terrain->add_option("--out", options.out, "file")->required();
  terrain->add_option("--jobs", options.jobs, "rock fields made at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  return terrain;
}

int run_learn_terrain(Arguments& arguments) {
  const auto seeds = parse_seeds(arguments.seeds);
  if (!seeds) {
    std::fputs(fmt::format("--seeds: '{}' is not A..B\n", arguments.seeds).c_str(), stderr);
    return 2;
  }
  arguments.learn_terrain.first_seed = seeds->first;
  arguments.learn_terrain.last_seed = seeds->last;
  arguments.learn_terrain.cache = sim::rock_cache_folder();
  return learn_terrain(arguments.learn_terrain);
}

int run_campaign(Arguments& arguments) {
  const auto seeds = parse_seeds(arguments.seeds);
  if (!seeds) {
    std::fputs(fmt::format("--seeds: '{}' is not A..B\n", arguments.seeds).c_str(), stderr);
    return 2;
  }
  arguments.campaign.seeds = *seeds;
  arguments.campaign.out = arguments.out;
  return campaign(arguments.campaign);
}

int run_eval_registration(Arguments& arguments) {
  const auto seeds = parse_seeds(arguments.seeds);
  if (!seeds) {
    std::fputs(fmt::format("--seeds: '{}' is not A..B\n", arguments.seeds).c_str(), stderr);
    return 2;
  }
  arguments.registration.first_seed = seeds->first;
  arguments.registration.last_seed = seeds->last;
  return eval_registration(arguments.registration);
}

int run_eval_terrain_fill(Arguments& arguments) {
  TerrainFillOptions& options = arguments.terrain_fill;
  const auto library = parse_seeds(arguments.library_seeds);
  const auto test = parse_seeds(arguments.test_seeds);
  if (!library || !test) {
    std::fputs("--library-seeds, --test-seeds: not A..B\n", stderr);
    return 2;
  }
  options.first_library_seed = library->first;
  options.last_library_seed = library->last;
  options.first_test_seed = test->first;
  options.last_test_seed = test->last;
  return eval_terrain_fill(options);
}

int dispatch(int argc, char** argv, Stack& stack) {
  CLI::App app("Campaigns, benchmarks and conversions. Manual: docs/running.md");
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());
  Arguments arguments;
  CLI::App* campaign_command = add_campaign(app, arguments);
  CLI::App* bench_command = app.add_subcommand(
      "bench", "benchmarks: run, pictures, mapping, registration, mpc, stereo, terrain");
  bench_command->add_option("NAME", arguments.bench_name, "one of them; all when left out");
  const EvalCommands eval = add_eval(app, arguments);
  CLI::App* export_command = app.add_subcommand("export", "converts a record");
  export_command->add_option("RECORD", arguments.input, "record.mcap")->required();
  export_command->add_option("--to", arguments.to, "format")
      ->required()
      ->check(CLI::IsMember({"candump", "csv", "html"}));
  export_command->add_option("--out", arguments.out, "folder; the record's own when left out");
  CLI::App* motion_command = app.add_subcommand("motion", "optimises a jump, writes its file");
  motion_command->add_option("NAME", arguments.motion.name, "of the jump")->required();
  motion_command->add_option("--robot", arguments.motion.robot, "name or file")->required();
  motion_command->add_option("--out", arguments.motion.out, "file; config/motions/NAME.yaml");
  motion_command->add_flag("--verbose", arguments.motion.verbose, "the solver's iterations");
  CLI::App* learn_command = add_learn(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (campaign_command->parsed()) return run_campaign(arguments);
  if (bench_command->parsed()) return bench(arguments.bench_name, stack);
  if (eval.registration->parsed()) return run_eval_registration(arguments);
  if (eval.terrain_fill->parsed()) return run_eval_terrain_fill(arguments);
  if (eval.traversability->parsed()) return eval_traversability(arguments.traversability);
  if (learn_command->parsed()) return run_learn_terrain(arguments);
  if (motion_command->parsed()) return make_motion_file(arguments.motion);
  return export_command->parsed()
             ? export_record(arguments.input, arguments.to, arguments.out, stack)
             : 2;
}

}  // namespace
}  // namespace surefoot::apps

int main(int argc, char** argv) {
  static surefoot::apps::Stack stack;
  return surefoot::apps::dispatch(argc, argv, stack);
}
