// One curve per leg, in the same colours in every picture.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "apps/common/axes.h"
#include "apps/common/run_log.h"
#include "core/robot/robot_model.h"

namespace surefoot::apps {

inline constexpr std::array<const char*, robot::kLegs> kLegNames{"FR", "FL", "HR", "HL"};
inline constexpr std::array<Colour, robot::kLegs> kLegColours{palette::kBlue, palette::kOrange,
                                                              palette::kGreen, palette::kPurple};
inline constexpr std::array<const char*, robot::kJointsPerLeg> kTorqueTitles{
    "Torque of the abduction joints", "Torque of the hip joints", "Torque of the knee joints"};

// Measured torques of one joint of the four legs over time [s], and the actuator's limit [N m].
void draw_torques(Axes& axes, std::span<const double> t_s, std::span<const RunSample> samples,
                  std::size_t joint, double limit_Nm, double width);

}  // namespace surefoot::apps
