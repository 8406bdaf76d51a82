// The HAL backends a run can choose from by name. `sim` is there when the build has the simulator.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/common/config_root.h"
#include "hal/api/board.h"
#include "sim_hal/simulator.h"

namespace surefoot::apps {

// An unknown backend, or one that refuses the configuration. what() is for the user.
class BackendError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Backend {
 public:
  virtual ~Backend() = default;
  virtual hal::Board board() = 0;

  // Ground truth, for figures and pictures only. Without it the rest answers zeros.
  // What moves: "robot", or which of the simulated plants.
  virtual std::string plant() const { return "robot"; }
  virtual bool has_truth() const { return false; }
  virtual sim::Truth truth() const { return {}; }
  virtual double ground_m(double, double) const { return 0; }
  virtual sim::TerrainFigures terrain() const { return {}; }
  virtual std::vector<sim::SolidTruth> solids() const { return {}; }
};

// Names in this build.
std::vector<std::string> backend_names();
// Throws BackendError.
std::unique_ptr<Backend> make_backend(const RunRequest& request, const Config& config);

}  // namespace surefoot::apps
