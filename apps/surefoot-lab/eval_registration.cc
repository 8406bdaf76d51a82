#include "apps/surefoot-lab/eval_registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/drawing.h"
#include "apps/common/statistics.h"
#include "apps/surefoot-lab/stopwatch.h"
#include "tests/support/registration_parts.h"
#include "tests/support/rocky_board.h"

namespace surefoot::apps {
namespace {

using registration::SourcePose;
using tests::kRadPerDeg;

struct Start {
  const char* name;
  double distance_m;
  double angle_rad;
};
constexpr std::array<Start, 2> kStarts{
    {{"near", 0.016, 1.4 * kRadPerDeg}, {"far", 0.048, 4.1 * kRadPerDeg}}};

// One board, scanned twice.
struct Scans {
  std::vector<Vector3> target;
  std::vector<Vector3> source;
  SourcePose truth;
};

Scans scan_board(std::uint64_t seed, int points, double slope, const Start& start) {
  tests::BoardOptions options;
  options.slope = slope;
  const tests::RockyBoard board(seed, options);
  Random random(seed, 5);
  Scans scans;
  scans.target = board.scan(-0.5 * options.side_m, points, random);
  const std::vector<Vector3> second =
      board.scan(options.shift_m - 0.5 * options.side_m, points, random);
  scans.truth = tests::random_motion(random, start.distance_m, start.angle_rad);
  scans.source = tests::seen_from(scans.truth, second);
  return scans;
}

struct Outcome {
  Status status = Status::kNotFound;
  double error_m = 0;
  double error_rad = 0;
  double ms = 0;
};

// Clouds are built and aligned; the time is that of both.
Outcome align(const Scans& scans, tests::Workbench& bench) {
  Outcome outcome;
  const double begin_us = processor_us();
  if (!bench.configure({})) return outcome;
  bench.fill(*bench.target, scans.target);
  bench.fill(*bench.source, scans.source);
  outcome.status = bench.align({{}, 0.1, 0.1});
  outcome.ms = 1e-3 * (processor_us() - begin_us);
  outcome.error_m = tests::distance_m(bench.result.X_TS, scans.truth);
  outcome.error_rad = tests::angle_rad(bench.result.X_TS, scans.truth);
  return outcome;
}

nlohmann::ordered_json run_start(const Start& start, const RegistrationOptions& options,
                                 tests::Workbench& bench) {
  std::vector<double> error_m;
  std::vector<double> error_deg;
  std::vector<double> ms;
  int failed = 0;
  int beyond_5_mm = 0;
  for (std::uint64_t seed = options.first_seed; seed <= options.last_seed; ++seed) {
    const Outcome outcome = align(scan_board(seed, options.points, options.slope, start), bench);
    error_m.push_back(outcome.error_m);
    error_deg.push_back(outcome.error_rad / kRadPerDeg);
    ms.push_back(outcome.ms);
    failed += ok(outcome.status) ? 0 : 1;
    beyond_5_mm += outcome.error_m > 0.005 ? 1 : 0;
  }
  nlohmann::ordered_json json;
  json["start_m"] = start.distance_m;
  json["start_deg"] = start.angle_rad / kRadPerDeg;
  json["runs"] = error_m.size();
  json["failed"] = failed;
  json["beyond_5_mm"] = beyond_5_mm;
  json["median_error_m"] = median(error_m);
  json["worst_error_m"] = *std::max_element(error_m.begin(), error_m.end());
  json["median_error_deg"] = median(error_deg);
  json["worst_error_deg"] = *std::max_element(error_deg.begin(), error_deg.end());
  json["median_processor_ms"] = median(ms);
  json["worst_processor_ms"] = *std::max_element(ms.begin(), ms.end());
  std::fputs(
      fmt::format("{:<5} {} boards: median {:.2f} mm, worst {:.2f} mm, {:.3f} deg; "
                  "{} failed; {:.1f} ms\n",
                  start.name, error_m.size(), 1e3 * median(error_m),
                  1e3 * json["worst_error_m"].get<double>(), median(error_deg), failed, median(ms))
          .c_str(),
      stdout);
  return json;
}

// A slice of both clouds, 2 cm thick, heights drawn five times too large.
void draw_slice(Drawing& drawing, const Rectangle& box, const std::string& title,
                const Scans& scans, const SourcePose& pose) {
  drawing.frame(box, {palette::kGrid, 1});
  drawing.text({box.x, box.y - 6}, title, {});
  const auto dots = [&](const Vector3& p, Colour colour) {
    if (p.y() < -0.01 || p.y() > 0.01) return;
    const Point at{box.x + (p.x() + 0.65) / 1.6 * box.width, box.bottom() - 20 - 1500 * p.z()};
    if (at.x >= box.x && at.x <= box.right() && at.y >= box.y && at.y <= box.bottom()) {
      drawing.dot(at, 1.6, colour);
    }
  };
  for (const Vector3& p : scans.target) dots(p, palette::kBlue);
  for (const Vector3& p : scans.source) {
    dots(pose.rotation.matrix * p + pose.origin.m, palette::kOrange);
  }
}

Drawing picture(const RegistrationOptions& options, tests::Workbench& bench) {
  const Scans scans = scan_board(options.first_seed, options.points, options.slope, kStarts.back());
  (void)align(scans, bench);
  Drawing drawing(900, 420);
  drawing.fill({0, 0, 900, 420}, palette::kPaper);
  draw_slice(drawing, {30, 30, 840, 165}, "Before: map blue, scan orange, slice at y = 0", scans,
             {});
  draw_slice(drawing, {30, 235, 840, 165}, "After", scans, bench.result.X_TS);
  return drawing;
}

}  // namespace

int eval_registration(const RegistrationOptions& options) {
  tests::Workbench bench;
  nlohmann::ordered_json json;
  json["schema"] = 1;
  json["points"] = options.points;
  json["slope"] = options.slope;
  json["seeds"] = {options.first_seed, options.last_seed};
  for (const Start& start : kStarts) json["starts"][start.name] = run_start(start, options, bench);
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path("out/eval-registration") : options.out;
  std::error_code error;
  std::filesystem::create_directories(out, error);
  const std::vector<std::uint8_t> png = to_png(picture(options, bench));
  std::ofstream image(out / "registration.png", std::ios::binary);
  image.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  std::ofstream text(out / "registration.json");
  text << json.dump(2) << '\n';
  if (!image.good() || !text.good()) {
    std::fputs(fmt::format("{}: cannot be written\n", out.string()).c_str(), stderr);
    return 3;
  }
  std::fputs(fmt::format("{}\n", (out / "registration.json").string()).c_str(), stdout);
  return 0;
}

int bench_registration() {
  tests::Workbench bench;
  int failed = 0;
  for (const int points : {2000, 8000, 20000}) {
    const Scans scans = scan_board(1, points, 0, kStarts.front());
    std::vector<double> ms;
    for (int round = 0; round < 40; ++round) {
      const Outcome outcome = align(scans, bench);
      failed += ok(outcome.status) ? 0 : 1;
      ms.push_back(outcome.ms);
    }
    std::fputs(fmt::format("registration: {:>6} points each, clouds, normals and {} steps: median "
                           "{:.2f} ms, most {:.2f} ms\n",
                           points, bench.result.iterations, median(ms),
                           *std::max_element(ms.begin(), ms.end()))
                   .c_str(),
               stdout);
  }
  return failed == 0 ? 0 : 3;
}

}  // namespace surefoot::apps
