#include "apps/surefoot-lab/jump/planar_model.h"

namespace surefoot::apps::jump {
namespace {

// Parts of a rigid link put together: mass, first moment and inertia about the link's joint.
struct LinkSum {
  double mass = 0;
  double moment_x = 0;
  double moment_z = 0;
  double inertia = 0;

  void add(double m, double x, double z, double about_own_centre) {
    mass += m;
    moment_x += m * x;
    moment_z += m * z;
    inertia += about_own_centre + m * (x * x + z * z);
  }
  PlanarLink link() const {
    PlanarLink link;
    link.mass_kg = mass;
    link.centre_x_m = moment_x / mass;
    link.centre_z_m = moment_z / mass;
    link.inertia_kg_m2 =
        inertia - mass * (link.centre_x_m * link.centre_x_m + link.centre_z_m * link.centre_z_m);
    return link;
  }
};

void add_link(const robot::Link& link, double times, double joint_x, LinkSum& sum) {
  sum.add(times * link.mass_kg, joint_x + link.centre_of_mass_m[0], link.centre_of_mass_m[2],
          times * link.inertia_kg_m2[1]);
}

}  // namespace

// Rotors: abduction's in the trunk at its joint, hip's and knee's at the hip joint, as in
// sim_hal/robot/articulation.cc. The abduction links do not move in the plane: part of the trunk.
PlanarModel make_planar_model(const robot::RobotModel& robot) {
  PlanarModel model;
  LinkSum trunk;
  add_link(robot.trunk, 1.0, 0.0, trunk);
  for (const double side : {1.0, -1.0}) {
    add_link(robot.abad, 2.0, side * robot.abad_x_m, trunk);
    trunk.add(2.0 * (robot.actuators[0].rotor_mass_kg + robot.actuators[1].rotor_mass_kg),
              side * robot.abad_x_m, 0.0, 0.0);
  }
  model.trunk = trunk.link();
  LinkSum thigh;
  add_link(robot.thigh, 2.0, 0.0, thigh);
  thigh.add(2.0 * robot.actuators[2].rotor_mass_kg, 0.0, 0.0, 0.0);
  model.thigh = thigh.link();
  LinkSum shank;
  add_link(robot.shank, 2.0, 0.0, shank);
  model.shank = shank.link();
  model.hip_x_m = robot.abad_x_m;
  model.thigh_length_m = robot.thigh_length_m;
  model.shank_length_m = robot.shank_length_m;
  model.foot_radius_m = robot.foot_radius_m;
  model.hip_rotor_kg_m2 = 2.0 * robot.actuators[1].reflected_inertia_kg_m2();
  model.knee_rotor_kg_m2 = 2.0 * robot.actuators[2].reflected_inertia_kg_m2();
  model.hip_viscous_Nm_s = 2.0 * robot.actuators[1].viscous_friction_Nm_s;
  model.knee_viscous_Nm_s = 2.0 * robot.actuators[2].viscous_friction_Nm_s;
  return model;
}

}  // namespace surefoot::apps::jump
