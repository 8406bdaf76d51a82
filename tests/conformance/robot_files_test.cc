// Robot files hold exactly the keys of RobotModel, in range, and their wiring can be driven.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/config_node.h"
#include "apps/common/config_reader.h"
#include "apps/common/config_stereo.h"
#include "core/actuation/joint_bus.h"
#include "core/robot/robot_model.h"

namespace surefoot {
namespace {

robot::RobotModel read_robot(const std::string& path) {
  apps::ConfigIssues issues;
  apps::ConfigNode tree = apps::read_yaml_file(path, issues);
  apps::load_stereo(tree, issues);
  robot::RobotModel model;
  const apps::ConfigNode* const node = tree.find("robot");
  EXPECT_NE(node, nullptr) << path;
  if (node != nullptr) apps::ConfigReader::read(*node, model, issues);
  EXPECT_EQ(apps::to_string(issues), "");
  return model;
}

std::vector<std::string> robot_files() {
  std::vector<std::string> paths;
  for (const auto& entry :
       std::filesystem::directory_iterator(SUREFOOT_SOURCE_DIR "/config/robots")) {
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path().string());
  }
  return paths;
}

// A rigid body's principal moments keep the triangle inequality, and so do the diagonal elements.
bool is_physical(const robot::Link& link) {
  const auto& i = link.inertia_kg_m2;
  const bool triangle = i[0] + i[1] >= i[2] && i[1] + i[2] >= i[0] && i[2] + i[0] >= i[1];
  const double determinant = i[0] * (i[1] * i[2] - i[5] * i[5]) -
                             i[3] * (i[3] * i[2] - i[5] * i[4]) +
                             i[4] * (i[3] * i[5] - i[1] * i[4]);
  return triangle && i[0] > 0 && i[0] * i[1] > i[3] * i[3] && determinant > 0;
}

TEST(RobotFiles, ThereIsOne) { EXPECT_FALSE(robot_files().empty()); }

TEST(RobotFiles, AreCompletePhysicalAndWired) {
  for (const std::string& path : robot_files()) {
    SCOPED_TRACE(path);
    const robot::RobotModel model = read_robot(path);
    actuation::JointBus bus;
    EXPECT_EQ(bus.configure(model), Status::kOk);
    for (const robot::Link& link : {model.trunk, model.abad, model.thigh, model.shank}) {
      EXPECT_TRUE(is_physical(link));
    }
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      const robot::JointWiring& wire = model.wiring[joint];
      const robot::Actuator& actuator = model.actuators[joint % robot::kJointsPerLeg];
      // The wire must be able to say all that the actuator can do.
      EXPECT_LE(actuator.no_load_speed_rad_s * wire.belt_ratio, wire.velocity_range_rad_s) << joint;
      EXPECT_LE(actuator.torque_limit_Nm / wire.belt_ratio, wire.torque_range_Nm) << joint;
      EXPECT_LT(actuator.torque_limit_Nm, actuator.stall_torque_Nm) << joint;
    }
  }
}

TEST(RobotFiles, MiniCheetahIsTheRobotOfTheLiterature) {
  const robot::RobotModel model =
      read_robot(SUREFOOT_SOURCE_DIR "/config/robots/mini_cheetah.yaml");
  EXPECT_NEAR(model.total_mass_kg(), 8.912, 0.001);
  EXPECT_NEAR(model.actuators[0].reflected_inertia_kg_m2(), 0.00227, 0.00001);
  EXPECT_NEAR(model.actuators[2].reflected_inertia_kg_m2(), 0.00548, 0.00001);
  // Hip to foot in the standing pose (0, -0.8, 1.6).
  EXPECT_NEAR((model.thigh_length_m + model.shank_length_m) * std::cos(0.8), 0.2815, 0.0001);
  EXPECT_NEAR(model.wiring[2].belt_ratio * model.actuators[0].gear_ratio,
              model.actuators[2].gear_ratio, 0.001);
  // The folded and the recovery poses are inside the soft stops.
  const double margin = actuation::ActuationParameters{}.soft_stop_margin_rad;
  EXPECT_LT(2.77, model.actuators[2].max_rad - margin);
  EXPECT_GT(-3.1, model.actuators[1].min_rad + margin);
}

}  // namespace
}  // namespace surefoot
