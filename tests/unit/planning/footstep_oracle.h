// The search for footsteps by the book: every sequence, costs from their definitions, legs by
// inverse kinematics, what touches the ground by joint angles. Sequences that cost more than a
// given bound are cut, which changes nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "core/geometry/rotations.h"
#include "core/planning/footsteps.h"
#include "core/robot/kinematics.h"
#include "tests/support/rough_footsteps.h"

namespace surefoot::planning {

class FootstepOracle {
 public:
  FootstepOracle(const FootstepConfig& config, const robot::RobotModel& model,
                 const StanceShape& shape, const FootstepProblem& problem,
                 const terrain::TerrainMap& map)
      : config_(config), model_(model), shape_(shape), problem_(problem), map_(map) {}

  // The least cost of all sequences, at most `bound`; steps() are empty where none costs less.
  double search(double bound) {
    best_ = bound;
    best_steps_.clear();
    made_.clear();
    descend(problem_.feet_O_m, 0.0);
    return best_;
  }
  const std::vector<Footstep>& steps() const { return best_steps_; }

  // Of one step from these feet without what its pose costs; below 0: not allowed.
  double step_cost(const Feet& feet, std::size_t depth, const Vector3& nominal, Footstep& step) {
    const std::size_t turn = (problem_.turn + depth) % 4;
    const std::size_t leg = kStepOrder[turn];
    double spread_m = 0;
    double ground_m = 0;
    if (!mean_around(step.cell, ground_m, spread_m)) return -1;
    const double terrain = at(map_.cost, step.cell);
    if (terrain > config_.max_cost) return -1;
    step.position_O_m[2] = ground_m + problem_.map_offset_m + model_.foot_radius_m;
    const double rise_m = std::abs(step.position_O_m[2] - feet[leg][2]);
    if (rise_m > config_.max_step_m) return -1;
    Feet landed = feet;
    landed[leg] = step.position_O_m;
    const Triangle next = without(landed, kStepOrder[(turn + 1) % 4]);
    const double room_m = next.inradius_m();
    if (room_m < config_.min_inradius_m) return -1;
    const double wall_m = stands_up_m(step.cell, ground_m);
    const double drop_m = falls_off_m(step.cell, ground_m);
    const double off_m = (step.position_O_m - nominal).head<2>().norm();
    const double shift_m =
        distance_m(without(feet, leg).drawn_in(shape_.margin_m), next.drawn_in(shape_.margin_m));
    return config_.terrain_weight_m * terrain + config_.spread_weight * spread_m +
           config_.wall_weight * wall_m + config_.drop_weight * drop_m +
           off_m * off_m / config_.deviation_scale_m + config_.rise_weight * rise_m +
           config_.inradius_weight * std::max(0.0, config_.wanted_inradius_m - room_m) +
           config_.shift_weight * shift_m;
  }

  // Nothing: no pose that is allowed serves all legs. Else how deep the robot is in the ground in
  // the best of those poses.
  std::optional<double> deepest_m(const Feet& feet, std::size_t depth,
                                  const Vector3& landing) const {
    const std::size_t turn = (problem_.turn + depth) % 4;
    Feet landed = feet;
    landed[kStepOrder[turn]] = landing;
    std::optional<double> least_m;
    for (const double share : {shape_.slope_share, 1.0}) {
      StanceShape shape = shape_;
      shape.slope_share = share;
      const TrunkPose pose = trunk_over(model_, shape, landed, problem_.yaw_rad);
      const Vector2 centre =
          place_centre(feet, landed, turn, shape_.margin_m, pose.centre_O_m).place_O_m;
      const Vector2 origin = centre - problem_.centre_offset_O_m;
      const Vector3& rpy = pose.roll_pitch_yaw_rad;
      const Matrix3 R_OB = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
      const auto lower = static_cast<int>(std::round(config_.max_lowering_m / 0.006 - 0.499));
      const auto raise = static_cast<int>(std::round(config_.max_raising_m / 0.006 - 0.499));
      for (int i = -lower; i <= raise; ++i) {
        const Vector3 p_OB_m(origin[0], origin[1], pose.height_O_m + i * 0.006);
        if (!serves(feet, landed, R_OB, p_OB_m)) continue;
        const double deep_m = in_ground_m(landed, R_OB, p_OB_m);
        if (!least_m || deep_m < *least_m) least_m = deep_m;
        if (*least_m == 0.0) return least_m;
      }
    }
    return least_m;
  }

