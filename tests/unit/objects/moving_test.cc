// People, posts and who is who.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/objects/object_map.h"
#include "tests/unit/objects/config.h"
#include "tests/unit/objects/scan_world.h"

namespace surefoot::objects {
namespace {

using test::plane_at;
using test::pose_at;
using test::Post;
using test::ScanWorld;
using test::still;

constexpr double kScan_s = 1.0 / 75;
// So that nobody walks through another: 0.9 m apart at the least.
constexpr std::array<double, 3> kSpeed_m_s{1.0, 1.1, 0.8};
constexpr std::array<double, 3> kPhase_rad{0.0, 3.5, 0.3};
constexpr double kFirstLine_rad = 0.9;
constexpr double kBetweenLines_rad = 1.05;

TimeNs at_scan(int n) { return {static_cast<std::int64_t>(n) * 13'333'333}; }

class Moving : public testing::Test {
 protected:
  Moving() {
    map_->reset(test::config());
    world_.ground.present = false;
  }
  void look(int n, double x = 0, double y = 0, double yaw = 0) {
    const ScanPoses poses = still(pose_at(x, y, 0.9, 0, yaw));
    ASSERT_EQ(map_->update(world_.scan(poses, at_scan(n), random_), poses, plane_at(x, y), nullptr),
              Status::kOk);
  }
  // The nearest object's index.
  std::optional<std::size_t> nearest(const Vector2& p, double within_m = 0.6) const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < map_->objects().size(); ++i) {
      const double away = (map_->track(i).position_O_m - p).norm();
      if (away < within_m) {
        within_m = away;
        best = i;
      }
    }
    return best;
  }

  ScanWorld world_;
  Random random_{21};
  std::unique_ptr<ObjectMap> map_ = std::make_unique<ObjectMap>();
};

// Two legs of 8 cm radius that swing past each other, or one cylinder.
void put_person(ScanWorld& world, const Vector2& at, const Vector2& velocity, double t, bool legs) {
  if (!legs) {
    world.posts.push_back({at, 0.25, 3});
    return;
  }
  const double speed = velocity.norm();
  const Vector2 along = speed > 0 ? Vector2(velocity / speed) : Vector2(1, 0);
  const Vector2 side(-along[1], along[0]);
  const double swing = speed > 0 ? 0.22 * std::sin(math::kTwoPi * 0.9 * t) : 0;
  world.posts.push_back({at + along * swing + side * 0.1, 0.08, 3});
  world.posts.push_back({at - along * swing - side * 0.1, 0.08, 3});
}

TEST_F(Moving, WalkersAreFoundMovingWithinSixTenthsOfASecond) {
  for (const bool legs : {false, true}) {
    for (const double speed : {0.5, 1.0, 1.5}) {
      for (const double heading : {0.0, 0.8, 1.6, 2.4, 3.1}) {
        map_->reset(test::config());
        const Vector2 velocity(speed * std::cos(heading), speed * std::sin(heading));
        double found_s = -1;
        double error = 0;
        for (int n = 0; n < 150; ++n) {
          const double t = n * kScan_s;
          world_.posts.clear();
          const Vector2 at = Vector2(5, 0) + velocity * (t - 1);
          put_person(world_, at, velocity, t, legs);
          look(n);
          const auto i = nearest(at);
          ASSERT_TRUE(i.has_value());
          const Object& object = map_->objects()[*i];
          if (object.moving && found_s < 0) found_s = t;
          if (n > 75) error = std::max(error, (object.velocity_O_m_s - velocity).norm());
        }
        std::printf("%s at %.1f m/s, heading %.1f: moving after %.2f s, velocity within %.2f m/s\n",
                    legs ? "legs    " : "cylinder", speed, heading, found_s, error);
        EXPECT_GE(found_s, 0);
        EXPECT_LE(found_s, 0.6);
        EXPECT_LT(error, legs ? 0.5 : 0.2);
      }
    }
  }
}

TEST_F(Moving, TrunksStandWhileTheRobotWalksBy) {
  for (int i = 0; i < 8; ++i) {
    world_.posts.push_back({{2.0 + 2.5 * i, i % 2 == 0 ? 1.2 : -1.6}, 0.1 + 0.03 * i, 3});
  }
  world_.posts.push_back({{9, 4}, 0.3, 3});
  double fastest = 0;
  for (int n = 0; n < 1500; ++n) {
    look(n, 1.0 * n * kScan_s);
    for (std::size_t i = 0; i < map_->objects().size(); ++i) {
      ASSERT_FALSE(map_->objects()[i].moving) << n;
      if (!map_->track(i).matched || map_->objects()[i].tracked_s < 0.6) continue;
      fastest = std::max(fastest, map_->track(i).velocity_O_m_s.norm());
    }
  }
  const auto made = static_cast<std::size_t>(map_->counters().memory.made);
  std::printf("%zu trunks: %zu objects made, none moving; inside, the filter's fastest %.2f m/s\n",
              world_.posts.size(), made, fastest);
  EXPECT_LE(made, world_.posts.size() + 3);
}

