// Objects on recordings of planar scanners: people, a wood, a campus, an office, a park's trees.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/objects/object_map.h"
#include "tests/unit/objects/config.h"

namespace surefoot::real_data {
namespace {

using namespace objects;

std::string file_of(const char* name) {
  return SUREFOOT_SHARED_DATA "/lidar2d/" + std::string(name);
}

TimeNs seconds(double s) { return {static_cast<std::int64_t>(s * 1e9)}; }

// The recordings' scanners stand level. Everything they see stands on the ground, 1 m below.
ObjectsConfig level_config() {
  ObjectsConfig config = objects::test::config();
  config.max_slope = 0;
  config.min_range_m = 0.05;
  return config;
}

struct Planar {
  double x = 0;
  double y = 0;
  double yaw = 0;
};

class Objects2d : public testing::Test {
 protected:
  void reset(const ObjectsConfig& config) { map_->reset(config); }
  void update(const hal::LidarScan& scan, const Planar& at) {
    const ScannerPose pose{geometry::rotation_z(at.yaw), {at.x, at.y, 0}};
    const auto began = std::chrono::steady_clock::now();
    ASSERT_EQ(map_->update(scan, {pose, pose}, {{at.x, at.y, -1}, {0, 0}}, nullptr), Status::kOk);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    total_s_ += took.count();
    worst_s_ = std::max(worst_s_, took.count());
    most_ = std::max(most_, map_->objects().size());
    ++scans_;
  }
  void report(const char* name) const {
    const ObjectCounters c = map_->counters();
    std::printf(
        "%s: %d scans, %.3f ms each (worst %.3f), %zu objects made, at most %zu at a time, %zu "
        "now; "
        "cleared %zu, far %zu, gave way %zu, refused %zu; lone points %zu, veils %zu\n",
        name, scans_, 1e3 * total_s_ / scans_, 1e3 * worst_s_,
        static_cast<std::size_t>(c.memory.made), most_, map_->objects().size(),
        static_cast<std::size_t>(c.memory.cleared), static_cast<std::size_t>(c.memory.far),
        static_cast<std::size_t>(c.memory.short_lived + c.memory.recent),
        static_cast<std::size_t>(c.memory.refused),
        static_cast<std::size_t>(c.segments.lone_points), static_cast<std::size_t>(c.beams.veil));
  }
  // Index of the object with a point nearest to a place.
  std::optional<std::size_t> at(const Vector2& p, double within_m) const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < map_->objects().size(); ++i) {
      for (const Vector2& q : map_->objects()[i].points_O_m) {
        if ((p - q).norm() >= within_m) continue;
        within_m = (p - q).norm();
        best = i;
      }
    }
    return best;
  }

  std::unique_ptr<ObjectMap> map_ = std::make_unique<ObjectMap>();
  double total_s_ = 0;
  double worst_s_ = 0;
  std::size_t most_ = 0;
  int scans_ = 0;
};

std::vector<std::vector<double>> read_numbers(const std::string& path, char separator,
                                              std::size_t skip_columns_of_text) {
  std::vector<std::vector<double>> rows;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), separator, ' ');
    std::istringstream words(line);
    std::vector<double> row;
    std::size_t column = 0;
    for (std::string word; words >> word; ++column) {
      if (column == skip_columns_of_text) continue;
      row.push_back(std::strtod(word.c_str(), nullptr));
    }
    rows.push_back(row);
  }
  return rows;
}

constexpr std::size_t kNoText = 1000000;

// t, angle_min, angle_inc, time_inc, range_min, range_max, n, ranges
hal::LidarScan people_scan(const std::vector<double>& row) {
  hal::LidarScan scan;
  scan.stamp = seconds(row[0] - 1.39e9);
  scan.first_angle_rad = static_cast<float>(row[1]);
  scan.angle_step_rad = static_cast<float>(row[2]);
  scan.beam_interval = seconds(row[3]);
  scan.beam_count = static_cast<std::uint16_t>(row[6]);
  for (std::size_t i = 0; i < scan.beam_count; ++i) {
    const double r = row[7 + i];
    scan.range_m[i] = std::isfinite(r) ? static_cast<float>(r) : 0.0F;
  }
  return scan;
}

TEST_F(Objects2d, PeoplesLegsAreFound) {
  for (const char* name : {"people_labelled_1", "people_labelled_4"}) {
    const std::string file = file_of(name);
    if (!std::filesystem::exists(file + ".csv")) GTEST_SKIP() << "no recording at " << file;
    const auto scans = read_numbers(file + ".csv", ',', 1);
    const auto labels = read_numbers(file + "_labels.csv", ',', 1);
    ASSERT_EQ(scans.size(), labels.size());
    reset(level_config());
    int found = 0;
    int count = 0;
    int moving = 0;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      update(people_scan(scans[k]), {});
      for (std::size_t i = 2; i + 1 < labels[k].size(); i += 2) {
        const auto object = at({labels[k][i], labels[k][i + 1]}, 0.2);
        ++count;
        found += object.has_value();
        moving += object.has_value() && map_->objects()[*object].moving;
      }
    }
    report(name);
    std::printf("  %d of %d labelled leg clusters found (%.3f), %.3f of them moving\n", found,
                count, 1.0 * found / count, 1.0 * moving / count);
    EXPECT_GE(found, 0.9 * count);
  }
}

