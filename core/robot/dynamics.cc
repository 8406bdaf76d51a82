#include "core/robot/dynamics.h"
#include "core/math/gravity.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::robot {
namespace {

constexpr std::size_t link_of(std::size_t leg, std::size_t joint) {
  return 1 + joint_index(leg, joint);
}

// Inertia of a point mass about the origin.
Matrix3 point_inertia(double mass_kg, const Vector3& p) {
  return mass_kg * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
}

// d/dt of a motion vector fixed in a body that moves with `v` (Featherstone 2008, eq. 2.31).
Motion cross(const Motion& v, const Motion& m) {
  return {v.angular.cross(m.angular), v.angular.cross(m.linear) + v.linear.cross(m.angular)};
}

// The same of a force vector (eq. 2.32).
Wrench cross_force(const Motion& v, const Wrench& f) {
  return {v.angular.cross(f.moment) + v.linear.cross(f.force), v.angular.cross(f.force)};
}

Motion plus(const Motion& a, const Motion& b, double factor) {
  return {a.angular + b.angular * factor, a.linear + b.linear * factor};
}

double power(const Motion& m, const Wrench& f) {
  return m.angular.dot(f.moment) + m.linear.dot(f.force);
}

void accumulate(Wrench& sum, const Wrench& f) {
  sum.moment += f.moment;
  sum.force += f.force;
}

}  // namespace

void SpatialInertia::add(const SpatialInertia& other) {
  mass_kg += other.mass_kg;
  moment_kg_m += other.moment_kg_m;
  inertia_kg_m2 += other.inertia_kg_m2;
}

Wrench SpatialInertia::operator*(const Motion& motion) const {
  return {inertia_kg_m2 * motion.angular + moment_kg_m.cross(motion.linear),
          mass_kg * motion.linear - moment_kg_m.cross(motion.angular)};
}

void Dynamics::reset(const RobotModel& model) {
  model_ = model;
  const auto& actuators = model.actuators;
  set_link(0, model.trunk, 0.0, Vector3::Zero());
  LinkConstants& trunk = constants_[0];
  // The four abduction rotors lie symmetric to B's origin: their common centre is B's origin.
  const double rotors_kg = static_cast<double>(kLegs) * actuators[0].rotor_mass_kg;
  const double mass_kg = trunk.mass_kg + rotors_kg;
  const Vector3 centre_m = trunk.centre_m * (trunk.mass_kg / mass_kg);
  trunk.inertia_kg_m2 += point_inertia(trunk.mass_kg, trunk.centre_m);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    trunk.inertia_kg_m2 +=
        point_inertia(actuators[0].rotor_mass_kg, abduction_joint_B_m(model, leg));
  }
  trunk.inertia_kg_m2 -= point_inertia(mass_kg, centre_m);
  trunk.mass_kg = mass_kg;
  trunk.centre_m = centre_m;
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const double side = left_sign(leg);
    set_link(link_of(leg, 0), model.link_of(leg, model.abad), actuators[1].rotor_mass_kg,
             Vector3(0.0, side * model.hip_offset_m, 0.0));
    set_link(link_of(leg, 1), model.link_of(leg, model.thigh), actuators[2].rotor_mass_kg,
             Vector3::Zero());
    set_link(link_of(leg, 2), model.link_of(leg, model.shank), 0.0, Vector3::Zero());
  }
  for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
    armature_kg_m2_[joint] = actuators[joint].reflected_inertia_kg_m2();
  }
  update(MotionState{});
}

// A link with a rotor as a point mass.
void Dynamics::set_link(std::size_t link, const Link& data, double rotor_kg,
                        const Vector3& rotor_place_m) {
  const auto& c = data.centre_of_mass_m;
  const auto& i = data.inertia_kg_m2;
  const Vector3 centre_m(c[0], c[1], c[2]);
  Matrix3 inertia;
  inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  LinkConstants& result = constants_[link];
  result.mass_kg = data.mass_kg + rotor_kg;
  result.centre_m = (data.mass_kg * centre_m + rotor_kg * rotor_place_m) / result.mass_kg;
  result.inertia_kg_m2 = inertia + point_inertia(data.mass_kg, centre_m) +
                         point_inertia(rotor_kg, rotor_place_m) -
                         point_inertia(result.mass_kg, result.centre_m);
}

