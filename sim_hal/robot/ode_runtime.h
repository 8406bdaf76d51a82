// ODE's process-wide state: initialised once, its messages counted.
#pragma once

#include <cstdint>

namespace surefoot::sim {

// Initialises ODE on the first call; later calls only make sure that this thread has its data.
// Throws SimulatorError when ODE is not double precision.
void start_ode();

// Warnings ODE has reported in this process so far. Its errors stop the program.
std::uint64_t ode_messages();

}  // namespace surefoot::sim