TEST_F(Objects2d, ThoseWhoWalkThroughAnEmptyRoomLeaveNothingBehind) {
  const std::string file = file_of("people_stationary_simple.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  reset(level_config());
  int moving = 0;
  double fastest = 0;
  for (const auto& row : read_numbers(file, ',', 1)) {
    update(people_scan(row), {});
    bool any = false;
    for (const Object& object : map_->objects()) {
      any = any || object.moving;
      fastest = std::max(fastest, object.velocity_O_m_s.norm());
    }
    moving += any;
  }
  report("people_stationary_simple");
  int stale = 0;
  TimeNs newest;
  for (const Object& object : map_->objects()) newest = std::max(newest, object.last_seen);
  for (const Object& object : map_->objects()) {
    stale += newest - object.last_seen > milliseconds(5000) ? 1 : 0;
  }
  std::printf("  something moves in %d scans, at most at %.2f m/s; %d objects unseen for 5 s\n",
              moving, fastest, stale);
  EXPECT_GT(moving, 100);
  EXPECT_LT(fastest, 4.0);
  EXPECT_LE(stale, 3);
}

TEST_F(Objects2d, AWoodIsTrunksAndThickets) {
  const std::string file = file_of("forest_marv_ring.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  auto rows = read_numbers(file, ',', kNoText);
  std::reverse(rows.begin(), rows.end());  // its beams go clockwise
  hal::LidarScan scan;
  scan.beam_count = static_cast<std::uint16_t>(rows.size());
  scan.first_angle_rad = static_cast<float>(math::wrap_angle(rows[0][1]));
  scan.angle_step_rad = static_cast<float>(math::kTwoPi / 1024);
  std::vector<Vector2> returns;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    scan.range_m[i] = static_cast<float>(rows[i][2]);
    const double angle = rows[0][1] + static_cast<double>(i) * math::kTwoPi / 1024;
    if (rows[i][2] > 0.3 && rows[i][2] < 30) {
      returns.emplace_back(rows[i][2] * std::cos(angle), rows[i][2] * std::sin(angle));
    }
  }
  reset(level_config());
  for (int n = 0; n < 20; ++n) {
    scan.stamp = milliseconds(100 * n);
    update(scan, {});
  }
  int covered = 0;
  for (const Vector2& p : returns) covered += at(p, 0.25).has_value();
  int trunks = 0;
  for (std::size_t i = 0; i < map_->objects().size(); ++i) {
    trunks += map_->track(i).compact;
    EXPECT_FALSE(map_->objects()[i].moving);
  }
  report("forest_marv_ring");
  std::printf("  %d objects under 1.2 m, %zu longer; %.3f of the returns within 0.25 m of one\n",
              trunks, map_->objects().size() - static_cast<std::size_t>(trunks),
              1.0 * covered / static_cast<double>(returns.size()));
  EXPECT_GE(covered, 0.95 * static_cast<double>(returns.size()));
  EXPECT_GE(trunks, 10);
}

// Carmen's FLASER lines: n ranges, x y theta, odometry, ipc time.
void read_carmen(const char* name, double step_s,
                 const std::function<void(const hal::LidarScan&, const Planar&)>& use) {
  std::ifstream in(file_of(name));
  double clock_s = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("FLASER ", 0) != 0) continue;
    std::istringstream words(line.substr(7));
    std::size_t n = 0;
    words >> n;
    hal::LidarScan scan;
    scan.beam_count = static_cast<std::uint16_t>(n);
    for (std::size_t i = 0; i < n; ++i) {
      words >> scan.range_m[i];
      if (scan.range_m[i] >= 81.8F) scan.range_m[i] = 0;
    }
    const double step = math::kPi / static_cast<double>(n % 2 == 0 ? n : n - 1);
    scan.first_angle_rad = static_cast<float>(-0.5 * math::kPi);
    scan.angle_step_rad = static_cast<float>(step);
    Planar at;
    words >> at.x >> at.y >> at.yaw;
    clock_s += step_s;
    scan.stamp = seconds(clock_s);
    use(scan, at);
  }
}

TEST_F(Objects2d, CampusAndOfficeStayWithinBounds) {
  for (const char* name : {"fr_campus_part1.log", "intel.log"}) {
    const std::string file = file_of(name);
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
    reset(level_config());
    scans_ = 0;
    total_s_ = worst_s_ = 0;
    most_ = 0;
    int moving = 0;
    std::size_t objects = 0;
    read_carmen(name, 0.2, [&](const hal::LidarScan& scan, const Planar& at) {
      update(scan, at);
      objects += map_->objects().size();
      for (const Object& object : map_->objects()) moving += object.moving;
    });
    report(name);
    std::printf("  %.1f objects on average, %.4f of them moving\n",
                static_cast<double>(objects) / scans_, 1.0 * moving / static_cast<double>(objects));
    EXPECT_LT(moving, 0.02 * static_cast<double>(objects));
    EXPECT_EQ(map_->counters().memory.refused, 0u);
  }
}