SpatialInertia Dynamics::in_B(const LinkConstants& link, const Matrix3& R_BL,
                              const Vector3& p_B_m) {
  const Vector3 centre = p_B_m + R_BL * link.centre_m;
  const Matrix3 turned = R_BL * link.inertia_kg_m2;
  return {link.mass_kg, link.mass_kg * centre,
          turned * R_BL.transpose() + point_inertia(link.mass_kg, centre)};
}

void Dynamics::place_link(std::size_t link, std::size_t parent, const Matrix3& R_BL,
                          const Vector3& axis_B, const Vector3& p_B_m, double velocity_rad_s) {
  LinkState& state = links_[link];
  const LinkState& base = links_[parent];
  state.p_B_m = p_B_m;
  state.axis = {axis_B, p_B_m.cross(axis_B)};
  state.velocity = plus(base.velocity, state.axis, velocity_rad_s);
  state.bias = plus(base.bias, cross(base.velocity, state.axis), velocity_rad_s);
  state.inertia = in_B(constants_[link], R_BL, p_B_m);
}

void Dynamics::update(const MotionState& state) {
  R_OB_ = state.R_OB;
  qd_rad_s_ = state.velocity.tail<static_cast<int>(kJoints)>();
  links_[0].velocity = {state.velocity.head<3>(), state.velocity.segment<3>(3)};
  links_[0].inertia = in_B(constants_[0], Matrix3::Identity(), Vector3::Zero());
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const auto row = static_cast<Eigen::Index>(leg * kJointsPerLeg);
    const Vector3 q = state.q_rad.segment<3>(row);
    const Vector3 qd = qd_rad_s_.segment<3>(row);
    const math::SinCos abad = math::sin_cos(q[0]);
    const math::SinCos hip = math::sin_cos(q[1]);
    const math::SinCos knee = math::sin_cos(q[1] + q[2]);
    Matrix3 R_abad;
    R_abad << 1, 0, 0, 0, abad.cos, -abad.sin, 0, abad.sin, abad.cos;
    Matrix3 R_thigh;                                         // R_abad Ry(-hip)
    R_thigh << hip.cos, 0, -hip.sin,                         //
        -abad.sin * hip.sin, abad.cos, -abad.sin * hip.cos,  //
        abad.cos * hip.sin, abad.sin, abad.cos * hip.cos;
    Matrix3 R_shank;                                           // R_abad Ry(-hip - knee)
    R_shank << knee.cos, 0, -knee.sin,                         //
        -abad.sin * knee.sin, abad.cos, -abad.sin * knee.cos,  //
        abad.cos * knee.sin, abad.sin, abad.cos * knee.cos;
    const double side = left_sign(leg);
    const Vector3 p_abad = abduction_joint_B_m(model_, leg);
    const Vector3 p_hip = p_abad + R_abad.col(1) * (side * model_.hip_offset_m);
    const Vector3 p_knee =
        p_hip + R_thigh * Vector3(0.0, side * model_.knee_offset_m, -model_.thigh_length_m);
    const Vector3 lateral = -R_abad.col(1);  // hip and knee turn about -y
    place_link(link_of(leg, 0), 0, R_abad, Vector3::UnitX(), p_abad, qd[0]);
    place_link(link_of(leg, 1), link_of(leg, 0), R_thigh, lateral, p_hip, qd[1]);
    place_link(link_of(leg, 2), link_of(leg, 1), R_shank, lateral, p_knee, qd[2]);
    feet_B_m_[leg] = p_knee - R_shank.col(2) * model_.shank_length_m;
  }
}