TEST_F(Moving, TwentyPostsAndThreeCrossingWalkersKeepTheirNames) {
  std::vector<Post> posts;
  Random places(8);
  while (posts.size() < 20) {
    const double x = places.uniform(1.5, 12);
    const double y = places.uniform(-6, 6);
    bool apart = true;
    for (const Post& p : posts) apart = apart && (p.centre_m - Vector2(x, y)).norm() > 1.3;
    // Nobody walks through a post, but past it with 0.3 m between.
    for (int w = 0; w < 3; ++w) {
      const double angle = kFirstLine_rad + kBetweenLines_rad * w;
      const double off = (x - 6) * std::sin(angle) - y * std::cos(angle);
      apart = apart && std::abs(off) > 0.65;
    }
    if (apart) posts.push_back({{x, y}, 0.1, 3});
  }
  std::map<int, std::uint32_t> name;
  std::map<int, double> seen_s;
  int swaps = 0;
  int renamed = 0;
  int after_hiding = 0;
  int moving_posts = 0;
  double closest = 1e9;
  for (int n = 0; n < 60 * 75; ++n) {
    const double t = n * kScan_s;
    world_.posts = posts;
    std::vector<Vector2> walkers;
    for (int w = 0; w < 3; ++w) {
      // To and fro on three lines that cross.
      const auto k = static_cast<std::size_t>(w);
      const double s = 5 * std::sin(kSpeed_m_s[k] * t / 5 + kPhase_rad[k]);
      const double angle = kFirstLine_rad + kBetweenLines_rad * w;
      walkers.emplace_back(6 + s * std::cos(angle), s * std::sin(angle));
      world_.posts.push_back({walkers.back(), 0.25, 3});
    }
    closest = std::min({closest, (walkers[0] - walkers[1]).norm(), (walkers[1] - walkers[2]).norm(),
                        (walkers[2] - walkers[0]).norm()});
    look(n);
    const auto check = [&](int who, const Vector2& at) {
      const auto i = nearest(at, 0.35);
      if (!i.has_value() || !map_->track(*i).matched) return;
      const std::uint32_t id = map_->objects()[*i].id;
      const auto [known, fresh] = name.emplace(who, id);
      const double hidden_s = t - seen_s[who];
      seen_s[who] = t;
      if (!fresh && known->second != id) {
        bool other = false;
        for (const auto& [someone, his] : name) other = other || (someone != who && his == id);
        ++(other ? swaps : hidden_s > 0.5 ? after_hiding : renamed);
        known->second = id;
      }
    };
    for (int k = 0; k < 20; ++k) check(k, posts[static_cast<std::size_t>(k)].centre_m);
    for (int w = 0; w < 3; ++w) check(100 + w, walkers[static_cast<std::size_t>(w)]);
    for (const Object& object : map_->objects()) {
      if (!object.moving) continue;
      double away = 1e9;
      for (const Vector2& w : walkers) away = std::min(away, (object.centre_O_m - w).norm());
      moving_posts += away > 1.0;
    }
  }
  std::printf(
      "60 s: %d swaps, %d renamed in sight, %d after half a second hidden, %d scans with a moving "
      "post, walkers %.2f m apart\n",
      swaps, renamed, after_hiding, moving_posts, closest);
  EXPECT_LE(swaps, 1);
  EXPECT_LE(renamed, 5);
  EXPECT_LE(moving_posts, 45);
}

TEST_F(Moving, WhoLeftIsGoneWithinTwoSecondsOfSight) {
  world_.walls.push_back({{12, -10}, {12, 10}, 5});
  for (int n = 0; n < 75; ++n) {
    world_.posts.assign(1, {{4, 0}, 0.25, 3});
    look(n);
  }
  ASSERT_TRUE(nearest({4, 0}).has_value());
  world_.posts.clear();
  int n = 75;
  while (n < 300 && nearest({4, 0}, 1.0).has_value()) look(n++);
  std::printf("gone after %.2f s\n", (n - 75) * kScan_s);
  EXPECT_LT((n - 75) * kScan_s, 2.0);
  EXPECT_EQ(map_->counters().memory.cleared, 1u);
}

TEST_F(Moving, WhatIsBehindTheRobotOrHiddenStays) {
  world_.posts = {{{3, 0}, 0.2, 3}, {{4, 3}, 0.2, 3}};
  for (int n = 0; n < 75; ++n) look(n);
  const std::uint32_t id = map_->objects()[*nearest({3, 0})].id;
  for (int n = 75; n < 300; ++n) look(n, 0, 0, math::kPi);  // turned away
  ASSERT_TRUE(nearest({3, 0}).has_value());
  // Somebody stands before it.
  world_.posts.push_back({{1.5, 0}, 0.4, 3});
  for (int n = 300; n < 450; ++n) look(n);
  ASSERT_TRUE(nearest({3, 0}).has_value());
  EXPECT_EQ(map_->objects()[*nearest({3, 0})].id, id);
  world_.posts.pop_back();
  for (int n = 450; n < 600; ++n) look(n);
  EXPECT_EQ(map_->objects()[*nearest({3, 0})].id, id) << "seen again, the same";
}

}  // namespace
}  // namespace surefoot::objects