  Vector3 nominal(const Feet& feet, std::size_t depth) const {
    const Hips hips = stance_hips_O_m(model_, shape_.lateral_offset_m, problem_.yaw_rad);
    return nominal_place_O_m(feet, hips, kStepOrder[(problem_.turn + depth) % 4],
                             problem_.stride_O_m);
  }

 private:
  static Triangle without(const Feet& feet, std::size_t leg) {
    std::vector<Vector2> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      if (i != leg) corners.push_back(feet[i].head<2>());
    }
    return {{corners[0], corners[1], corners[2]}};
  }

  double at(const std::array<float, terrain::TerrainMap::kCells>& layer, mapping::CellIndex i) {
    return static_cast<double>(layer[static_cast<std::size_t>(
        (i.iy - map_.ground.first.iy) * mapping::kWindowSide + i.ix - map_.ground.first.ix)]);
  }

  bool avoided(const Vector3& place) const {
    for (const Vector2& bad : problem_.avoided_O_m) {
      if (std::hypot(place[0] - bad[0], place[1] - bad[1]) < config_.avoid_m) return true;
    }
    return false;
  }

  bool mean_around(mapping::CellIndex i, double& height_m, double& spread_m) {
    const mapping::WindowCell* middle = map_.ground.find(i);
    if (middle == nullptr || !middle->has_height()) return false;
    int known = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const mapping::CellIndex near = i + mapping::CellIndex{dx, dy};
        const mapping::WindowCell* cell = map_.ground.find(near);
        if (cell == nullptr || !cell->has_height()) continue;
        height_m += static_cast<double>(cell->height_m);
        spread_m += at(map_.spread_m, near);
        ++known;
      }
    }
    height_m /= known;
    spread_m /= known;
    return true;
  }

  std::vector<double> heights_around(mapping::CellIndex i) const {
    std::vector<double> heights;
    for (int dy = -3; dy <= 3; ++dy) {
      for (int dx = -3; dx <= 3; ++dx) {
        const mapping::WindowCell* cell = map_.ground.find(i + mapping::CellIndex{dx, dy});
        const double away_m = std::hypot(dx, dy) * map_.ground.cell_size_m;
        if (cell == nullptr || !cell->has_height() || away_m > config_.edge_reach_m) continue;
        heights.push_back(static_cast<double>(cell->height_m));
      }
    }
    return heights;
  }
  double stands_up_m(mapping::CellIndex i, double height_m) const {
    const std::vector<double> around = heights_around(i);
    return std::max(0.0, *std::max_element(around.begin(), around.end()) - height_m);
  }
  double falls_off_m(mapping::CellIndex i, double height_m) const {
    const std::vector<double> around = heights_around(i);
    return std::max(0.0, height_m - *std::min_element(around.begin(), around.end()));
  }

  // All legs reach, the stepping one at both ends, and no joint comes too near to its stops.
  bool serves(const Feet& feet, const Feet& landed, const Matrix3& R_OB,
              const Vector3& p_OB_m) const {
    for (std::size_t leg = 0; leg < 4; ++leg) {
      for (const Vector3& foot : {landed[leg], feet[leg]}) {
        const robot::LegSolution solution =
            robot::solve_leg(model_, leg, R_OB.transpose() * (foot - p_OB_m));
        if (!ok(solution.status)) return false;
        // As if it were the front left leg.
        const auto q =
            model_.pose_of(leg, {solution.q_rad[0], solution.q_rad[1], solution.q_rad[2]});
        for (std::size_t joint = 0; joint < 3; ++joint) {
          const robot::Actuator& stops = model_.actuators[joint];
          if (q[joint] - stops.min_rad < config_.stop_margin_rad) return false;
          if (stops.max_rad - q[joint] < config_.stop_margin_rad) return false;
        }
      }
    }
    return true;
  }

  double in_ground_m(const Feet& feet, const Matrix3& R_OB, const Vector3& p_OB_m) const {
    double deepest_m = 0;
    const auto look = [&](const Vector3& p_B, double radius_m) {
      const Vector3 p_O = R_OB * p_B + p_OB_m;
      const Result<double> ground = map_.ground.height_at(p_O[0], p_O[1]);
      if (!ground.ok()) return;
      deepest_m = std::max(deepest_m, ground.value() + problem_.map_offset_m + radius_m - p_O[2]);
    };
    // Legs against the highest cell of nine.
    const auto look_beside = [&](const Vector3& p_B, double radius_m) {
      const Vector3 p_O = R_OB * p_B + p_OB_m;
      const auto middle = mapping::cell_index(p_O[0], p_O[1], map_.ground.cell_size_m);
      for (int k = 0; k < 9 && map_.ground.contains(middle); ++k) {
        const auto* cell = map_.ground.find(middle + mapping::CellIndex{k / 3 - 1, k % 3 - 1});
        if (cell == nullptr || !cell->has_height()) continue;
        const double ground_m = static_cast<double>(cell->height_m) + problem_.map_offset_m;
        deepest_m = std::max(deepest_m, ground_m + radius_m + 0.004 - p_O[2]);
      }
    };
    const auto& size = model_.trunk_size_m;
    for (const double x : {-0.5, 0.0, 0.5}) {
      for (const double y : {-0.5, 0.0, 0.5}) {
        look(Vector3(x * size[0], y * size[1], -0.5 * size[2]), 0.0);
      }
    }
    for (std::size_t leg = 0; leg < 4; ++leg) {
      const Vector3 foot_B = R_OB.transpose() * (feet[leg] - p_OB_m);
      const robot::LegVector q = robot::solve_leg(model_, leg, foot_B).q_rad;
      const double left = leg % 2 == 1 ? 1.0 : -1.0;
      const double front = leg < 2 ? 1.0 : -1.0;
      const Eigen::AngleAxisd abad(q[0], Vector3::UnitX());
      const Vector3 hip = Vector3(front * model_.abad_x_m, left * model_.abad_y_m, 0.0) +
                          abad * Vector3(0.0, left * model_.hip_offset_m, 0.0);
      const Vector3 thigh(0.0, left * model_.knee_offset_m, -model_.thigh_length_m);
      const Vector3 knee = hip + abad * (Eigen::AngleAxisd(-q[1], Vector3::UnitY()) * thigh);
      look_beside(knee, model_.thigh_radius_m);
      look_beside(0.5 * (hip + knee), model_.thigh_radius_m);
      look_beside(0.7 * knee + 0.3 * foot_B, model_.shank_radius_m);
      look_beside(0.4 * knee + 0.6 * foot_B, model_.shank_radius_m);
    }
    return deepest_m;
  }

  void descend(const Feet& feet, double cost) {
    const auto steps = static_cast<std::size_t>(config_.steps);
    if (made_.size() == steps) return end(cost);
    const Vector3 nominal_O_m = nominal(feet, made_.size());
    std::vector<Footstep> candidates;
    const double size_m = map_.ground.cell_size_m;
    const mapping::CellIndex middle = mapping::cell_index(nominal_O_m[0], nominal_O_m[1], size_m);
    const int r = config_.radius_cells;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        Footstep step;
        step.leg = kStepOrder[(problem_.turn + made_.size()) % 4];
        step.cell = middle + mapping::CellIndex{dx, dy};
        step.nominal_O_m = nominal_O_m;
        step.position_O_m = nominal_O_m;
        if (dx != 0 || dy != 0) {
          step.position_O_m[0] = (step.cell.ix + 0.5) * size_m;
          step.position_O_m[1] = (step.cell.iy + 0.5) * size_m;
        }
        if (made_.empty() && avoided(step.position_O_m)) continue;
        step.cost = step_cost(feet, made_.size(), nominal_O_m, step);
        if (step.cost >= 0) candidates.push_back(step);
      }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Footstep& a, const Footstep& b) { return a.cost < b.cost; });
    const double ending = cost + static_cast<double>(steps - made_.size()) * config_.missing_step_m;
    bool continues = false;
    for (Footstep& step : candidates) {
      const bool dear = cost + step.cost >= best_;
      if (dear && (continues || ending >= best_)) break;
      const std::optional<double> deep_m = deepest_m(feet, made_.size(), step.position_O_m);
      if (!deep_m) continue;
      continues = true;
      if (dear) break;
      step.cost += config_.collision_weight * *deep_m;
      if (cost + step.cost >= best_) continue;
      Feet landed = feet;
      landed[step.leg] = step.position_O_m;
      made_.push_back(step);
      descend(landed, cost + step.cost);
      made_.pop_back();
    }
    if (!continues && !made_.empty()) end(ending);
  }

  void end(double cost) {
    if (cost >= best_) return;
    best_ = cost;
    best_steps_ = made_;
  }

  FootstepConfig config_;
  robot::RobotModel model_;
  StanceShape shape_;
  FootstepProblem problem_;
  const terrain::TerrainMap& map_;
  double best_ = 0;
  std::vector<Footstep> best_steps_;
  std::vector<Footstep> made_;
};

}  // namespace surefoot::planning
