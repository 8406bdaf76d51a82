#include "core/objects/memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/unit/objects/config.h"

namespace surefoot::objects {
namespace {

using PointList = FixedVector<Vector2, kMaxObjectPoints>;

TimeNs seconds(double s) { return {static_cast<std::int64_t>(s * 1e9)}; }

class Memory : public testing::Test {
 protected:
  Memory() { memory_->reset(config_); }
  Result<std::size_t> add(const Vector2& at, double time_s, double tracked_s = 0) {
    PointList points;
    static_cast<void>(points.push_back(at));
    static_cast<void>(points.push_back(at + Vector2(0.3, 0.1)));
    const auto added = memory_->add(points, ObjectClass::kObstacle, seconds(time_s), robot_);
    if (added.ok()) memory_->objects()[added.value()].tracked_s = tracked_s;
    return added;
  }
  std::set<std::uint32_t> ids() const {
    std::set<std::uint32_t> ids;
    for (const Object& object : memory_->objects()) ids.insert(object.id);
    return ids;
  }
  // The paper's sets, from its text.
  double norm_m(const Object& object) const {
    double least = 1e9;
    for (const Vector2& p : object.points_O_m) {
      least = std::min(least, std::max(std::abs(p[0] - robot_[0]), std::abs(p[1] - robot_[1])));
    }
    return least;
  }

  ObjectsConfig config_ = test::config();
  Vector2 robot_ = Vector2::Zero();
  std::unique_ptr<ObjectMemory> memory_ = std::make_unique<ObjectMemory>();
};

TEST_F(Memory, ForgetsWhatThePaperForgets) {
  Random random(11);
  for (int sample = 0; sample < tests::samples(200, 5); ++sample) {
    memory_->reset(config_);
    const double now_s = 4000;
    for (int i = 0; i < 400; ++i) {
      const double x = random.uniform(-25, 25);
      const double y = random.uniform(-25, 25);
      const bool old = random.below(2) == 0;
      const double age_s = old ? random.uniform(0, 3600) : random.uniform(0, 60);
      ASSERT_TRUE(add({x, y}, now_s - age_s).ok());
    }
    robot_ = {random.uniform(-5, 5), 0};
    std::set<std::uint32_t> wanted;
    for (const Object& object : memory_->objects()) {
      const double age_s = now_s - object.last_seen.seconds();
      const bool far = age_s >= 30 && norm_m(object) >= 15;
      const bool old = age_s >= 1800 && norm_m(object) >= 10;
      if (!(far || old) || age_s <= 10) wanted.insert(object.id);
    }
    memory_->forget(seconds(now_s), robot_);
    ASSERT_EQ(ids(), wanted);
  }
}

TEST_F(Memory, TheLimitsThemselvesAreForgotten) {
  ASSERT_TRUE(add({15, 0}, 0).ok());
  memory_->forget(seconds(29.99), robot_);
  EXPECT_EQ(ids().size(), 1u);
  memory_->forget(seconds(30), robot_);
  EXPECT_EQ(ids().size(), 0u);
  ASSERT_TRUE(add({14.9, 0}, 0).ok());
  memory_->forget(seconds(1799), robot_);
  EXPECT_EQ(ids().size(), 1u);
  memory_->forget(seconds(1800), robot_);
  EXPECT_EQ(ids().size(), 0u);
}

TEST_F(Memory, WhenFullTheShortestTrackedGivesWay) {
  Random random(13);
  for (std::size_t i = 0; i < kMaxObjects; ++i) {
    ASSERT_TRUE(add({5.0, 0}, -20, random.uniform(0, 100)).ok());
  }
  // Ten times as many as there is room for, a few of the old ones seen lately.
  for (std::size_t i = 0; i < 10 * kMaxObjects; ++i) {
    Object& lately = memory_->objects()[random.below(kMaxObjects)];
    lately.last_seen = seconds(-5);
    std::uint32_t least = 0;
    double least_s = 1e9;
    for (Object& object : memory_->objects()) {
      const bool recent = object.last_seen >= seconds(-10);
      if (recent && &object != &lately) object.last_seen = seconds(-20);
      if (&object == &lately || object.tracked_s >= least_s) continue;
      least_s = object.tracked_s;
      least = object.id;
    }
    ASSERT_TRUE(add({6, 6}, 0, random.uniform(0, 100)).ok());
    ASSERT_EQ(ids().count(least), 0u);
    ASSERT_EQ(ids().size(), kMaxObjects);
  }
}

TEST_F(Memory, WhenAllAreRecentTheFarthestGivesWayAndNothingNear) {
  for (std::size_t i = 0; i < kMaxObjects; ++i) {
    ASSERT_TRUE(add({i < 100 ? 1.0 : 5.0 + static_cast<double>(i), 0}, 0).ok());
  }
  EXPECT_FALSE(add({1000, 0}, 1).ok());
  EXPECT_EQ(memory_->counters().refused, 1u);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(add({1.5, 0}, 1).ok() || i >= 412) << i;
  std::size_t near = 0;
  for (const Object& object : memory_->objects()) near += norm_m(object) <= 2;
  EXPECT_EQ(near, kMaxObjects);
  EXPECT_EQ(ids().size(), kMaxObjects);
  EXPECT_EQ(memory_->counters().recent, 412u);
  for (std::uint32_t id = 1; id <= 100; ++id) EXPECT_EQ(ids().count(id), 1u);
}

TEST_F(Memory, GroundGivesWayFirst) {
  PointList points;
  static_cast<void>(points.push_back({0.5, 0}));
  ASSERT_TRUE(memory_->add(points, ObjectClass::kGround, seconds(0), robot_).ok());
  for (std::size_t i = 1; i < kMaxObjects; ++i) ASSERT_TRUE(add({5, 0}, 0).ok());
  ASSERT_TRUE(add({50, 0}, 0).ok());
  EXPECT_EQ(memory_->counters().ground, 1u);
  EXPECT_EQ(ids().count(1), 0u);
}

}  // namespace
}  // namespace surefoot::objects
