// Names of a record's channels and the text that describes their messages.
#pragma once

#include <string>
#include <vector>

#include "hal/api/record_sink.h"

namespace surefoot::hal {

struct RecordChannelInfo {
  RecordChannel channel;         // also the MCAP channel and schema id
  std::string topic;             // "/tick"
  std::string message_encoding;  // "x-surefoot-fields" or "x-text"
  std::string schema_name;       // "surefoot.Tick"
  std::string schema_encoding;   // "x-surefoot-fields"; empty: no schema
  std::string schema_text;
};

using RecordLayout = std::vector<RecordChannelInfo>;

}  // namespace surefoot::hal
