// `surefoot-lab bench`: how long the parts take on this computer.
#pragma once

#include <string>

#include "apps/common/stack.h"

namespace surefoot::apps {

// run: one crossing of a clutter field without record and pictures: task times and real-time
// factor. pictures: drawing and encoding. mapping: bench_mapping.h. mpc: bench_mpc.h.
// stereo: bench_stereo.h. terrain: bench_terrain.h.
// Empty name: all. 0 done, 2 unknown name or refused configuration, 3 a run could not be made,
// mapping differs from OpenCV, predictive control or the fill of terrain misses its bounds.
int bench(const std::string& name, Stack& stack);

}  // namespace surefoot::apps
