// `surefoot-lab eval traversability FILE`: the filter and the classes of core/mapping on a real
// height grid.
#pragma once

#include <filesystem>
#include <string>

namespace surefoot::apps {

struct TraversabilityOptions {
  std::filesystem::path file;  // ESRI ASCII grid or 16-bit PNG, as for --world heightmap:
  double scale = 1;            // of lengths and heights
  std::string robot;           // name or file: its reach and clearance set the classes
  std::filesystem::path out;   // folder; empty: out/eval-traversability
};

// Writes traversability.json (cell_m, cells, known, limits, count and share of known of every
// class) and traversability.png. Cells without data stay unknown, nothing is bridged but the
// classifier's own holes. 0 done; 2 wrong file or configuration, named on stderr; 3 cannot write.
int eval_traversability(const TraversabilityOptions& options);

}  // namespace surefoot::apps
