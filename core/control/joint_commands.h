// From whole-body control to the drives: what a standing leg and one in the air ask of their
// joints.
#pragma once

#include "core/actuation/joint_bus.h"
#include "core/control/config.h"
#include "core/control/whole_body.h"

namespace surefoot::control {

// Standing legs have the gains of `whole_body`, the others those of `swing`.
actuation::JointCommands joint_commands(const WholeBodyCommand& wanted, const LegTasks& tasks,
                                        const ControlConfig& config);

}  // namespace surefoot::control
