#include "apps/surefoot-lab/eval_traversability.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/common/config_root.h"
#include "apps/common/figures.h"
#include "apps/common/perceived_map.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/height_map_file.h"

namespace surefoot::apps {
namespace {

using mapping::Traversability;

constexpr std::array<const char*, 5> kNames{"unknown", "steppable", "unsteppable", "jump_only",
                                            "impassable"};
constexpr double kSmallestCell_m = 0.005;
constexpr double kLargestCell_m = 0.2;

int refuse(const std::string& why) {
  std::fputs((why + "\n").c_str(), stderr);
  return 2;
}

HeightGrid to_grid(const sim::RawHeightMap& raw, double scale) {
  const double cell = raw.cell_m * scale;
  HeightGrid grid(0, 0, static_cast<double>(raw.columns) * cell,
                  static_cast<double>(raw.rows) * cell, cell);
  for (std::size_t row = 0; row < raw.rows; ++row) {
    for (std::size_t column = 0; column < raw.columns; ++column) {
      const std::size_t from =
          raw.index(raw.rows - 1 - row, column);  // the file begins in the north
      if (raw.known[from] == 0) continue;
      grid.set(static_cast<int>(column), static_cast<int>(row), raw.z_m[from] * scale);
    }
  }
  return grid;
}

ClassGrid classify(const HeightGrid& grid, mapping::MappingConfig config,
                   const mapping::TraversabilityLimits& limits) {
  config.cell_size_m = grid.cell_m;
  const auto map = std::make_unique<mapping::ControlMap>();
  map->reset({grid.columns / 2, grid.rows / 2});
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = grid.index(column, row);
      if (grid.known[i] == 0) continue;
      mapping::MapCell& cell = *map->find({column, row});
      cell.height_m = grid.height_m[i];
      cell.state = mapping::CellState::kMeasured;
    }
  }
  return classify_map(*map, config, limits, Alignment{}, grid);
}

nlohmann::ordered_json to_json(const TraversabilityOptions& options, const HeightGrid& grid,
                               const ClassGrid& classes,
                               const mapping::TraversabilityLimits& limits) {
  std::array<std::uint64_t, kNames.size()> counts{};
  std::uint64_t known = 0;
  for (std::size_t i = 0; i < grid.known.size(); ++i) {
    if (grid.known[i] == 0) continue;
    ++known;
    ++counts[static_cast<std::size_t>(classes.classes[i])];
  }
  nlohmann::ordered_json json;
  json["schema"] = 1;
  json["file"] = options.file.string();
  json["scale"] = options.scale;
  json["cell_m"] = grid.cell_m;
  json["cells"] = grid.known.size();
  json["known"] = known;
  json["limits"] = {{"max_slope", limits.max_slope},   {"max_raise_m", limits.max_raise_m},
                    {"max_drop_m", limits.max_drop_m}, {"max_step_m", limits.max_step_m},
                    {"max_jump_m", limits.max_jump_m}, {"max_unknown", limits.max_unknown}};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    json["classes"][kNames[i]] = {
        {"cells", counts[i]},
        {"share_of_known",
         known == 0 ? 0.0 : static_cast<double>(counts[i]) / static_cast<double>(known)}};
  }
  return json;
}

bool write(const std::filesystem::path& out, const nlohmann::ordered_json& json,
           const Drawing& drawing) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  const std::vector<std::uint8_t> png = to_png(drawing);
  std::ofstream picture(out / "traversability.png", std::ios::binary);
  picture.write(reinterpret_cast<const char*>(png.data()),
                static_cast<std::streamsize>(png.size()));
  std::ofstream text(out / "traversability.json");
  text << json.dump(2) << '\n';
  return picture.good() && text.good();
}

}  // namespace

int eval_traversability(const TraversabilityOptions& options) {
  ConfigIssues issues;
  const Config config =
      load_config({options.robot, "flat", "cross", "sim", 1, {}}, config_folder(), issues);
  if (!issues.empty()) return refuse(to_string(issues));
  sim::RawHeightMap raw;
  try {
    raw = sim::read_height_map(options.file.string());
  } catch (const sim::SimulatorError& error) {
    return refuse(error.what());
  }
  const double cell_m = raw.cell_m * options.scale;
  if (!(cell_m >= kSmallestCell_m && cell_m <= kLargestCell_m)) {
    return refuse(fmt::format("{}: cells of {} m after scaling; {} to {} m can be classified",
                              options.file.string(), cell_m, kSmallestCell_m, kLargestCell_m));
  }
  if (raw.columns > mapping::kMapSide || raw.rows > mapping::kMapSide) {
    return refuse(fmt::format("{}: {} x {} cells; the map holds {} x {}", options.file.string(),
                              raw.columns, raw.rows, mapping::kMapSide, mapping::kMapSide));
  }
  const HeightGrid grid = to_grid(raw, options.scale);
  const mapping::TraversabilityLimits limits = class_limits(config);
  const ClassGrid classes = classify(grid, config.autonomy.mapping, limits);
  const nlohmann::ordered_json json = to_json(options, grid, classes, limits);
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path("out/eval-traversability") : options.out;
  if (!write(out, json, ground_figure(grid, classes))) {
    std::fputs(fmt::format("{}: cannot be written\n", out.string()).c_str(), stderr);
    return 3;
  }
  std::fputs(fmt::format("{} of {} cells known:", json["known"].get<std::uint64_t>(),
                         json["cells"].get<std::uint64_t>())
                 .c_str(),
             stdout);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const double share = json["classes"][kNames[i]]["share_of_known"].get<double>();
    std::fputs(fmt::format(" {} {:.1f} %", kNames[i], 100 * share).c_str(), stdout);
  }
  std::fputs(fmt::format("\n{}\n", (out / "traversability.png").string()).c_str(), stdout);
  return 0;
}

}  // namespace surefoot::apps
