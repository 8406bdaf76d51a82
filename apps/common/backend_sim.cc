// Backends of a build with the simulator.
#include <fmt/format.h>

#include "apps/common/backend.h"

namespace surefoot::apps {
namespace {

// Set down as the robot lies folded.
sim::SimulatorConfig simulator_config(const Config& config) {
  sim::SimulatorConfig result = config.sim;
  result.start.leg_rad = config.autonomy.control.stand_up.folded_rad;
  return result;
}

class SimulatorBackend final : public Backend {
 public:
  SimulatorBackend(const RunRequest& request, const Config& config)
      : simulator_(config.robot, config.world, simulator_config(config), request.seed),
        plant_(sim::kPlantNames[static_cast<std::size_t>(config.sim.plant)]) {}

  hal::Board board() override { return simulator_.board(); }
  std::string plant() const override { return plant_; }
  bool has_truth() const override { return true; }
  sim::Truth truth() const override { return simulator_.truth(); }
  double ground_m(double x_m, double y_m) const override {
    return simulator_.terrain_height_m(x_m, y_m);
  }
  sim::TerrainFigures terrain() const override { return simulator_.terrain_figures(); }
  std::vector<sim::SolidTruth> solids() const override { return simulator_.solids(); }

 private:
  sim::Simulator simulator_;
  std::string plant_;
};

}  // namespace

std::vector<std::string> backend_names() { return {"sim"}; }

std::unique_ptr<Backend> make_backend(const RunRequest& request, const Config& config) {
  if (request.hal != "sim") {
    throw BackendError(fmt::format("--hal: '{}' is not in this build; it has: sim", request.hal));
  }
  try {
    return std::make_unique<SimulatorBackend>(request, config);
  } catch (const sim::SimulatorError& error) {
    throw BackendError(error.what());
  }
}

}  // namespace surefoot::apps
