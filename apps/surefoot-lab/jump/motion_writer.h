// A solved jump as the motion that the robot loads, and its file.
#pragma once

#include <string>

#include "apps/surefoot-lab/jump/jump_solver.h"
#include "core/motions/motion.h"

namespace surefoot::apps::jump {

motions::Motion make_motion(const JumpProblem& problem, const JumpSolution& solution);
// YAML: group `motion` with a checksum of everything in it.
std::string motion_file_text(const std::string& name, const motions::Motion& motion);

}  // namespace surefoot::apps::jump
