// The autonomy and the executive with their task table: the program's one big static object.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "apps/common/config_root.h"
#include "core/autonomy/autonomy.h"
#include "core/runtime/executive.h"

namespace surefoot::apps {

class Stack {
 public:
  // Resets the autonomy, fills the task table and hands it to the executive. Any status but kOk is
  // the autonomy's (it refuses the configuration) or the executive's.
  Status start(const Config& config, const hal::Board& board, runtime::SlowTaskRunner& runner,
               runtime::TickObserver* observer);

  autonomy::Autonomy& autonomy() { return autonomy_; }
  const autonomy::Autonomy& autonomy() const { return autonomy_; }
  runtime::Executive& executive() { return executive_; }
  const runtime::Executive& executive() const { return executive_; }

 private:
  autonomy::Autonomy autonomy_;
  runtime::Executive executive_;
  std::array<runtime::Task, 8> tasks_{};
};

struct MemoryRow {
  std::string module;
  std::size_t bytes = 0;
};

// Static memory by module; the last row, "total", is sizeof(Stack).
std::vector<MemoryRow> memory_table();

}  // namespace surefoot::apps