void Dynamics::mass_matrix(MassMatrix& m) const {
  m.setZero();
  SpatialInertia whole = links_[0].inertia;
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    SpatialInertia composite;
    for (std::size_t joint = kJointsPerLeg; joint-- > 0;) {
      const LinkState& link = links_[link_of(leg, joint)];
      composite.add(link.inertia);
      const Wrench force = composite * link.axis;
      const Eigen::Index row = velocity_row(leg) + static_cast<Eigen::Index>(joint);
      m.block<3, 1>(0, row) = force.moment;
      m.block<3, 1>(3, row) = force.force;
      m.block<1, 3>(row, 0) = force.moment.transpose();
      m.block<1, 3>(row, 3) = force.force.transpose();
      m(row, row) = power(link.axis, force) + armature_kg_m2_[joint];
      for (std::size_t above = joint; above-- > 0;) {
        const Eigen::Index column = velocity_row(leg) + static_cast<Eigen::Index>(above);
        const double entry = power(links_[link_of(leg, above)].axis, force);
        m(row, column) = entry;
        m(column, row) = entry;
      }
    }
    whole.add(composite);
  }
  const Vector3& h = whole.moment_kg_m;
  // Symmetric to the last bit: R I R^T is not.
  m.block<3, 3>(0, 0) = 0.5 * (whole.inertia_kg_m2 + whole.inertia_kg_m2.transpose());
  m.block<3, 3>(3, 3) = whole.mass_kg * Matrix3::Identity();
  m(0, 4) = m(4, 0) = -h[2];
  m(0, 5) = m(5, 0) = h[1];
  m(1, 3) = m(3, 1) = h[2];
  m(1, 5) = m(5, 1) = -h[0];
  m(2, 3) = m(3, 2) = -h[1];
  m(2, 4) = m(4, 2) = h[0];
}

GeneralisedVector Dynamics::inverse_dynamics(const GeneralisedVector& acceleration) const {
  const Vector3 up_B = R_OB_.row(2).transpose();
  // Gravity as an upward acceleration of everything.
  const Motion base{acceleration.head<3>(), acceleration.segment<3>(3) + kGravity_m_s2 * up_B};
  const auto force_of = [](const LinkState& link, const Motion& a) {
    Wrench force = link.inertia * a;
    accumulate(force, cross_force(link.velocity, link.inertia * link.velocity));
    return force;
  };
  GeneralisedVector result;
  Wrench whole = force_of(links_[0], base);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    std::array<Motion, kJointsPerLeg> a;
    Motion last = base;
    for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
      const LinkState& link = links_[link_of(leg, joint)];
      const double qdd = acceleration[velocity_row(leg) + static_cast<Eigen::Index>(joint)];
      last = plus(last, link.axis, qdd);
      a[joint] = plus(last, link.bias, 1.0);
    }
    Wrench force;
    for (std::size_t joint = kJointsPerLeg; joint-- > 0;) {
      const LinkState& link = links_[link_of(leg, joint)];
      const Eigen::Index row = velocity_row(leg) + static_cast<Eigen::Index>(joint);
      accumulate(force, force_of(link, a[joint]));
      result[row] = power(link.axis, force) + armature_kg_m2_[joint] * acceleration[row];
    }
    accumulate(whole, force);
  }
  result.head<3>() = whole.moment;
  result.segment<3>(3) = whole.force;
  return result;
}

PointMotion Dynamics::foot(std::size_t leg, const Vector3& offset_B_m) const {
  const LinkState& shank = links_[link_of(leg, 2)];
  const Vector3& centre = feet_B_m_[leg];
  const Vector3& w = shank.velocity.angular;
  PointMotion point;
  point.p_B_m = centre + offset_B_m;
  point.v_B_m_s = shank.velocity.linear + w.cross(point.p_B_m);
  for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
    const Motion& axis = links_[link_of(leg, joint)].axis;
    point.jacobian_B.col(static_cast<Eigen::Index>(joint)) =
        axis.linear + axis.angular.cross(point.p_B_m);
  }
  // Spatial to classical acceleration (Featherstone 2008, section 2.11).
  point.bias_B_m_s2 = shank.bias.linear + shank.bias.angular.cross(point.p_B_m) +
                      w.cross(shank.velocity.linear + w.cross(centre));
  return point;
}

