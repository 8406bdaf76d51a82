#include "apps/common/leg_curves.h"

#include <vector>

namespace surefoot::apps {

void draw_torques(Axes& axes, std::span<const double> t_s, std::span<const RunSample> samples,
                  std::size_t joint, double limit_Nm, double width) {
  std::vector<LegendItem> legend;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    std::vector<double> torque_Nm;
    torque_Nm.reserve(samples.size());
    for (const RunSample& sample : samples) {
      torque_Nm.push_back(sample.telemetry.joints[robot::joint_index(leg, joint)].torque_Nm);
    }
    const Stroke stroke{kLegColours[leg], width, false};
    axes.series(t_s, torque_Nm, stroke);
    legend.push_back({kLegNames[leg], stroke});
  }
  const Stroke bound{palette::kRed, 1.4, true};
  axes.horizontal(limit_Nm, bound);
  axes.horizontal(-limit_Nm, bound);
  legend.push_back({"limit", bound});
  axes.legend(legend);
}

}  // namespace surefoot::apps
