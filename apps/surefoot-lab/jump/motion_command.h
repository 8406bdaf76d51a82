// surefoot-lab motion NAME: optimises a jump and writes its file.
#pragma once

#include <filesystem>
#include <string>

namespace surefoot::apps {

struct MotionOptions {
  std::string name;
  std::string robot;
  std::filesystem::path out;  // empty: config/motions/NAME.yaml
  bool verbose = false;
};

// 0: written. 1: no solution. 2: wrong use.
int make_motion_file(const MotionOptions& options);

}  // namespace surefoot::apps
