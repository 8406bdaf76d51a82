// Puts every page of the process into memory before the first tick.
#pragma once

#include <cstddef>
#include <string>

namespace surefoot::hal {

struct MemoryLockReport {
  bool locked = false;              // mlockall(MCL_CURRENT | MCL_FUTURE) was granted
  std::size_t populated_bytes = 0;  // faulted in one by one because the lock was refused
  std::size_t stack_bytes = 0;      // of this thread's stack, touched
  std::string note;                 // one line for a person: what was granted, why not more
};

// Locks all memory; where that is refused (RLIMIT_MEMLOCK), faults in every mapping of
// /proc/self/maps, so that no first touch is left, though the system may still evict. Also touches
// `stack_bytes` of the calling thread's stack (256 KiB at most matter to a tick). Call at the end
// of start-up, from the thread that runs the ticks.
MemoryLockReport lock_memory(std::size_t stack_bytes = std::size_t{256} << 10);

}  // namespace surefoot::hal
