// expect: ignoring return(ed)? value
#include "core/base/status.h"

surefoot::Result<int> read();

int use() {
#ifdef MUST_FAIL
  read();
  return 0;
#else
  const surefoot::Result<int> value = read();
  return value.ok() ? value.value() : -1;
#endif
}
