// A bad sample: everything that core must not call. Only tests/rules compiles it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>

extern char** environ;

namespace surefoot {

void allowed(void* to, const void* from);

double forbidden(double x, std::size_t size, const void* from) {
  void* memory = std::malloc(size);
  std::memcpy(memory, from, size);
  allowed(memory, from);
  auto* numbers = new double[size];
  allowed(numbers, environ);
  if (std::clock() == 7) throw std::runtime_error("no");
  std::printf("%p", memory);
  return std::sin(x);
}

}  // namespace surefoot
