// Rock fields after the terrain paper's footnote 2: random convex bodies dropped into a box until
// they rest, sampled from above, smoothed by a random kernel, scaled. World frame: z up, the box's
// corner at the origin.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace surefoot::sim {

struct RockFieldOptions {
  int bodies = 200;
  double length_m = 1.0;  // of the box along x
  double width_m = 1.0;   // along y
  // Points of a body: Gaussian, the standard deviation per axis times a factor from [least, most).
  int points_per_body = 20;
  double point_deviation_m = 0.022;
  double least_factor = 0.6;
  double most_factor = 1.6;
  int kernel_side = 20;          // of the random kernel, samples
  double height_range_m = 0.14;  // highest minus lowest after scaling
};

// Height samples every millimetre: (i, j) lies at ((i + 0.5) mm, (j + 0.5) mm).
struct RockField {
  static constexpr double kStep_m = 0.001;

  std::size_t columns = 0;        // along x
  std::size_t rows = 0;           // along y
  std::vector<float> z_m;         // z_m[j * columns + i], lowest 0
  double simulated_s = 0;         // until the bodies were at rest
  double rest_speed_m_s = 0;      // the fastest body's when the simulation ended
  double deepest_contact_m = 0;   // penetration when it ended
  std::uint32_t lost_bodies = 0;  // outside of the box
  double scale = 1;               // applied to the heights

  float at(std::size_t i, std::size_t j) const { return z_m[j * columns + i]; }
};

inline std::size_t sample_count(double length_m) {
  return static_cast<std::size_t>(std::lround(length_m / RockField::kStep_m));
}

// The same options and seed give the same bits on one computer. Takes 16 to 72 s for the default
// options (one core). Uses ODE's process-wide random numbers: never from two threads at once.
// Throws SimulatorError: options that make no field.
RockField make_rock_field(const RockFieldOptions& options, std::uint64_t seed);

// The file in which `folder` keeps a field; its name holds seed, options and generator version.
std::filesystem::path rock_field_file(const std::filesystem::path& folder,
                                      const RockFieldOptions& options, std::uint64_t seed);

// $SUREFOOT_CACHE, else $XDG_CACHE_HOME/surefoot, else ~/.cache/surefoot, else a folder of the
// system's for temporary files.
std::filesystem::path rock_cache_folder();

// Reads the field from `folder` or makes it and puts it there. A damaged file is made anew. Files
// appear whole (written aside, then renamed), so several processes may share a folder.
// Throws SimulatorError: see above, or the folder cannot be written.
RockField cached_rock_field(const std::filesystem::path& folder, const RockFieldOptions& options,
                            std::uint64_t seed);

}  // namespace surefoot::sim
