// What task_work measures: one piece of a tick with fixed inputs.
#pragma once

#include <memory>

#include "apps/common/config_root.h"

namespace surefoot::timing {

class WorkCase {
 public:
  virtual ~WorkCase() = default;

  // Called before each measured round; false: there are no further rounds.
  virtual bool prepare(std::size_t round) = 0;
  // The only part whose instructions are counted.
  virtual void run() = 0;
  // After the last round: whether the rounds did the work that the case stands for. Without this a
  // budget could be kept by doing less.
  virtual bool did_the_work() = 0;
};

struct WorkEntry {
  const char* name;
  const char* what;
  std::unique_ptr<WorkCase> (*make)();
};

// The robot's real configuration with `sets` on top; exits when it is refused.
apps::Config load(const std::vector<std::string>& sets);

// Each ends with an entry whose name is null.
extern const WorkEntry kControlCases[];
extern const WorkEntry kModuleCases[];
extern const WorkEntry kMpcCases[];
extern const WorkEntry kMappingCases[];
extern const WorkEntry kRegistrationCases[];
extern const WorkEntry kExecutiveCases[];
extern const WorkEntry kDynamicsCases[];
extern const WorkEntry kJumpCases[];
extern const WorkEntry kObstacleCases[];
extern const WorkEntry kStereoCases[];
extern const WorkEntry kPlanningCases[];
extern const WorkEntry kGroundCases[];
extern const WorkEntry kNavigationCases[];

}  // namespace surefoot::timing
