// How often a test repeats what it draws: in full where it runs by itself, less often where qemu
// runs it twenty times slower. The emulated run looks for what another CPU does differently, and
// that shows in a few samples; what is rare is looked for by the full run.
#pragma once

namespace surefoot::tests {

constexpr int samples(int in_full, int emulated) {
  return SUREFOOT_EMULATED != 0 ? emulated : in_full;
}

}  // namespace surefoot::tests
