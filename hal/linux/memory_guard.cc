#include "hal/linux/memory_guard.h"

#include <execinfo.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "core/base/assert.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SUREFOOT_INTERPOSE_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SUREFOOT_INTERPOSE_MALLOC 0
#endif
#endif
#ifndef SUREFOOT_INTERPOSE_MALLOC
#define SUREFOOT_INTERPOSE_MALLOC 1
#endif

namespace surefoot::hal {
namespace {

// The interposed functions have no object to belong to, so this is the one piece of state that
// hangs on the thread. Plain data: reading it allocates nothing.
struct ThreadHeapState {
  bool counting;
  bool trap;
  std::uint64_t calls;
};
thread_local ThreadHeapState t_heap{false, false, 0};

std::uint64_t thread_page_faults() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

bool trap_wanted() {
  const char* wish = std::getenv("SUREFOOT_HEAP_TRAP");
  return wish != nullptr && std::strcmp(wish, "1") == 0;
}

[[maybe_unused]] void trap() {
  t_heap.counting = false;
  constexpr char kText[] = "heap call under memory guard:\n";
  const ssize_t written = ::write(STDERR_FILENO, kText, sizeof(kText) - 1);
  static_cast<void>(written);
  void* frames[48];
  ::backtrace_symbols_fd(frames, ::backtrace(frames, 48), STDERR_FILENO);
  std::abort();
}

[[maybe_unused]] inline void count_heap_call() {
  if (!t_heap.counting) [[likely]] {
    return;
  }
  ++t_heap.calls;
  if (t_heap.trap) trap();
}

}  // namespace

bool heap_counting_available() { return SUREFOOT_INTERPOSE_MALLOC != 0; }

void MemoryGuard::arm() {
  SUREFOOT_ASSERT(!armed_ && !t_heap.counting);
  if (!t_heap.trap && trap_wanted()) {
    void* frame = nullptr;
    ::backtrace(&frame, 1);  // its first call loads a library, which allocates
    t_heap.trap = true;
  }
  armed_ = true;
  at_arm_.heap_calls = t_heap.calls;
  at_arm_.page_faults = thread_page_faults();
  t_heap.counting = true;
}

void MemoryGuard::disarm() {
  SUREFOOT_ASSERT(armed_ && t_heap.counting);
  t_heap.counting = false;
  armed_ = false;
  counts_.heap_calls += t_heap.calls - at_arm_.heap_calls;
  counts_.page_faults += thread_page_faults() - at_arm_.page_faults;
}

void TickMemoryGuard::do_begin_tick_body() {
  if (remaining_ > 0) {
    --remaining_;
    return;
  }
  ++guarded_;
  guard_.arm();
}

void TickMemoryGuard::do_end_tick_body() {
  if (guard_.armed()) guard_.disarm();
}

}  // namespace surefoot::hal

#if SUREFOOT_INTERPOSE_MALLOC
// The C library's own functions under their internal names, present in every glibc.
extern "C" {
void* __libc_malloc(std::size_t size);
void __libc_free(void* pointer);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* pointer, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  surefoot::hal::count_heap_call();
  return __libc_malloc(size);
}

void free(void* pointer) noexcept {
  if (pointer != nullptr) surefoot::hal::count_heap_call();
  __libc_free(pointer);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  surefoot::hal::count_heap_call();
  return __libc_calloc(count, size);
}

void* realloc(void* pointer, std::size_t size) noexcept {
  surefoot::hal::count_heap_call();
  return __libc_realloc(pointer, size);
}

void* reallocarray(void* pointer, std::size_t count, std::size_t size) noexcept {
  std::size_t total = 0;
  if (__builtin_mul_overflow(count, size, &total)) {
    errno = ENOMEM;
    return nullptr;
  }
  surefoot::hal::count_heap_call();
  return __libc_realloc(pointer, total);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  surefoot::hal::count_heap_call();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  surefoot::hal::count_heap_call();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  const bool power_of_two = alignment != 0 && (alignment & (alignment - 1)) == 0;
  if (!power_of_two || alignment % sizeof(void*) != 0) return EINVAL;
  surefoot::hal::count_heap_call();
  void* pointer = __libc_memalign(alignment, size);
  if (pointer == nullptr) return ENOMEM;
  *out = pointer;
  return 0;
}
}  // extern "C"
#endif
