// Objects and navigation: a scan into a full memory, a plan in a wood with its goal beyond the map,
// a tick of the follower with every object in hand.
#include <cmath>

#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/navigation/navigator.h"
#include "core/objects/object_map.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

constexpr std::size_t kBeams = 1081;

// Every beam ends somewhere else: as many pieces as a scan can hold, none like the ones before.
hal::LidarScan noise(std::size_t round, Random& random) {
  hal::LidarScan scan;
  scan.stamp = milliseconds(40 * static_cast<std::int64_t>(round + 1));
  scan.beam_interval = microseconds(12);
  scan.beam_count = kBeams;
  scan.first_angle_rad = -1.57f;
  scan.angle_step_rad = 3.14f / kBeams;
  for (std::size_t i = 0; i < kBeams; ++i) {
    scan.range_m[i] = static_cast<float>(random.uniform(1.0, 30.0));
  }
  return scan;
}

class ObjectsScan final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    constexpr std::size_t kRounds = 3;
    if (round == 0) {
      objects::ObjectsConfig config = load({}).autonomy.navigation.objects;
      config.scan_stride = 1;
      config.min_points = 1;
      config.compact_range_m = 30.0;  // all of it is feared
      config.merge_m = 0.05;
      map_.reset(config);
      for (std::size_t i = 0; i < 20; ++i) take(noise(i, random_));
    }
    scan_ = noise(20 + round, random_);
    return round < kRounds;
  }
  void run() override { take(scan_); }
  bool did_the_work() override {
    return map_.objects().size() == objects::kMaxObjects && map_.counters().invalid == 0;
  }

 private:
  void take(const hal::LidarScan& scan) {
    objects::ScannerPose pose;
    pose.p_OL_m = Vector3(0.0, 0.0, 0.4);
    static_cast<void>(map_.update(scan, {pose, pose}, {}, nullptr));
  }

  Random random_{7, 1};
  objects::ObjectMap map_;
  hal::LidarScan scan_;
};

// Posts of 20 cm all around, `points` to each.
void plant(Random& random, std::size_t count, std::size_t points, objects::Objects& objects) {
  for (std::size_t i = 0; i < count; ++i) {
    objects::Object object;
    object.id = static_cast<std::uint32_t>(i + 1);
    const double away_m = random.uniform(1.5, 20.0);
    const double bearing_rad = random.uniform(-3.1, 3.1);
    object.centre_O_m = Vector2(away_m * std::cos(bearing_rad), away_m * std::sin(bearing_rad));
    for (std::size_t k = 0; k < points; ++k) {
      const double angle_rad = 0.1 * static_cast<double>(k);
      SUREFOOT_ASSERT(ok(object.points_O_m.push_back(
          object.centre_O_m + Vector2(0.1 * std::cos(angle_rad), 0.1 * std::sin(angle_rad)))));
    }
    SUREFOOT_ASSERT(ok(objects.push_back(object)));
  }
}

class NavigationPlan final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    constexpr std::size_t kRounds = 3;
    if (round == 0) {
      Random random(11, 1);
      plant(random, 160, 12, objects_);
      SUREFOOT_ASSERT(ok(navigator_.reset(load({}).autonomy.navigation.planner)));
      SUREFOOT_ASSERT(ok(navigator_.set_goal(Vector2(45.0, 0.0))));
    }
    robot_.p_O_m[0] = 0.4 * static_cast<double>(round);
    stamp_ = milliseconds(1000 * static_cast<std::int64_t>(round + 1));
    return round < kRounds;
  }
  void run() override { navigator_.plan(objects_, robot_, stamp_); }
  bool did_the_work() override {
    return navigator_.status().counters.plans == 3 && navigator_.path().size() > 50;
  }

 private:
  objects::Objects objects_;
  navigation::Navigator navigator_;
  navigation::RobotPose robot_;
  TimeNs stamp_;
};

class NavigationFollow final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    Random random(13, 1);
    plant(random, objects::kMaxObjects, objects::kMaxObjectPoints, objects_);
    SUREFOOT_ASSERT(ok(navigator_.reset(load({}).autonomy.navigation.planner)));
    SUREFOOT_ASSERT(ok(navigator_.set_goal(Vector2(15.0, 0.0))));
    navigator_.plan(objects::Objects{}, {}, milliseconds(1));
    // The first look at a list may cost more than the ticks that follow.
    command_ = navigator_.follow({}, objects_, milliseconds(2));
    return true;
  }
  void run() override { command_ = navigator_.follow({}, objects_, milliseconds(4)); }
  bool did_the_work() override { return navigator_.path().size() > 50; }

 private:
  objects::Objects objects_;
  navigation::Navigator navigator_;
  navigation::VelocityCommand command_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kNavigationCases[] = {
    {"objects_scan", "a scan of pure noise into a full memory", make<ObjectsScan>},
    {"navigation_plan", "a plan in a wood, the goal beyond the map", make<NavigationPlan>},
    {"navigation_follow", "a tick of the follower, the list of objects full",
     make<NavigationFollow>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
