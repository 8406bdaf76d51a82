// Forests and clearings in them. contract.md "The worlds"; paper 003, sections II and IV.
#include <algorithm>
#include <cmath>
#include <string>

#include "sim_hal/simulator_error.h"
#include "sim_hal/world/passage.h"
#include "sim_hal/world/relief.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kSteepest_rad = 0.19;  // 10.9 degrees
constexpr double kGentlest_rad = 0.10;
constexpr double kRoughness_m = 0.03;
constexpr double kMargin_m = 8.0;  // behind the start and the goal
constexpr double kHalfWidth_m = 20.0;
constexpr double kEdge_m = 1.0;  // without solids, along the border
constexpr double kStartClear_m = 2.0;
constexpr double kGoalClear_m = 1.5;
constexpr double kApart_m = 0.05;  // between two of them
constexpr double kRoom_m = 0.3;    // of the way, beside the robot's width
constexpr int kLayouts = 50;
constexpr int kAttempts = 200;  // to place one of them

// Per square metre.
constexpr double kStems[2] = {0.045, 0.115};
constexpr double kBoulders[2] = {0.011, 0.029};
constexpr double kLogs = 0.005;
constexpr double kSaplings = 0.1;

struct Clear {  // a place without solids
  Vector2 from_m = Vector2::Zero();
  Vector2 to_m = Vector2::Zero();
  double radius_m = 0;
};

class Planter {
 public:
  Planter(const PlanBounds& area, std::vector<Clear> clear, Random& random, Terrain& terrain)
      : area_(area), clear_(std::move(clear)), random_(random), terrain_(terrain) {}

  double square_m() const { return (area_.x1 - area_.x0) * (area_.y1 - area_.y0); }

  // As many as belong on the area, of each kind.
  void plant() {
    const double stems = random_.uniform(kStems[0], kStems[1]);
    const double boulders = random_.uniform(kBoulders[0], kBoulders[1]);
    fill(kLogs, [this] { return log(); });
    fill(stems, [this] { return trunk(); });
    fill(boulders, [this] { return boulder(); });
    const auto saplings = static_cast<std::size_t>(std::llround(kSaplings * square_m()));
    while (terrain_.saplings.size() < saplings) terrain_.saplings.push_back(sapling());
  }

 private:
  template <class Draw>
  void fill(double per_m2, const Draw& draw) {
    const auto count = static_cast<std::size_t>(std::llround(per_m2 * square_m()));
    for (std::size_t i = 0; i < count; ++i) {
      for (int attempt = 0; attempt < kAttempts; ++attempt) {
        const Solid solid = draw();
        if (!free(solid)) continue;
        terrain_.solids.push_back(solid);
        break;
      }
    }
  }

  bool free(const Solid& solid) const {
    const PlanBounds b = plan_bounds(solid);
    if (b.x0 < area_.x0 || b.y0 < area_.y0 || b.x1 > area_.x1 || b.y1 > area_.y1) return false;
    Vector2 away;
    for (const Clear& clear : clear_) {
      if (plan_distance_m(solid, clear.from_m, clear.to_m, away) < clear.radius_m) return false;
    }
    const Capsule& c = solid.capsule;
    const Vector2 from_m(c.a_m.x(), c.a_m.y());
    const Vector2 to_m(c.b_m.x(), c.b_m.y());
    return std::none_of(terrain_.solids.begin(), terrain_.solids.end(), [&](const Solid& other) {
      return plan_distance_m(other, from_m, to_m, away) < c.radius_m + kApart_m;
    });
  }

  Vector2 place() {
    const double x = random_.uniform(area_.x0, area_.x1);
    const double y = random_.uniform(area_.y0, area_.y1);
    return {x, y};
  }
  Vector3 on_ground(const Vector2& p, double above_m) const {
    return {p.x(), p.y(), terrain_.grid.height_m(p.x(), p.y()) + above_m};
  }

