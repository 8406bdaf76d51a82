#include "apps/surefoot-lab/jump/motion_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "apps/common/config_root.h"
#include "apps/common/run.h"
#include "apps/surefoot-lab/jump/jump_recipes.h"
#include "apps/surefoot-lab/jump/motion_writer.h"

namespace surefoot::apps {
namespace {

constexpr int kMaxIterations = 500;

int fail(const std::string& text, int code) {
  std::fputs((text + "\n").c_str(), stderr);
  return code;
}

}  // namespace

int make_motion_file(const MotionOptions& options) {
  ConfigIssues issues;
  RunRequest request;
  request.robot = options.robot;
  const Config config = load_config_parts(request, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  const auto settings = jump::recipe(options.name);
  if (!settings) {
    std::string known;
    for (const std::string& name : jump::recipe_names()) known += " " + name;
    return fail(fmt::format("no motion '{}'; there are:{}", options.name, known), 2);
  }
  const jump::JumpProblem problem(config.robot, *settings);
  const jump::JumpSolution solution =
      jump::solve(problem, problem.initial_guess(), kMaxIterations, options.verbose);
  const std::string verdict =
      fmt::format("{}: {} after {} iterations, cost {:.4g}, violation {:.1e}", options.name,
                  solution.verdict, solution.iterations, solution.cost, solution.violation);
  if (!solution.solved) return fail(verdict, 1);
  const motions::Motion motion = jump::make_motion(problem, solution);
  const motions::MotionCheck check = motions::check_motion(motion, config.robot);
  if (check.fault != motions::MotionFault::kNone) {
    return fail(fmt::format("row {}: {}", check.row,
                            motions::kMotionFaultNames[static_cast<int>(check.fault)]),
                1);
  }
  const std::filesystem::path file =
      options.out.empty() ? config_folder() / "motions" / (options.name + ".yaml") : options.out;
  std::ofstream stream(file);
  stream << jump::motion_file_text(options.name, motion);
  stream.close();
  if (!stream) return fail(file.string() + ": cannot be written", 1);
  std::fputs((verdict + "\n  " + file.string() + "\n").c_str(), stdout);
  return 0;
}

}  // namespace surefoot::apps
