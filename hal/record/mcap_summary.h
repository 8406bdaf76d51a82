// The head and the tail of a record file: what does not depend on time. Private to hal/record.
#pragma once

#include <cstdint>

#include "hal/record/mcap_format.h"
#include "hal/record/record_layout.h"

namespace surefoot::hal::mcap {

// Magic, Header, and a Schema and Channel record for each channel of the layout.
void append_head(const RecordLayout& layout, Bytes& out);

// DataEnd, summary (schemas, channels, chunk index, statistics, offsets), footer and magic of a
// file whose data section ends at `data_end`. The chunks are found by walking through the open
// file, so that nothing has to be kept in memory while recording, however long the run. false: the
// file could not be read back; out then holds DataEnd and a footer without a summary.
bool append_tail(int file, const RecordLayout& layout, std::uint64_t data_end,
                 std::uint32_t data_crc, Bytes& out);

}  // namespace surefoot::hal::mcap
