#include "hal/linux/memory_lock.h"

#include <alloca.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>

#ifndef MADV_POPULATE_READ
#define MADV_POPULATE_READ 22
#endif
#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23
#endif

namespace surefoot::hal {
namespace {

// Larger mappings are reservations (a sanitizer's shadow), not memory anyone means to use.
constexpr std::uintptr_t kLargestMapping = std::uintptr_t{1} << 30;
constexpr std::size_t kPage = 4096;
constexpr std::size_t kMaxStackBytes = std::size_t{4} << 20;  // half of the usual 8 MiB

struct Mapping {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;
  bool readable = false;
  bool writable = false;
};

// Mappings of the kernel's own ([vvar], [vsyscall]) cannot be populated.
bool parse_mapping(const char* line, Mapping& out) {
  char access[8] = {};
  char path[64] = {};
  if (std::sscanf(line, "%" SCNxPTR "-%" SCNxPTR " %7s %*s %*s %*s %63s", &out.begin, &out.end,
                  access, path) < 3) {
    return false;
  }
  out.readable = access[0] == 'r';
  out.writable = access[1] == 'w';
  return std::strncmp(path, "[v", 2) != 0;
}

// Fallback for kernels before 5.14. The atomic "or" of nothing writes without changing a byte that
// another thread may be changing.
void touch(const Mapping& mapping) {
  for (std::uintptr_t at = mapping.begin; at < mapping.end; at += kPage) {
    auto* byte = reinterpret_cast<std::uint8_t*>(at);
    if (mapping.writable) {
      __atomic_fetch_or(byte, std::uint8_t{0}, __ATOMIC_RELAXED);
    } else {
      static_cast<void>(*static_cast<volatile std::uint8_t*>(byte));
    }
  }
}

// Bytes made present; 0 when the mapping is none of ours.
std::size_t populate(const Mapping& mapping) {
  const std::size_t size = mapping.end - mapping.begin;
  if (!mapping.readable || size > kLargestMapping) return 0;
  const int advice = mapping.writable ? MADV_POPULATE_WRITE : MADV_POPULATE_READ;
  void* address = reinterpret_cast<void*>(mapping.begin);
  if (::madvise(address, size, advice) == 0) return size;
  // EINVAL: the kernel does not know the advice. Anonymous memory can be touched instead; a file
  // mapping may reach beyond its file and must not be.
  if (errno != EINVAL || !mapping.writable) return 0;
  touch(mapping);
  return size;
}

std::size_t populate_all() {
  std::FILE* maps = std::fopen("/proc/self/maps", "r");
  if (maps == nullptr) return 0;
  std::size_t total = 0;
  char line[512];
  while (std::fgets(line, sizeof(line), maps) != nullptr) {
    Mapping mapping;
    if (parse_mapping(line, mapping)) total += populate(mapping);
    // The rest of a line longer than the buffer is only a path.
    while (std::strchr(line, '\n') == nullptr && std::fgets(line, sizeof(line), maps) != nullptr) {
    }
  }
  std::fclose(maps);
  return total;
}

[[gnu::noinline]] void touch_stack(std::size_t bytes) {
  auto* stack = static_cast<volatile std::uint8_t*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += kPage) stack[i] = 0;
}

// A finite limit would let mlockall succeed now and make a later allocation fail: worse than not
// locking. Root is not bound by the limit.
bool lock_is_safe() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_MEMLOCK, &limit) != 0) return false;
  return limit.rlim_cur == RLIM_INFINITY || ::geteuid() == 0;
}

}  // namespace

MemoryLockReport lock_memory(std::size_t stack_bytes) {
  MemoryLockReport report;
  report.stack_bytes = std::min(stack_bytes, kMaxStackBytes);
  touch_stack(report.stack_bytes);
  if (!lock_is_safe()) {
    report.note = "memory not locked: RLIMIT_MEMLOCK is finite";
  } else if (::mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    report.locked = true;
    report.note = "memory locked";
    return report;
  } else {
    report.note = std::string("memory not locked: ") + std::strerror(errno);
  }
  report.populated_bytes = populate_all();
  report.note += "; faulted in " + std::to_string(report.populated_bytes >> 20) + " MiB instead";
  return report;
}

}  // namespace surefoot::hal
