// expect: ignoring return(ed)? value
#include "core/base/fixed_vector.h"

void keep(surefoot::FixedVector<int, 4>& items) {
#ifdef MUST_FAIL
  items.push_back(1);
#else
  if (!ok(items.push_back(1))) items.clear();
#endif
}