struct Tree {
  Vector2 at_O_m = Vector2::Zero();
  std::uint32_t id = 0;
};

// The truck's odometry to the scanner's place (the data's README: wheel base 2.83 m, the scanner
// 3.78 m ahead of the rear axle and 0.5 m left).
class Truck {
 public:
  explicit Truck(const std::string& path) : inputs_(read_numbers(path, ',', kNoText)) {}
  Planar scanner_at(double t) {
    while (next_ < inputs_.size() && inputs_[next_][0] <= t) {
      move(inputs_[next_][0]);
      speed_ = inputs_[next_][1] / (1 - std::tan(inputs_[next_][2]) * 0.76 / 2.83);
      steer_ = inputs_[next_][2];
      ++next_;
    }
    move(t);
    return {axle_.x + 3.78 * std::cos(axle_.yaw) - 0.5 * std::sin(axle_.yaw),
            axle_.y + 3.78 * std::sin(axle_.yaw) + 0.5 * std::cos(axle_.yaw), axle_.yaw};
  }

 private:
  void move(double t) {
    const double dt = std::max(0.0, t - time_);
    axle_.x += speed_ * dt * std::cos(axle_.yaw);
    axle_.y += speed_ * dt * std::sin(axle_.yaw);
    axle_.yaw = math::wrap_angle(axle_.yaw + speed_ / 2.83 * std::tan(steer_) * dt);
    time_ = std::max(time_, t);
  }
  std::vector<std::vector<double>> inputs_;
  std::size_t next_ = 0;
  double time_ = 0;
  double speed_ = 0;
  double steer_ = 0;
  Planar axle_;
};

TEST_F(Objects2d, AParksTreesKeepTheirNames) {
  const std::string file = file_of("vp_trees_t0_900.txt");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const auto rows = read_numbers(file, ',', kNoText);
  Truck truck(file_of("vp_odometry_t0_900.txt"));
  ObjectsConfig config = level_config();
  config.max_range_m = 80;
  config.min_points = 1;
  reset(config);
  std::vector<Tree> before;
  int again = 0;
  int in_gate = 0;
  int same = 0;
  int moving = 0;
  int seen = 0;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first;
    while (end < rows.size() && rows[end][0] == rows[first][0]) ++end;
    const Planar at_O = truck.scanner_at(rows[first][0]);
    // The detections as the beams that would have hit the trunks.
    hal::LidarScan scan;
    scan.stamp = seconds(rows[first][0]);
    scan.beam_count = 361;
    scan.first_angle_rad = static_cast<float>(-0.5 * math::kPi);
    scan.angle_step_rad = static_cast<float>(math::kPi / 360);
    std::vector<Tree> trees;
    for (std::size_t k = first; k < end; ++k) {
      const double r = rows[k][1];
      const double bearing = rows[k][2];  // 0: right
      const int beam = static_cast<int>(std::lround(bearing / (math::kPi / 360)));
      const int half = static_cast<int>(0.5 * rows[k][3] / r / (math::kPi / 360));
      for (int i = std::max(0, beam - half); i <= std::min(360, beam + half); ++i) {
        float& range = scan.range_m[static_cast<std::size_t>(i)];
        if (!(range > 0) || range > static_cast<float>(r)) range = static_cast<float>(r);
      }
      const double angle = at_O.yaw + bearing - 0.5 * math::kPi;
      trees.push_back({{at_O.x + r * std::cos(angle), at_O.y + r * std::sin(angle)}, 0});
    }
    update(scan, at_O);
    for (Tree& tree : trees) {
      const auto i = at(tree.at_O_m, 0.6);
      if (!i.has_value()) continue;
      tree.id = map_->objects()[*i].id;
      ++seen;
      moving += map_->objects()[*i].moving;
      // Who it was: the nearest detection of the last scan, found without the tracker.
      const Tree* last = nullptr;
      double away = 1.5;
      for (const Tree& other : before) {
        if ((other.at_O_m - tree.at_O_m).norm() >= away) continue;
        away = (other.at_O_m - tree.at_O_m).norm();
        last = &other;
      }
      if (last == nullptr || last->id == 0) continue;
      ++again;
      in_gate += away < 0.7;
      same += last->id == tree.id;
    }
    before = trees;
    first = end;
  }
  report("victoria park");
  std::printf(
      "  %d detections, %d seen again in the next scan: %.4f within the gate, %.4f the same "
      "object, "
      "%.4f moving\n",
      seen, again, 1.0 * in_gate / again, 1.0 * same / again, 1.0 * moving / seen);
  EXPECT_GE(in_gate, 0.95 * again);
  EXPECT_GE(same, 0.95 * again);
}

}  // namespace
}  // namespace surefoot::real_data
