// A count of ticks or seconds is not a time.
// expect: could not convert|no matching function|cannot convert|no viable conversion|no known
// conversion
#include "core/base/time.h"

void wait_until(surefoot::TimeNs deadline);

void wait() {
#ifdef MUST_FAIL
  wait_until(20);
#else
  wait_until(surefoot::milliseconds(20));
#endif
}
