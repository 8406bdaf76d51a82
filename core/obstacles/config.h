// Everything that can be tuned about obstacles. Recommended values: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::obstacles {

struct ObstacleConfig {
  // What counts as an obstacle
  std::uint32_t min_cells = 0;
  double field_radius_m = 0;
  std::uint32_t forget_windows = 0;
  // How it repels
  double margin_m = 0;
  double reach_m = 0;
  double push_m_s = 0;
  double swirl = 0;
  double approach_gain_1_s = 0;
  double max_forward_m_s = 0;
  double max_back_m_s = 0;
  double max_sideways_m_s = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("min_cells", self.min_cells, {1, 1000}, "connected cells that make an object");
    visit.real("field_radius_m", self.field_radius_m, {0.01, 1.0},
               "of the disc a field stands for");
    visit.integer("forget_windows", self.forget_windows, {1, 1000},
                  "map windows that show a field's place free before it is forgotten");
    visit.real("margin_m", self.margin_m, {0.0, 1.0}, "kept free around the robot");
    visit.real("reach_m", self.reach_m, {0.01, 5.0}, "free space over which a field repels");
    visit.real("push_m_s", self.push_m_s, {0.0, 4.0}, "of one field where the free space ends");
    visit.real("swirl", self.swirl, {0.0, 10.0}, "sideways share of what a field ahead repels");
    visit.real("approach_gain_1_s", self.approach_gain_1_s, {0.1, 20.0},
               "speed towards a field over the free space before it");
    visit.real("max_forward_m_s", self.max_forward_m_s, {0.0, 4.0}, "while a field repels");
    visit.real("max_back_m_s", self.max_back_m_s, {0.0, 4.0}, "while a field repels");
    visit.real("max_sideways_m_s", self.max_sideways_m_s, {0.0, 4.0}, "while a field repels");
  }
};

}  // namespace surefoot::obstacles
