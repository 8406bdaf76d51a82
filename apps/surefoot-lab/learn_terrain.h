// `surefoot-lab learn terrain`: what a robot takes along about ground it will not see
// (core/terrain/terrain_model.h), learned from generated rocks as its own camera would see them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace surefoot::apps {

struct LearnTerrainOptions {
  std::string robot;  // name or file: its cells, its camera's place and view
  std::uint64_t first_seed = 0;
  std::uint64_t last_seed = 0;
  std::filesystem::path cache;
  std::filesystem::path out;  // the file
  int jobs = 1;
};

// Writes the file and prints the scales of the cost. Exit code: 2 for a wrong option or robot, 3
// where nothing could be made or written.
int learn_terrain(const LearnTerrainOptions& options);

}  // namespace surefoot::apps
