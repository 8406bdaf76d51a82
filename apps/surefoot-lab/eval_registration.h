// `surefoot-lab eval registration` and `surefoot-lab bench registration`: alignment of synthetic
// rocky boards with known geometry.
#pragma once

#include <cstdint>
#include <filesystem>

namespace surefoot::apps {

struct RegistrationOptions {
  std::uint64_t first_seed = 1;
  std::uint64_t last_seed = 10;
  int points = 8000;          // of each scan
  double slope = 0;           // of the board
  std::filesystem::path out;  // default: out/eval-registration
};

// Writes registration.json and registration.png (first seed, before and after). 0 done, 3 the
// folder cannot be written.
int eval_registration(const RegistrationOptions& options);

// Prints the processor time of one alignment. 0 done, 3 an alignment failed.
int bench_registration();

}  // namespace surefoot::apps
