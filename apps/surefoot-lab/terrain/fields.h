// Terrain for the experiment: generated rock fields from the cache, or tiles of a recorded grid.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/surefoot-lab/terrain/fine_scan.h"
#include "apps/surefoot-lab/terrain/prior_training.h"

namespace surefoot::apps {

// Makes the rock fields of these seeds that the cache lacks, `jobs` at a time, each in a process of
// its own (ODE's random numbers belong to the process). False: one could not be made.
bool prepare_fields(const std::filesystem::path& cache, int bodies,
                    const std::vector<std::uint64_t>& seeds, int jobs);

// From the cache, or made. Throws sim::SimulatorError.
FineTerrain rock_terrain(const std::filesystem::path& cache, int bodies, std::uint64_t seed);

// A recorded height grid, scaled, at millimetres (bilinear). Gaps take the mean of their known
// neighbours, ring by ring. Cut in two across y; each half as it lies and turned by half a turn, so
// that it is walked over in both directions: {first, first turned, second, second turned}. At most
// 1 m of it along x and along y. Throws sim::SimulatorError: unreadable, or a half is under 0.3 m.
std::vector<FineTerrain> recorded_terrain(const std::filesystem::path& file, double scale);

// Takes what was invented out of what was seen.
void forget_gaps(ScannedTerrain& terrain);

// Scanned by the experiment's sensor, or as `options` say. noise_m as in to_grid().
std::unique_ptr<ScannedTerrain> scan(const FineTerrain& terrain, int cell_mm, double noise_m,
                                     std::uint64_t seed, const ScanOptions& options = {});

}  // namespace surefoot::apps