Centroid Dynamics::centroid() const {
  SpatialInertia whole;
  Wrench momentum;
  for (const LinkState& link : links_) {
    whole.add(link.inertia);
    accumulate(momentum, link.inertia * link.velocity);
  }
  Centroid result;
  result.mass_kg = whole.mass_kg;
  result.p_B_m = whole.moment_kg_m / whole.mass_kg;
  result.inertia_B_kg_m2 = whole.inertia_kg_m2 - point_inertia(whole.mass_kg, result.p_B_m);
  result.momentum_B_kg_m_s = momentum.force;
  result.angular_momentum_B_kg_m2_s = momentum.moment - result.p_B_m.cross(momentum.force);
  return result;
}

double Dynamics::kinetic_energy_J() const {
  double energy = 0;
  for (const LinkState& link : links_) {
    energy += 0.5 * power(link.velocity, link.inertia * link.velocity);
  }
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double qd = qd_rad_s_[static_cast<Eigen::Index>(joint)];
    energy += 0.5 * armature_kg_m2_[joint % kJointsPerLeg] * qd * qd;
  }
  return energy;
}

Eigen::Matrix<double, 3, kVelocities> point_jacobian_B(std::size_t leg, const PointMotion& point) {
  const Vector3& p = point.p_B_m;
  Eigen::Matrix<double, 3, kVelocities> jacobian;
  jacobian.setZero();
  jacobian.block<3, 3>(0, 0) << 0, p[2], -p[1],  //
      -p[2], 0, p[0],                            //
      p[1], -p[0], 0;
  jacobian.block<3, 3>(0, 3).setIdentity();
  jacobian.block<3, 3>(0, velocity_row(leg)) = point.jacobian_B;
  return jacobian;
}

bool MassFactor::factor(const MassMatrix& m) {
  Matrix6 trunk = m.block<6, 6>(0, 0);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const Eigen::Index row = velocity_row(leg);
    leg_inverse_[leg] = m.block<3, 3>(row, row).inverse();
    const Matrix6x3 off = m.block<6, 3>(0, row);
    coupling_[leg] = off * leg_inverse_[leg];
    trunk -= coupling_[leg] * off.transpose();
  }
  trunk_.compute(trunk);
  return trunk_.info() == Eigen::Success;
}

GeneralisedVector MassFactor::solve(const GeneralisedVector& force) const {
  Vector6 base = force.head<6>();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    base -= coupling_[leg] * force.segment<3>(velocity_row(leg));
  }
  GeneralisedVector result;
  base = trunk_.solve(base);
  result.head<6>() = base;
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const Eigen::Index row = velocity_row(leg);
    result.segment<3>(row) =
        leg_inverse_[leg] * force.segment<3>(row) - coupling_[leg].transpose() * base;
  }
  return result;
}

void MassFactor::inverse(MassMatrix& result) const {
  // Column by column: solving for a matrix would have Eigen allocate.
  Matrix6 trunk;
  for (int i = 0; i < 6; ++i) trunk.col(i) = trunk_.solve(Vector6::Unit(i));
  result.block<6, 6>(0, 0) = trunk;
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const Eigen::Index row = velocity_row(leg);
    const Matrix6x3 off = -(trunk * coupling_[leg]);
    result.block<6, 3>(0, row) = off;
    result.block<3, 6>(row, 0) = off.transpose();
    for (std::size_t other = 0; other <= leg; ++other) {
      const Eigen::Index column = velocity_row(other);
      Matrix3 block = -(off.transpose() * coupling_[other]);
      if (other == leg) block += leg_inverse_[leg];
      result.block<3, 3>(row, column) = block;
      result.block<3, 3>(column, row) = block.transpose();
    }
  }
}

}  // namespace surefoot::robot