  // Thin ones are more frequent.
  Solid trunk() {
    const double share = random_.uniform();
    const double height_m = random_.uniform(4.0, 12.0);
    const Vector2 p = place();
    const double diameter_m = 0.08 + (0.6 - 0.08) * share * share;
    return {SolidKind::kTrunk, {on_ground(p, -1.0), on_ground(p, height_m), 0.5 * diameter_m}, {}};
  }
  // A ball, sunk by half at most.
  Solid boulder() {
    const double radius_m = 0.5 * random_.uniform(0.3, 1.2);
    const double up_m = random_.uniform(0.0, 0.5) * radius_m;
    const Vector3 centre = on_ground(place(), up_m);
    return {SolidKind::kBoulder, {centre, centre, radius_m}, {}};
  }
  // Lies at both of its ends.
  Solid log() {
    const double length_m = random_.uniform(2.0, 5.0);
    const double radius_m = 0.5 * random_.uniform(0.2, 0.5);
    const double heading = random_.uniform(0.0, kPi);
    const Vector2 middle = place();
    const Vector2 half =
        (0.5 * length_m - radius_m) * Vector2(std::cos(heading), std::sin(heading));
    const auto inside = [this](const Vector2& p) {
      return Vector2(std::clamp(p.x(), area_.x0, area_.x1), std::clamp(p.y(), area_.y0, area_.y1));
    };
    Solid solid{SolidKind::kLog, {}, {}};
    solid.capsule.a_m = on_ground(inside(middle - half), 0.8 * radius_m);
    solid.capsule.b_m = on_ground(inside(middle + half), 0.8 * radius_m);
    solid.capsule.a_m.head<2>() = middle - half;
    solid.capsule.b_m.head<2>() = middle + half;
    solid.capsule.radius_m = radius_m;
    return solid;
  }
  Sapling sapling() {
    const Vector2 p = place();
    const double radius_m = 0.5 * random_.uniform(0.005, 0.03);
    const double height_m = random_.uniform(0.4, 1.8);
    const double ground_m = terrain_.grid.height_m(p.x(), p.y());
    return {p.x(), p.y(), radius_m, ground_m, ground_m + height_m};
  }

  PlanBounds area_;
  std::vector<Clear> clear_;
  Random& random_;
  Terrain& terrain_;
};

void make_ground(const PlanBounds& area, Random& random, Terrain& terrain) {
  ReliefConfig config;
  config.area = area;
  config.steepest_rad = random.uniform(kGentlest_rad, kSteepest_rad);
  config.roughness_rms_m = kRoughness_m;
  config.start = {0, 0, 1.0, 2.5};
  terrain.grid = make_relief(config, random);
  terrain.spread.steepest_rad = config.steepest_rad;
  terrain.spread.roughness_rms_m = config.roughness_rms_m;
}

// Drawn again until there is a way.
void make_wood(const PlanBounds& area, double goal_x_m, const std::vector<Clear>& clear,
               double robot_width_m, Random& random, Terrain& terrain) {
  make_ground(area, random, terrain);
  const PlanBounds inner{area.x0 + kEdge_m, area.y0 + kEdge_m, area.x1 - kEdge_m,
                         area.y1 - kEdge_m};
  SpreadFigures& spread = terrain.spread;
  spread.passage_width_m = robot_width_m + kRoom_m;
  while (spread.layouts < kLayouts) {
    ++spread.layouts;
    terrain.solids.clear();
    terrain.saplings.clear();
    Planter planter(inner, clear, random, terrain);
    planter.plant();
    spread.area_m2 = planter.square_m();
    if (passage_exists(terrain.solids, inner, Vector2(0, 0), Vector2(goal_x_m, 0),
                       spread.passage_width_m)) {
      return;
    }
  }
  throw SimulatorError("world: no forest of " + std::to_string(kLayouts) + " has a way " +
                       std::to_string(spread.passage_width_m) + " m wide");
}

// Somewhere on the clearing's edge on this side of the way.
Vector2 edge_place(double side, double goal_x_m, Random& random) {
  const double x = random.uniform(4.0, goal_x_m - 3.0);
  const double y = random.uniform(3.5, 5.5);
  return {x, side * y};
}

}  // namespace

void make_forest(double goal_x_m, double robot_width_m, Random& random, Terrain& terrain) {
  const PlanBounds area{-kMargin_m, -kHalfWidth_m, goal_x_m + kMargin_m, kHalfWidth_m};
  const Vector2 start(0, 0);
  const Vector2 goal(goal_x_m, 0);
  make_wood(area, goal_x_m, {{start, start, kStartClear_m}, {goal, goal, kGoalClear_m}},
            robot_width_m, random, terrain);
}

// The way is clear between start and goal, for 6.5 m to either side; people go from one side of the
// clearing to the other and back, at least 3.5 m from the start.
void make_walkers(double goal_x_m, double robot_width_m, Random& random, Terrain& terrain) {
  constexpr double kClearing_m = 6.5;
  constexpr double kHalfWood_m = 15.0;
  const PlanBounds area{-kMargin_m, -kHalfWood_m, goal_x_m + kMargin_m, kHalfWood_m};
  const Vector2 goal(goal_x_m, 0);
  const Vector2 start(0, 0);
  make_wood(area, goal_x_m,
            {{start, start, kStartClear_m},
             {goal, goal, kGoalClear_m},
             {Vector2(4, 0), Vector2(goal_x_m - 3, 0), kClearing_m}},
            robot_width_m, random, terrain);
  const std::uint32_t count = 3 + random.below(6);
  for (std::uint32_t i = 0; i < count; ++i) {
    Walker walker;
    walker.from_m = edge_place(1.0, goal_x_m, random);
    walker.to_m = edge_place(-1.0, goal_x_m, random);
    walker.speed_m_s = random.uniform(0.5, 1.5);
    walker.begin_m = random.uniform(0.0, 2 * (walker.to_m - walker.from_m).norm());
    terrain.walkers.push_back(walker);
  }
}

}  // namespace surefoot::sim
