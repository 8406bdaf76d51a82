// The stereo calibration that a robot's file names, put in place of its name.
#pragma once

#include <filesystem>

#include "apps/common/config_node.h"
#include "core/autonomy/config.h"
#include "core/robot/robot_model.h"

namespace surefoot::apps {

// `robot.stereo_camera.calibration: FILE` of the tree becomes what that file holds, the text of
// OpenCV's FileStorage: image_width, image_height, camera_matrix_*, distortion_coefficients_*, R
// and T [m]. The name is relative to the folder of the file that names it; a number is reported
// with the line of the calibration file it stands in.
void load_stereo(ConfigNode& tree, ConfigIssues& issues);

// What no pair of cameras can be, what core/stereo cannot match, and groups without their camera.
// `tree` says where the values come from.
void check_stereo(const ConfigNode& tree, const robot::RobotModel& model,
                  const autonomy::StereoConfig& stereo, bool simulated, ConfigIssues& issues);

// What keeps the stereo camera from being an odometer.
void check_camera_motion(const robot::RobotModel& model, const autonomy::AutonomyConfig& config,
                         ConfigIssues& issues);

}  // namespace surefoot::apps
