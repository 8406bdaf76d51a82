// The layout of Surefoot's records: which channels there are and what their messages hold. The
// schema texts are generated from the structs' own field lists, one line for each member.
#pragma once

#include "hal/record/record_layout.h"

namespace surefoot::hal {

// What RecordWriter::open() is given by the application.
RecordLayout surefoot_record_layout();

}  // namespace surefoot::hal
