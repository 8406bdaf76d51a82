// What navigation leaves for pictures: every plan as it was published, with the objects it was made
// from and its cost map. Taken between ticks; may allocate.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/autonomy/autonomy.h"
#include "core/base/time.h"

namespace surefoot::apps {

using PlanPoint = std::array<float, 2>;  // O, m

// A point of an object. moving: the object does.
struct SeenPoint {
  PlanPoint p_O_m{};
  bool moving = false;
};

struct PlanSample {
  TimeNs stamp;
  PlanPoint robot_O_m{};
  std::vector<PlanPoint> path_O_m;  // smooth
  std::vector<SeenPoint> objects;
  // The cost map: 0 free to 254 dear, 255 lethal; rows along y, from its smallest x and y.
  int side = 0;
  double cell_m = 0;
  PlanPoint corner_O_m{};  // outer corner of cell (0, 0)
  std::vector<std::uint8_t> cost;
};

class PlanLog {
 public:
  // After every tick: takes the plan that was published in it, if one was.
  void observe(TimeNs stamp, const autonomy::Autonomy& autonomy);

  const std::vector<PlanSample>& samples() const { return samples_; }

 private:
  std::uint64_t plans_ = 0;
  std::vector<PlanSample> samples_;
};

}  // namespace surefoot::apps
