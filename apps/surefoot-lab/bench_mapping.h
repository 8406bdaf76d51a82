// `surefoot-lab bench mapping`: filter and classes against OpenCV, insertion and clearing.
#pragma once

namespace surefoot::apps {

// Prints medians. 0 done, 3 the shipped configuration cannot be read or the parts do not do what is
// timed.
int bench_mapping();

}  // namespace surefoot::apps
