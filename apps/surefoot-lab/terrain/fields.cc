#include "apps/surefoot-lab/terrain/fields.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim_hal/simulator_error.h"
#include "sim_hal/world/height_map_file.h"
#include "sim_hal/world/rock_field.h"

namespace surefoot::apps {
namespace {

constexpr double kLongest_m = 1.0;
constexpr double kShortest_m = 0.3;

sim::RockFieldOptions options_of(int bodies) {
  sim::RockFieldOptions options;
  options.bodies = bodies;
  return options;
}

// Every jobs-th of the seeds, from `first` on. The exit code of the child.
int make_fields(const std::filesystem::path& cache, const sim::RockFieldOptions& options,
                const std::vector<std::uint64_t>& seeds, std::size_t first, std::size_t jobs) {
  for (std::size_t i = first; i < seeds.size(); i += jobs) {
    try {
      (void)sim::cached_rock_field(cache, options, seeds[i]);
    } catch (const sim::SimulatorError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
  }
  return 0;
}

// Mean of the known of the eight neighbours, a ring a round, until all have a height.
void bridge_smoothly(sim::RawHeightMap& map) {
  std::vector<std::uint8_t> known = map.known;
  for (std::size_t round = 0; round < map.columns + map.rows; ++round) {
    std::vector<std::pair<std::size_t, double>> ring;
    for (std::size_t row = 0; row < map.rows; ++row) {
      for (std::size_t column = 0; column < map.columns; ++column) {
        if (known[map.index(row, column)] != 0) continue;
        double sum = 0;
        double count = 0;
        for (std::size_t r = row > 0 ? row - 1 : 0; r <= std::min(row + 1, map.rows - 1); ++r) {
          for (std::size_t c = column > 0 ? column - 1 : 0;
               c <= std::min(column + 1, map.columns - 1); ++c) {
            if (known[map.index(r, c)] == 0) continue;
            sum += map.z_m[map.index(r, c)];
            count += 1;
          }
        }
        if (count > 0) ring.emplace_back(map.index(row, column), sum / count);
      }
    }
    if (ring.empty()) return;
    for (const auto& [i, height] : ring) {
      map.z_m[i] = height;
      known[i] = 1;
    }
  }
}

// `columns` x `rows` millimetres from (x_mm, y_mm) of the scaled map on; heights as they are.
FineTerrain sample(const sim::RawHeightMap& map, double scale, std::int32_t y_mm,
                   std::int32_t columns, std::int32_t rows) {
  FineTerrain out;
  out.columns = columns;
  out.rows = rows;
  const double per_mm = FineTerrain::kStep_m / (map.cell_m * scale);
  for (std::int32_t j = 0; j < rows; ++j) {
    for (std::int32_t i = 0; i < columns; ++i) {
      // In cells, from the centre of the first one; the file begins with the northern row.
      const double u =
          std::clamp((i + 0.5) * per_mm - 0.5, 0.0, static_cast<double>(map.columns) - 1.001);
      const double v =
          std::clamp((y_mm + j + 0.5) * per_mm - 0.5, 0.0, static_cast<double>(map.rows) - 1.001);
      const auto c = static_cast<std::size_t>(u);
      const auto r = static_cast<std::size_t>(v);
      const double a = u - static_cast<double>(c);
      const double b = v - static_cast<double>(r);
      const auto at = [&](std::size_t row, std::size_t column) {
        return map.index(map.rows - 1 - row, column);
      };
      const double z = (1 - b) * ((1 - a) * map.z_m[at(r, c)] + a * map.z_m[at(r, c + 1)]) +
                       b * ((1 - a) * map.z_m[at(r + 1, c)] + a * map.z_m[at(r + 1, c + 1)]);
      out.z_m.push_back(static_cast<float>(scale * z));
      out.recorded.push_back(map.known[at(b < 0.5 ? r : r + 1, a < 0.5 ? c : c + 1)]);
    }
  }
  return out;
}

FineTerrain turned(FineTerrain terrain) {
  std::reverse(terrain.z_m.begin(), terrain.z_m.end());
  std::reverse(terrain.recorded.begin(), terrain.recorded.end());
  return terrain;
}

}  // namespace

std::vector<FineTerrain> recorded_terrain(const std::filesystem::path& file, double scale) {
  sim::RawHeightMap map = sim::read_height_map(file.string());
  sim::crop_to_known(map);
  bridge_smoothly(map);
  const auto millimetres = [&](std::size_t cells, double parts) {
    const double side_m =
        std::min(static_cast<double>(cells) * map.cell_m * scale / parts, kLongest_m);
    return static_cast<std::int32_t>(side_m / 0.01) * 10;  // whole cells of 1 cm
  };
  const std::int32_t columns = millimetres(map.columns, 1);
  const std::int32_t rows = millimetres(map.rows, 2);
  if (std::min(columns, rows) < kShortest_m * 1e3) {
    throw sim::SimulatorError(file.string() + ": too little ground after scaling");
  }
  std::vector<FineTerrain> out;
  for (const std::int32_t y_mm : {0, rows}) {
    out.push_back(sample(map, scale, y_mm, columns, rows));
    out.push_back(turned(out.back()));
  }
  return out;
}

bool prepare_fields(const std::filesystem::path& cache, int bodies,
                    const std::vector<std::uint64_t>& seeds, int jobs) {
  const sim::RockFieldOptions options = options_of(bodies);
  std::vector<std::uint64_t> missing;
  for (const std::uint64_t seed : seeds) {
    if (!std::filesystem::exists(sim::rock_field_file(cache, options, seed)))
      missing.push_back(seed);
  }
  if (missing.empty()) return true;
  std::fprintf(stderr, "making %zu rock fields, some 20 s each, into %s\n", missing.size(),
               cache.c_str());
  const auto processes = static_cast<std::size_t>(jobs);
  std::vector<pid_t> children;
  for (std::size_t k = 0; k < processes && k < missing.size(); ++k) {
    const pid_t child = fork();
    if (child == 0) _exit(make_fields(cache, options, missing, k, processes));
    if (child > 0) children.push_back(child);
  }
  bool good = !children.empty();
  for (const pid_t child : children) {
    int status = 0;
    good = waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0 &&
           good;
  }
  return good;
}

FineTerrain rock_terrain(const std::filesystem::path& cache, int bodies, std::uint64_t seed) {
  sim::RockField field = sim::cached_rock_field(cache, options_of(bodies), seed);
  FineTerrain terrain;
  terrain.columns = static_cast<std::int32_t>(field.columns);
  terrain.rows = static_cast<std::int32_t>(field.rows);
  terrain.z_m = std::move(field.z_m);
  return terrain;
}

void forget_gaps(ScannedTerrain& terrain) {
  terrain.bridged = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(terrain.seen.size()); ++i) {
    if (terrain.truth.knowledge[i] == terrain::Knowledge::kMeasured) continue;
    terrain.seen.knowledge[i] = terrain::Knowledge::kUnknown;
    terrain.seen.value_m[i] = 0;
  }
}

std::unique_ptr<ScannedTerrain> scan(const FineTerrain& terrain, int cell_mm, double noise_m,
                                     std::uint64_t seed, const ScanOptions& options) {
  auto out = std::make_unique<ScannedTerrain>();
  const FineScan seen = scan_terrain(terrain, options);
  to_grid(terrain, seen, cell_mm, noise_m, seed, out->seen);
  true_grid(terrain, cell_mm, out->truth);
  return out;
}

}  // namespace surefoot::apps
