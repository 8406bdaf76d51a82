// The predictive controller as a slow task: released every kMpcPeriodTicks with a copy of its
// problem, published kMpcLatencyTicks later. Control sees the published plan alone.
#pragma once

#include "core/base/time.h"
#include "core/control/config.h"
#include "core/control/convex_mpc.h"
#include "core/control/horizon_plan.h"

namespace surefoot::autonomy {

inline constexpr std::uint32_t kMpcPeriodTicks = 5;   // 10 ms
inline constexpr std::uint32_t kMpcLatencyTicks = 2;  // 4 ms

class MpcTask {
 public:
  void reset(const control::MpcConfig& config);

  // The next problem, to be filled before release().
  control::MpcProblem& problem() { return problem_; }
  void release(TimeNs stamp);
  // May run anywhere between release and publish.
  void run() { mpc_.solve(problem_); }
  void publish();

  const control::ForcePlan& plan() const { return plan_; }

 private:
  TimeNs horizon_step_;
  TimeNs stamp_;       // of the problem
  TimeNs shifted_to_;  // whole steps of the horizon that the warm start has been moved by
  bool started_ = false;
  control::MpcProblem problem_;
  control::ConvexMpc mpc_;
  control::ForcePlan plan_;
};

}  // namespace surefoot::autonomy
