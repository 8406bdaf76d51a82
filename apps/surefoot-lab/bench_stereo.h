// `surefoot-lab bench stereo`: time and quality of the stereo matcher beside OpenCV's.
#pragma once

namespace surefoot::apps {

// Prints medians of one thread, OpenCV and ours in turn on the same pictures, and how good each
// result is. 0 done, 3 the matcher has more than 1.3 times the wrong pixels of OpenCV's SGBM.
int bench_stereo();

}  // namespace surefoot::apps
