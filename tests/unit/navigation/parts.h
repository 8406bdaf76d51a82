// Configurations of navigation's tests.
#pragma once

#include "core/navigation/config.h"

namespace surefoot::navigation::test {

// A robot of the Mini Cheetah's size.
inline NavigationConfig small_robot() {
  NavigationConfig config;
  config.half_length_m = 0.25;
  config.half_width_m = 0.2;
  config.map = {200, 0.2, 0.12, 6.0, 1.6, 6.0};
  config.shape = {3.0, 2.5, 0.2, 0.35, 3.0, 2.0, 12.0, 0.1};
  config.way = {20.0, 1.57, 9.0, 1.5, 60.0, 2.0, 3};
  config.follow.cruise_m_s = 0.5;
  config.follow.max_back_m_s = 0.3;
  config.follow.max_left_m_s = 0.3;
  config.follow.max_yaw_rate_rad_s = 0.8;
  config.follow.acceleration_m_s2 = 0.5;
  config.follow.braking_m_s2 = 0.8;
  config.follow.yaw_acceleration_rad_s2 = 3.0;
  config.follow.side_acceleration_m_s2 = 0.5;
  config.follow.side_gain_1_s = 1.0;
  config.follow.yaw_gain_1_s = 1.5;
  config.follow.near_m = 0.25;
  config.follow.far_m = 0.8;
  config.follow.target_m = 0.8;
  config.follow.turn_only_rad = 1.0;
  config.follow.reaction_s = 0.15;
  config.follow.walker_margin_m = 0.25;
  config.follow.walker_horizon_s = 4.0;
  config.follow.arrive_m = 0.3;
  return config;
}

// One of BigDog's: 1.1 m long, 1.6 m/s.
inline NavigationConfig large_robot() {
  NavigationConfig config = small_robot();
  config.half_length_m = 0.55;
  config.half_width_m = 0.3;
  config.map.clearance_m = 0.3;
  config.map.fall_off_reach_m = 2.4;
  config.shape.near_m = 5.0;
  config.shape.smoothing_m = 3.0;
  config.shape.over_smoothing_m = 20.0;
  config.follow.cruise_m_s = 1.6;
  config.follow.max_back_m_s = 0.6;
  config.follow.max_left_m_s = 0.5;
  config.follow.acceleration_m_s2 = 0.8;
  config.follow.braking_m_s2 = 1.2;
  config.follow.near_m = 0.5;
  config.follow.far_m = 1.5;
  config.follow.target_m = 2.0;
  config.follow.side_gain_1_s = 1.5;
  config.follow.walker_margin_m = 0.4;
  config.follow.arrive_m = 0.5;
  return config;
}

}  // namespace surefoot::navigation::test
