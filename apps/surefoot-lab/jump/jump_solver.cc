#include "apps/surefoot-lab/jump/jump_solver.h"

#include <IpIpoptApplication.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <algorithm>

namespace surefoot::apps::jump {
namespace {

using Ipopt::Index;
using Ipopt::Number;

class Programme final : public Ipopt::TNLP {
 public:
  Programme(const JumpProblem& problem, const std::vector<double>& guess, JumpSolution& solution)
      : problem_(problem), guess_(guess), solution_(solution) {}

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian,
                    IndexStyleEnum& style) override {
    n = problem_.variables();
    m = problem_.constraints();
    jacobian = static_cast<Index>(problem_.jacobian_entries().size());
    hessian = static_cast<Index>(problem_.hessian_entries().size());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index, Number* x_low, Number* x_high, Index, Number* g_low,
                       Number* g_high) override {
    const Bounds x = problem_.variable_bounds();
    const Bounds g = problem_.constraint_bounds();
    std::copy(x.low.begin(), x.low.end(), x_low);
    std::copy(x.high.begin(), x.high.end(), x_high);
    std::copy(g.low.begin(), g.low.end(), g_low);
    std::copy(g.high.begin(), g.high.end(), g_high);
    return true;
  }
  bool get_starting_point(Index, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    std::copy(guess_.begin(), guess_.end(), x);
    return true;
  }
  bool eval_f(Index, const Number* x, bool, Number& value) override {
    value = problem_.cost(x);
    return true;
  }
  bool eval_grad_f(Index, const Number* x, bool, Number* gradient) override {
    problem_.gradient(x, gradient);
    return true;
  }
  bool eval_g(Index, const Number* x, bool, Index, Number* g) override {
    problem_.constraints(x, g);
    return true;
  }
  bool eval_jac_g(Index, const Number* x, bool, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (values == nullptr) {
      list(problem_.jacobian_entries(), rows, columns);
    } else {
      problem_.jacobian(x, values);
    }
    return true;
  }
  bool eval_h(Index, const Number* x, bool, Number factor, Index, const Number* multipliers, bool,
              Index, Index* rows, Index* columns, Number* values) override {
    if (values == nullptr) {
      list(problem_.hessian_entries(), rows, columns);
    } else {
      problem_.hessian(x, factor, multipliers, values);
    }
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*,
                         const Number*, Index, const Number*, const Number*, Number cost,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    solution_.x.assign(x, x + n);
    solution_.cost = cost;
  }

 private:
  static void list(const std::vector<Entry>& entries, Index* rows, Index* columns) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      rows[i] = entries[i].row;
      columns[i] = entries[i].column;
    }
  }

  const JumpProblem& problem_;
  const std::vector<double>& guess_;
  JumpSolution& solution_;
};

double largest_violation(const JumpProblem& problem, const std::vector<double>& x) {
  std::vector<double> g(static_cast<std::size_t>(problem.constraints()));
  problem.constraints(x.data(), g.data());
  const Bounds bounds = problem.constraint_bounds();
  double worst = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    worst = std::max({worst, bounds.low[i] - g[i], g[i] - bounds.high[i]});
  }
  return worst;
}

const char* verdict_of(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded: return "solved";
    case Ipopt::Solved_To_Acceptable_Level: return "solved to acceptable level";
    case Ipopt::Infeasible_Problem_Detected: return "locally infeasible";
    case Ipopt::Maximum_Iterations_Exceeded: return "too many iterations";
    case Ipopt::Restoration_Failed: return "restoration failed";
    default: return "failed";
  }
}

}  // namespace

JumpSolution solve(const JumpProblem& problem, const std::vector<double>& guess, int max_iterations,
                   bool verbose) {
  JumpSolution solution;
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  const auto options = application->Options();
  options->SetIntegerValue("print_level", verbose ? 5 : 0);
  options->SetStringValue("sb", "yes");
  options->SetIntegerValue("max_iter", max_iterations);
  options->SetNumericValue("tol", 1e-6);
  options->SetNumericValue("constr_viol_tol", 1e-6);
  options->SetStringValue("linear_solver", "mumps");
  options->SetStringValue("nlp_scaling_method", "none");
  if (application->Initialize() != Ipopt::Solve_Succeeded) {
    solution.verdict = "the solver does not start";
    return solution;
  }
  const Ipopt::SmartPtr<Ipopt::TNLP> programme = new Programme(problem, guess, solution);
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(programme);
  solution.verdict = verdict_of(status);
  solution.solved = status == Ipopt::Solve_Succeeded;
  if (IsValid(application->Statistics())) {
    solution.iterations = application->Statistics()->IterationCount();
  }
  if (!solution.x.empty()) solution.violation = largest_violation(problem, solution.x);
  return solution;
}

}  // namespace surefoot::apps::jump
