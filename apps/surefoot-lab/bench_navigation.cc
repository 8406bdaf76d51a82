#include "apps/surefoot-lab/bench_navigation.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/navigation/navigator.h"
#include "tests/unit/navigation/parts.h"

namespace surefoot::apps {
namespace {

using navigation::NavigationConfig;
using navigation::NavigationState;
using navigation::Navigator;
using navigation::RobotPose;

constexpr std::size_t kForests = 60;
constexpr std::size_t kPlans = 5;  // one after the other on each forest
constexpr std::size_t kTicks = 400;

struct Case {
  std::uint32_t side_cells;
  double limit_ms;  // of the 99th percentile
};

constexpr Case kCases[] = {{200, 5.0}, {400, 20.0}};

// Posts over the whole map, 15 per 100 square metres, as many as the memory holds.
void plant(Random& random, double half_side_m, objects::Objects& objects) {
  objects.clear();
  const double wanted = 0.15 * 4.0 * half_side_m * half_side_m;
  const auto posts = std::min<std::size_t>(static_cast<std::size_t>(wanted), 512);
  for (std::size_t i = 0; i < posts; ++i) {
    objects::Object post;
    post.id = static_cast<std::uint32_t>(i);
    const double x = random.uniform(-half_side_m, half_side_m);
    const double y = random.uniform(-half_side_m, half_side_m);
    const double radius_m = random.uniform(0.05, 0.6);
    post.centre_O_m = Vector2(x, y);
    if (post.centre_O_m.norm() < 1.5) continue;
    for (int k = 0; k < 10; ++k) {
      const double turn_x = random.uniform(-radius_m, radius_m);
      const double turn_y = random.uniform(-radius_m, radius_m);
      static_cast<void>(post.points_O_m.push_back(post.centre_O_m + Vector2(turn_x, turn_y)));
    }
    static_cast<void>(objects.push_back(post));
  }
}

// Of this thread on its core: what else the machine does is not counted.
double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

template <class Work>
double spent_us(const Work& work) {
  const double begin = cpu_us();
  work();
  return cpu_us() - begin;
}

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

double print_line(const std::string& name, std::vector<double>& us) {
  std::sort(us.begin(), us.end());
  const double p99 = us[us.size() * 99 / 100];
  print(fmt::format("  {:<22} {:>8} {:>10.0f} {:>10.0f} {:>10.0f}\n", name, us.size(),
                    us[us.size() / 2], p99, us.back()));
  return p99;
}

bool bench_case(const Case& bench, Navigator& navigator, objects::Objects& objects) {
  NavigationConfig config = navigation::test::small_robot();
  config.map.side_cells = bench.side_cells;
  const double half_side_m = 0.5 * bench.side_cells * config.map.cell_m;
  Random random(bench.side_cells);
  std::vector<double> inside_us;
  std::vector<double> beyond_us;
  std::vector<double> tick_us;
  for (std::size_t forest = 0; forest < kForests; ++forest) {
    plant(random, half_side_m, objects);
    const bool inside = forest % 2 == 0;
    const double way_m = inside ? 0.9 * half_side_m : 1.8 * half_side_m;
    const double side_m = random.uniform(-0.9, 0.9) * half_side_m;
    if (!ok(navigator.reset(config)) || !ok(navigator.set_goal({way_m, side_m}))) return false;
    TimeNs stamp;
    for (std::size_t i = 0; i < kPlans; ++i) {
      const RobotPose robot{Vector2(0.5 * static_cast<double>(i), 0), 0};
      std::vector<double>& us = inside ? inside_us : beyond_us;
      us.push_back(spent_us([&] { navigator.plan(objects, robot, stamp); }));
      for (std::size_t tick = 0; tick < kTicks / kPlans; ++tick) {
        stamp = stamp + milliseconds(5);
        tick_us.push_back(spent_us([&] { navigator.follow(robot, objects, stamp); }));
      }
    }
  }
  const std::string size = fmt::format("{0}x{0}", bench.side_cells);
  const double worst = print_line(size + " goal inside", inside_us);
  print_line(size + " goal beyond", beyond_us);
  print_line(size + " follower tick", tick_us);
  return worst <= bench.limit_ms * 1000;
}

}  // namespace

int bench_navigation() {
  print(fmt::format("navigation: {} plans on random forests per map; {} bytes\n", kForests * kPlans,
                    sizeof(Navigator)));
  print(fmt::format("  {:<22} {:>8} {:>10} {:>10} {:>10}\n", "", "runs", "median us", "99 % us",
                    "max us"));
  const auto navigator = std::make_unique<Navigator>();
  const auto objects = std::make_unique<objects::Objects>();
  bool good = true;
  for (const Case& bench : kCases) good = bench_case(bench, *navigator, *objects) && good;
  return good ? 0 : 3;
}

}  // namespace surefoot::apps
