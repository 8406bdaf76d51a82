// kOk is 0: "if (status)" would mean the opposite of what it reads like.
// expect: could not convert|not contextually convertible|value of type
#include "core/base/status.h"

bool succeeded(surefoot::Status status) {
#ifdef MUST_FAIL
  if (status) return true;
#else
  if (ok(status)) return true;
#endif
  return false;
}
