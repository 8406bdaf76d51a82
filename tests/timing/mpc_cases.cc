// The predictive controller.
#include "core/control/convex_mpc.h"
#include "tests/support/mpc_problems.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

// Four feet over the whole horizon, or a run with flight; the number of operations is the same.
template <std::size_t kGait>
class Predict final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const control::MpcConfig config = load({}).autonomy.control.mpc;
    Random random(3);
    problem_ = tests::random_mpc_problem(random, tests::kMpcGaits[kGait], config, 1.0);
    mpc_.reset(config);
    return true;
  }
  void run() override { mpc_.solve(problem_); }
  bool did_the_work() override {
    return mpc_.solution().source == control::MpcSource::kSolved &&
           mpc_.solution().iterations == control::HorizonQp::kIterations;
  }

 private:
  control::ConvexMpc mpc_;
  control::MpcProblem problem_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kMpcCases[] = {
    {"mpc_trot_run", "predictive control, trot-run with flight", make<Predict<1>>},
    {"mpc_stand", "predictive control, four feet over the whole horizon", make<Predict<6>>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
