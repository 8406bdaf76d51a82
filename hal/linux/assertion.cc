// The handler of SUREFOOT_ASSERT on Linux.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "core/base/assert.h"

namespace surefoot {

void assertion_failed(const char* file, int line, const char* expression) {
  // One write(2) from the stack: the heap or stdio may be what is broken.
  char text[512];
  const int length =
      std::snprintf(text, sizeof(text), "%s:%d: assertion failed: %s\n", file, line, expression);
  if (length > 0) {
    const auto size = static_cast<std::size_t>(length) < sizeof(text)
                          ? static_cast<std::size_t>(length)
                          : sizeof(text) - 1;
    const ssize_t written = ::write(STDERR_FILENO, text, size);
    static_cast<void>(written);  // nowhere left to complain
  }
  std::abort();
}

}  // namespace surefoot
