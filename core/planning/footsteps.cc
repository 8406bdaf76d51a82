#include "core/planning/footsteps.h"

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::planning {
namespace {

constexpr double kMaxYaw_rad = 1e6;  // of math::sin_cos
constexpr double kHalfDiagonal = 0.7072;
// Beyond the usual one of each place, in one plan: this test is the dearest, and this bounds the
// whole search. After so many a place is looked at with the trunk at its usual height only. Not the
// first step's.
constexpr int kMaxFurtherPoses = 3600;

bool in_domain(const FootstepProblem& problem) {
  bool good = problem.turn < robot::kLegs && math::is_finite(problem.map_offset_m) &&
              mapping::is_mappable(problem.map_offset_m) &&
              math::magnitude(problem.yaw_rad) <= kMaxYaw_rad;
  for (const Vector3& foot : problem.feet_O_m) {
    for (const double x : foot) good = good && mapping::is_mappable(x);
  }
  for (const double x : problem.stride_O_m) good = good && mapping::is_mappable(x);
  for (const double x : problem.centre_offset_O_m) good = good && mapping::is_mappable(x);
  return good;
}

}  // namespace

// What the candidates of one state have in common.
struct FootstepPlanner::Expansion {
  const FootstepProblem& problem;
  const Node& from;
  std::size_t depth;  // steps made before
  std::size_t parent;
  std::size_t turn;
  std::size_t leg;
  Vector3 nominal_O_m;
  mapping::CellIndex middle;
  Triangle standing;  // while this leg is in the air, drawn in by the margin
};

StepLimits step_limits(const FootstepConfig& config) {
  return {config.reach_margin_m, config.stop_margin_rad, config.max_lowering_m,
          config.max_raising_m};
}

void FootstepPlanner::reset(const FootstepConfig& config, const robot::RobotModel& model,
                            const StanceShape& shape) {
  config_ = config;
  config_.steps = math::clamp(config.steps, 1, static_cast<std::int32_t>(kMaxFootsteps));
  config_.beam = math::clamp(config.beam, 1, static_cast<std::int32_t>(kMaxFootstepBeam));
  config_.radius_cells = math::clamp(config.radius_cells, 0, kMaxFootstepRadius_cells);
  model_ = model;
  shape_ = shape;
  cells_.reset(config_);
  list_offsets();
}

// By distance, then row, then column: insertion sort of at most 169.
void FootstepPlanner::list_offsets() {
  offsets_.clear();
  const std::int32_t r = config_.radius_cells;
  for (std::int32_t dy = -r; dy <= r; ++dy) {
    for (std::int32_t dx = -r; dx <= r; ++dx) {
      const double ring = math::sqrt(static_cast<double>(dx * dx + dy * dy));
      const double least = ring > kHalfDiagonal ? ring - kHalfDiagonal : 0.0;
      static_cast<void>(offsets_.push_back({dx, dy, least}));
      for (std::size_t i = offsets_.size() - 1; i > 0; --i) {
        const auto distance2 = [](const Offset& o) { return o.dx * o.dx + o.dy * o.dy; };
        if (distance2(offsets_[i - 1]) <= distance2(offsets_[i])) break;
        const Offset nearer = offsets_[i];
        offsets_[i] = offsets_[i - 1];
        offsets_[i - 1] = nearer;
      }
    }
  }
}

Status FootstepPlanner::plan(const FootstepProblem& problem, const terrain::TerrainMap& map,
                             FootstepPlan& out) {
  out = FootstepPlan{};
  if (!in_domain(problem)) return Status::kInvalid;
  cell_size_m_ = map.ground.cell_size_m;
  if (!(cell_size_m_ > 0)) return Status::kUnavailable;
  cells_.start(map);
  hips_O_m_ = stance_hips_O_m(model_, shape_.lateral_offset_m, problem.yaw_rad);
  search(problem);
  if (!best_.found || best_.depth == 0) return Status::kNotFound;
  write(out);
  return Status::kOk;
}

void FootstepPlanner::search(const FootstepProblem& problem) {
  best_ = Place{};
  further_poses_ = 0;
  for (Beam& beam : beams_) beam.ranking.clear();
  beams_[0].nodes[0] = Node{problem.feet_O_m, 0.0, 0, {}};
  static_cast<void>(beams_[0].ranking.push_back(0));
  const auto steps = static_cast<std::size_t>(config_.steps);
  for (std::size_t depth = 0; depth < steps; ++depth) {
    const Beam& beam = beams_[depth];
    for (const std::uint8_t node : beam.ranking) {
      if (!expand(problem, depth, node)) finish(depth, node);
    }
  }
  for (const std::uint8_t node : beams_[steps].ranking) finish(steps, node);
}

// false: no candidate is within the limits.
bool FootstepPlanner::expand(const FootstepProblem& problem, std::size_t depth,
                             std::size_t parent) {
  const Node& from = beams_[depth].nodes[parent];
  const std::size_t turn = (problem.turn + depth) % robot::kLegs;
  const std::size_t leg = step_leg(turn);
  const Vector3 nominal = nominal_place_O_m(from.feet_O_m, hips_O_m_, leg, problem.stride_O_m);
  const Expansion expansion{problem,
                            from,
                            depth,
                            parent,
                            turn,
                            leg,
                            nominal,
                            mapping::cell_index(nominal[0], nominal[1], cell_size_m_),
                            standing_triangle(from.feet_O_m, turn).drawn_in(shape_.margin_m)};
  bool continues = false;
  for (const Offset& offset : offsets_) {
    // No cell from here on costs less than its deviation.
    if (!wanted(depth + 1, from.cost + deviation_cost_m(offset.least_m * cell_size_m_))) {
      return true;
    }
    if (offer(expansion, offset)) continues = true;
  }
  return continues;
}

// false: not within the limits. One that is too dear for the beam is not tested to the end: it
// counts as within, so that its state is no dead end.
bool FootstepPlanner::offer(const Expansion& expansion, const Offset& offset) {
  Footstep step;
  if (!rate(expansion, offset, step)) return false;
  if (expansion.depth == 0 && is_avoided(expansion.problem, step)) return false;
  if (!wanted(expansion.depth + 1, expansion.from.cost + step.cost)) return true;
  if (!add_balance(expansion, step)) return false;
  if (!wanted(expansion.depth + 1, expansion.from.cost + step.cost)) return true;
  if (!reaches(expansion, step)) return false;
  if (!wanted(expansion.depth + 1, expansion.from.cost + step.cost)) return true;
  keep(expansion, step);
  return true;
}

bool FootstepPlanner::is_avoided(const FootstepProblem& problem, const Footstep& step) const {
  for (const Vector2& place : problem.avoided_O_m) {
    const double away_m2 = (step.position_O_m.head<2>() - place).squaredNorm();
    if (away_m2 < math::square(config_.avoid_m)) return true;
  }
  return false;
}

double FootstepPlanner::deviation_cost_m(double distance_m) const {
  return distance_m * distance_m / config_.deviation_scale_m;
}

// What depends on the place alone. The middle candidate is the nominal place itself, the others are
// their cells' centres.
bool FootstepPlanner::rate(const Expansion& expansion, const Offset& offset, Footstep& step) {
  step.cell = expansion.middle + mapping::CellIndex{offset.dx, offset.dy};
  const FootstepCell& cell = cells_.at(step.cell);
  if (!cell.usable) return false;
  const Vector3& nominal = expansion.nominal_O_m;
  const bool middle = offset.dx == 0 && offset.dy == 0;
  const double x = middle ? nominal[0] : mapping::cell_centre(step.cell.ix, cell_size_m_);
  const double y = middle ? nominal[1] : mapping::cell_centre(step.cell.iy, cell_size_m_);
  const double z = cell.height_m + expansion.problem.map_offset_m + model_.foot_radius_m;
  const double rise_m = math::magnitude(z - nominal[2]);
  if (!(rise_m <= config_.max_step_m)) return false;
  step.leg = expansion.leg;
  step.position_O_m = Vector3(x, y, z);
  step.nominal_O_m = nominal;
  step.terrain = cell.terrain;
  const double off_m2 = math::square(x - nominal[0]) + math::square(y - nominal[1]);
  step.cost = cell.cost_m + off_m2 / config_.deviation_scale_m + config_.rise_weight * rise_m;
  return true;
}

// The triangle of the next step: its room, and how far it is to it.
bool FootstepPlanner::add_balance(const Expansion& expansion, Footstep& step) const {
  Feet landed = expansion.from.feet_O_m;
  landed[expansion.leg] = step.position_O_m;
  const Triangle next = standing_triangle(landed, expansion.turn + 1);
  const double inradius_m = next.inradius_m();
  if (!(inradius_m >= config_.min_inradius_m)) return false;
  const double lacking_m = config_.wanted_inradius_m - inradius_m;
  if (lacking_m > 0) step.cost += config_.inradius_weight * lacking_m;
  if (config_.shift_weight > 0) {
    const Triangle drawn_in = next.drawn_in(shape_.margin_m);
    step.cost += config_.shift_weight * distance_m(expansion.standing, drawn_in);
  }
  return true;
}

// With the trunk as the static walk poses it for this step; what touches the ground there costs.
bool FootstepPlanner::reaches(const Expansion& expansion, Footstep& step) {
  Feet landed = expansion.from.feet_O_m;
  landed[expansion.leg] = step.position_O_m;
  const FootstepProblem& problem = expansion.problem;
  const Step way{expansion.from.feet_O_m, landed, expansion.turn, problem.yaw_rad,
                 problem.centre_offset_O_m};
  StepLimits limits = step_limits(config_);
  if (expansion.depth > 0 && further_poses_ >= kMaxFurtherPoses) {
    limits.max_lowering_m = 0;
    limits.max_raising_m = 0;
  }
  const StepPose pose =
      step_pose(model_, shape_, limits, {cells_.map(), problem.map_offset_m}, way);
  further_poses_ += pose.tried - 1;
  step.cost += config_.collision_weight * pose.deepest_m;
  return pose.reaches;
}

// Whether a sequence of `depth` steps and this cost has a place in the beam.
bool FootstepPlanner::wanted(std::size_t depth, double cost) const {
  const Beam& beam = beams_[depth];
  if (beam.ranking.size() < static_cast<std::size_t>(config_.beam)) return true;
  return cost < beam.nodes[beam.ranking.back()].cost;
}

// In a full beam, instead of the dearest; after its equals.
void FootstepPlanner::keep(const Expansion& expansion, const Footstep& step) {
  Beam& beam = beams_[expansion.depth + 1];
  if (beam.ranking.size() < static_cast<std::size_t>(config_.beam)) {
    static_cast<void>(beam.ranking.push_back(static_cast<std::uint8_t>(beam.ranking.size())));
  }
  const std::uint8_t place = beam.ranking.back();
  Node& node = beam.nodes[place];
  node.feet_O_m = expansion.from.feet_O_m;
  node.feet_O_m[expansion.leg] = step.position_O_m;
  node.cost = expansion.from.cost + step.cost;
  node.parent = expansion.parent;
  node.step = step;
  std::size_t rank = beam.ranking.size() - 1;
  for (; rank > 0 && beam.nodes[beam.ranking[rank - 1]].cost > node.cost; --rank) {
    beam.ranking[rank] = beam.ranking[rank - 1];
  }
  beam.ranking[rank] = place;
}

// A sequence that ends here, the first of the cheapest.
void FootstepPlanner::finish(std::size_t depth, std::size_t node) {
  const auto missing = static_cast<double>(static_cast<std::size_t>(config_.steps) - depth);
  const double cost = beams_[depth].nodes[node].cost + missing * config_.missing_step_m;
  if (best_.found && cost >= best_.cost) return;
  best_ = {depth, node, cost, true};
}

void FootstepPlanner::write(FootstepPlan& out) const {
  out.cost = best_.cost;
  static_cast<void>(out.steps.resize(best_.depth));
  std::size_t node = best_.node;
  for (std::size_t depth = best_.depth; depth > 0; --depth) {
    const Node& at = beams_[depth].nodes[node];
    out.steps[depth - 1] = at.step;
    node = at.parent;
  }
}

}  // namespace surefoot::planning
