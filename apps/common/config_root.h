// The whole configuration of a run, and how names on the command line become files.
//
//   --robot NAME      config/robots/NAME.yaml     groups robot, actuation, estimation, mapping,
//   control,
//                                                 safety, start_pad, sim
//   --world NAME[:a=1,b=2]  config/worlds/NAME.yaml  group world, and `parameters`: the keys of
//   world
//                                                 that may follow the colon. A short name (height)
//                                                 means the key it begins (height_m)
//   --world heightmap:FILE[,scale=S]              the same with world.file = FILE
//   --mission NAME    config/missions/NAME.yaml   groups mission, scenario
//   --set key=value   any key, dotted
// Instead of a name each takes a path to a .yaml file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/config_node.h"
#include "core/autonomy/config.h"
#include "core/mapping/traversability.h"
#include "core/robot/robot_model.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/world_spec.h"

namespace surefoot::apps {

struct Config {
  robot::RobotModel robot;
  autonomy::AutonomyConfig autonomy;  // its groups stand at the top level
  sim::WorldSpec world;
  sim::SimulatorConfig sim;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("robot", self.robot);
    autonomy::AutonomyConfig::describe(self.autonomy, visit);
    visit.group("world", self.world);
    visit.group("sim", self.sim);
    visit.group("scenario", self.sim.scenario);
  }
};

// Where the classes of the ground begin for this robot and its way of walking.
mapping::TraversabilityLimits class_limits(const Config& config);

// What a run was asked for. Kept in the record beside the resolved configuration.
struct RunRequest {
  std::string robot;
  std::string world;
  std::string mission;
  std::string hal = "sim";
  std::uint64_t seed = 1;
  std::vector<std::string> sets;
};

// The folder config/: $SUREFOOT_CONFIG, else beside the binary's build tree (../../../config from
// build/release/bin), else the present folder's, else the source tree's. Empty: none exists.
std::filesystem::path config_folder();

// Reads what a run needs: robot, world and mission. The result is complete where `issues` stays
// empty.
Config load_config(const RunRequest& request, const std::filesystem::path& folder,
                   ConfigIssues& issues);

// Reads only the parts that `request` names; the others keep the structs' initial values.
Config load_config_parts(const RunRequest& request, const std::filesystem::path& folder,
                         ConfigIssues& issues);

// The canonical text (config_writer.h) of all groups, and its hash.
std::string config_text(const Config& config);
std::uint64_t config_hash(const Config& config);

// A record's first message: what was asked for, as `run.key = value` lines, then config_text.
std::string record_text(const RunRequest& request, const Config& config);
void read_record_text(const std::string& text, RunRequest& request, Config& config,
                      ConfigIssues& issues);

}  // namespace surefoot::apps
