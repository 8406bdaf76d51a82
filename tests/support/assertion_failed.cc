// The test programs' end of a broken invariant. Weak: a test that links hal/linux gets that one.
#include <cstdio>
#include <cstdlib>

#include "core/base/assert.h"

namespace surefoot {

[[gnu::weak]] void assertion_failed(const char* file, int line, const char* expression) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, expression);
  std::abort();
}

}  // namespace surefoot
