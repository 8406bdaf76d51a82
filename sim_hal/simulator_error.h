#pragma once

#include <stdexcept>

namespace surefoot::sim {

// Wrong configuration or an unreadable world file. what() names the file and line, or the key.
class SimulatorError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace surefoot::sim
