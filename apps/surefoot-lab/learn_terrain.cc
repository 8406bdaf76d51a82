#include "apps/surefoot-lab/learn_terrain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/common/config_root.h"
#include "apps/surefoot-lab/terrain/fields.h"
#include "apps/surefoot-lab/terrain/fill_methods.h"
#include "core/terrain/terrain_model.h"

namespace surefoot::apps {
namespace {

// Of the generator's 0.14 m: the boards a robot is sent over are as high as this, or half of it.
constexpr double kHighest = 0.86;
constexpr double kLow = 0.43;
constexpr auto kColumns = static_cast<std::int32_t>(terrain::kModelColumns);
constexpr auto kRows = static_cast<std::int32_t>(terrain::kModelRows);
constexpr int kBodies = 200;
constexpr double kNoise_m = 0.002;  // of heights and ceilings: a prior for what cameras see

ScanOptions scan_options(const Config& config) {
  const robot::StereoCameraSpecification& camera = config.robot.stereo_camera;
  const robot::StereoLens& lens = camera.calibration.left;
  ScanOptions options;
  options.view_x_rad = 2 * std::atan(0.5 * camera.calibration.width_px / lens.matrix[0]);
  options.view_y_rad = 2 * std::atan(0.5 * camera.calibration.height_px / lens.matrix[4]);
  options.tilt_rad = camera.mount.roll_pitch_yaw_rad[1];
  options.height_m = config.autonomy.control.body.height_m + camera.mount.position_B_m[2];
  options.step_m = 0.25 * config.autonomy.control.static_walk.max_stride_m;
  options.range_m = camera.max_range_m;
  return options;
}

int cell_mm_of(const Config& config) {
  return static_cast<int>(std::lround(1e3 * config.autonomy.mapping.cell_size_m));
}

std::unique_ptr<ScannedTerrain> scanned(const LearnTerrainOptions& options, const Config& config,
                                        std::uint64_t seed) {
  FineTerrain terrain = rock_terrain(options.cache, kBodies, seed);
  const double scale = seed % 2 == options.first_seed % 2 ? kHighest : kLow;
  for (float& z_m : terrain.z_m) z_m *= static_cast<float>(scale);
  return scan(terrain, cell_mm_of(config), kNoise_m, seed, scan_options(config));
}

std::string joined(const auto& values, const char* form) {
  std::string text;
  for (const auto& value : values) {
    text += (text.empty() ? "" : ", ") + fmt::format(fmt::runtime(form), value);
  }
  return text;
}

std::string model_text(const LearnTerrainOptions& options, const ScannedTerrain& piece,
                       const terrain::HeightPrior& prior) {
  const std::size_t points = terrain::kModelPriorPoints;
  const auto begin = prior.weights.begin();
  std::string text = fmt::format(
      "# Made by `surefoot-lab learn terrain --robot {} --seeds {}..{}`: rocks to draw patches "
      "from, and the\n# prior of unseen ground (core/terrain/README.md).\n"
      "cell_m: {}\nseed: {}\nrows:\n",
      options.robot, options.first_seed, options.last_seed, prior.cell_m, options.first_seed);
  for (std::int32_t row = 0; row < std::min(piece.truth.rows, kRows); ++row) {
    std::vector<double> heights;
    for (std::int32_t column = 0; column < kColumns; ++column) {
      heights.push_back(static_cast<double>(piece.truth.value_m[piece.truth.index(column, row)]));
    }
    text += fmt::format("  - heights_m: [{}]\n", joined(heights, "{:.4f}"));
  }
  text += fmt::format("prior_residual_m: {:.6f}\n", prior.residual_m);
  text += fmt::format("prior_heights: [{}]\n",
                      joined(std::vector<float>(begin, begin + points), "{:.6g}"));
  text += fmt::format("prior_measured: [{}]\n",
                      joined(std::vector<float>(begin + points, begin + 2 * points), "{:.6g}"));
  text += fmt::format("prior_constant: {:.6g}\n", prior.weights[2 * points]);
  return text;
}

void print_scales(const terrain::CostConfig& cost) {
  const auto print = [](const char* name, const terrain::FeatureCost& feature) {
    std::fputs(
        fmt::format("  {}:\n    scale: [{}]\n", name, joined(feature.scale, "{:.4g}")).c_str(),
        stdout);
  };
  std::fputs("cost:  # scales: what 95 of 100 cells stay below\n", stdout);
  print("slope", cost.slope);
  print("height_difference", cost.height_difference);
  print("deviation", cost.deviation);
  print("roughness", cost.roughness);
}

int learn(const LearnTerrainOptions& options, const Config& config) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = options.first_seed; seed <= options.last_seed; ++seed) {
    seeds.push_back(seed);
  }
  if (!prepare_fields(options.cache, kBodies, seeds, options.jobs)) return 3;
  std::vector<std::unique_ptr<ScannedTerrain>> pieces;
  std::vector<const ScannedTerrain*> library;
  for (const std::uint64_t seed : seeds) {
    pieces.push_back(scanned(options, config, seed));
    library.push_back(pieces.back().get());
  }
  const int cell_mm = cell_mm_of(config);
  const FillMaterial material = make_material(library, cell_mm, improved_config(cell_mm));
  if (material.prior.radius != terrain::kModelPriorRadius || material.prior.stride != 1 ||
      library.front()->truth.columns < kColumns) {
    std::fputs("learn terrain: cells of this size do not fit a model\n", stderr);
    return 3;
  }
  std::ofstream file(options.out);
  file << model_text(options, *library.front(), material.prior);
  if (!file.good()) {
    std::fputs(fmt::format("{}: cannot be written\n", options.out.string()).c_str(), stderr);
    return 3;
  }
  print_scales(material.cost);
  return 0;
}

}  // namespace

int learn_terrain(const LearnTerrainOptions& options) {
  RunRequest request;
  request.robot = options.robot;
  ConfigIssues issues;
  const Config config = load_config_parts(request, config_folder(), issues);
  for (const ConfigIssue& issue : issues) std::fputs((to_string(issue) + "\n").c_str(), stderr);
  if (!issues.empty()) return 2;
  if (!config.robot.stereo_camera.present) {
    std::fputs("learn terrain: the robot has no stereo camera\n", stderr);
    return 2;
  }
  try {
    return learn(options, config);
  } catch (const std::exception& error) {
    std::fputs(fmt::format("learn terrain: {}\n", error.what()).c_str(), stderr);
    return 3;
  }
}

}  // namespace surefoot::apps
