// The dynamics against what follows from definitions: moving mass points, finite differences,
// conservation laws. (Against another engine: tests/unit/sim_hal/dynamics_against_ode_test.cc.)
#include "core/robot/dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Dense>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/robot/kinematics.h"
#include "tests/support/mini_cheetah.h"
#include "tests/support/samples.h"

namespace surefoot::robot {
namespace {

constexpr double kG = 9.81;

// Where the robot is: attitude, place and joints. Moves along a generalised velocity by exponential
// steps, so that finite differences in it are exact to second order.
struct Place {
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 p_OB_m = Vector3::Zero();
  JointVector q_rad = JointVector::Zero();
};

Place moved(const Place& from, const GeneralisedVector& nu, double t) {
  Place to;
  const Vector3 turn = nu.head<3>() * t;
  to.R_OB = from.R_OB * geometry::to_matrix(geometry::from_rotation_vector(turn));
  to.p_OB_m = from.p_OB_m + from.R_OB * nu.segment<3>(3) * t;
  to.q_rad = from.q_rad + nu.tail<12>() * t;
  return to;
}

Matrix3 turn_x(double a) { return Eigen::AngleAxisd(a, Vector3::UnitX()).toRotationMatrix(); }
Matrix3 turn_back_y(double a) { return Eigen::AngleAxisd(-a, Vector3::UnitY()).toRotationMatrix(); }

// One rigid part, from the robot's file alone: its frame in O, and mass, centre, inertia in it.
struct Part {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  double mass = 0;
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();
  Vector3 place() const { return p + R * centre; }
};

Part part(const Matrix3& R, const Vector3& p, const Link& link, double side) {
  Part result{R, p, link.mass_kg, {}, {}};
  result.centre =
      Vector3(link.centre_of_mass_m[0], side * link.centre_of_mass_m[1], link.centre_of_mass_m[2]);
  const auto& i = link.inertia_kg_m2;
  result.inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  const Matrix3 mirror = Vector3(1, side, 1).asDiagonal();
  result.inertia = mirror * result.inertia * mirror;
  return result;
}

Part rotor(const Matrix3& R, const Vector3& p, double mass) {
  return {R, p, mass, Vector3::Zero(), Matrix3::Zero()};
}

// Trunk, then per leg abad, thigh, shank, three rotors.
std::array<Part, 25> parts(const RobotModel& model, const Place& place) {
  std::array<Part, 25> result;
  result[0] = part(place.R_OB, place.p_OB_m, model.trunk, 1.0);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const Vector3 q = place.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg));
    const LegPoints points = leg_points_B(model, leg, q);
    const auto in_O = [&](int i) {
      return Vector3(place.p_OB_m + place.R_OB * points.p_B_m[static_cast<std::size_t>(i)]);
    };
    const Matrix3 abad = place.R_OB * turn_x(q[0]);
    const Matrix3 thigh = abad * turn_back_y(q[1]);
    const Matrix3 shank = thigh * turn_back_y(q[2]);
    const double side = left_sign(leg);
    Part* const first = &result[1 + 6 * leg];
    first[0] = part(abad, in_O(0), model.abad, side);
    first[1] = part(thigh, in_O(1), model.thigh, side);
    first[2] = part(shank, in_O(2), model.shank, side);
    first[3] = rotor(place.R_OB, in_O(0), model.actuators[0].rotor_mass_kg);
    first[4] = rotor(abad, in_O(1), model.actuators[1].rotor_mass_kg);
    first[5] = rotor(thigh, in_O(1), model.actuators[2].rotor_mass_kg);
  }
  return result;
}

// Sums over parts whose velocities are finite differences of their places.
struct Sums {
  double energy = 0;
  double mass = 0;
  double potential = 0;
  Vector3 momentum = Vector3::Zero();
  Vector3 angular_momentum = Vector3::Zero();  // about O's origin
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();  // about O's origin, axes of O
};

Sums sums(const RobotModel& model, const Place& place, const GeneralisedVector& nu) {
  constexpr double kStep_s = 1e-5;
  const auto now = parts(model, place);
  const auto next = parts(model, moved(place, nu, kStep_s));
  const auto last = parts(model, moved(place, nu, -kStep_s));
  Sums total;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double mass = now[i].mass;
    const Vector3 c = now[i].place();
    const Vector3 v = (next[i].place() - last[i].place()) / (2 * kStep_s);
    const Vector3 w =
        geometry::to_rotation_vector(next[i].R * last[i].R.transpose()) / (2 * kStep_s);
    const Matrix3 inertia = now[i].R * now[i].inertia * now[i].R.transpose();
    total.mass += mass;
    total.centre += mass * c;
    total.potential += mass * kG * c[2];
    total.momentum += mass * v;
    total.angular_momentum += inertia * w + mass * c.cross(v);
    total.energy += 0.5 * mass * v.squaredNorm() + 0.5 * w.dot(inertia * w);
    total.inertia += inertia + mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
  }
  total.centre /= total.mass;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double qd = nu[6 + static_cast<Eigen::Index>(joint)];
    total.energy += 0.5 * model.actuators[joint % 3].reflected_inertia_kg_m2() * qd * qd;
  }
  return total;
}

Place random_place(Random& random) {
  Place place;
  place.R_OB = random_attitude(random);
  for (int i = 0; i < 3; ++i) place.p_OB_m[i] = random.uniform(-1, 1);
  for (int i = 0; i < 12; ++i) place.q_rad[i] = random.uniform(-2.5, 2.5);
  return place;
}

GeneralisedVector random_vector(Random& random, double size) {
  GeneralisedVector v;
  for (int i = 0; i < kVelocities; ++i) v[i] = random.uniform(-size, size);
  return v;
}

MotionState motion(const Place& place, const GeneralisedVector& nu) {
  return {place.R_OB, place.q_rad, nu};
}

TEST(Dynamics, FeetAreWhereTheKinematicsPutThem) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Place place = random_place(random);
    dynamics.update(motion(place, GeneralisedVector::Zero()));
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      const LegVector q = place.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg));
      const PointMotion foot = dynamics.foot(leg);
      EXPECT_LT((foot.p_B_m - foot_position_B_m(model, leg, q)).norm(), 1e-14);
      EXPECT_LT((foot.jacobian_B - foot_jacobian_B(model, leg, q)).norm(), 1e-14);
    }
  }
}

// Velocity and acceleration of the foot and of a point beside it, against moving the robot.
TEST(Dynamics, FootJacobianAndBiasAgreeWithFiniteDifferences) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(2);
  constexpr double kStep_s = 1e-4;
  for (int trial = 0; trial < 300; ++trial) {
    const Place place = random_place(random);
    const GeneralisedVector nu = random_vector(random, 5.0);
    const GeneralisedVector rate = random_vector(random, 20.0);
    dynamics.update(motion(place, nu));
    for (std::size_t leg = 0; leg < kLegs; ++leg) {
      // Third order in time: place(t) with nu(t) = nu + rate t, integrated by the midpoint rule.
      const auto foot_O = [&](double t) {
        Place at = place;
        constexpr int kParts = 8;
        for (int i = 0; i < kParts; ++i) {
          const double middle = t * (i + 0.5) / kParts;
          const GeneralisedVector half = nu + rate * (t * (i + 0.25) / kParts);
          const Matrix3 R_half = moved(at, half, 0.5 * t / kParts).R_OB;
          const GeneralisedVector v = nu + rate * middle;
          const Vector3 p = at.p_OB_m + R_half * v.segment<3>(3) * (t / kParts);
          at = moved(at, v, t / kParts);
          at.p_OB_m = p;
        }
        const LegVector q = at.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg));
        return Vector3(at.p_OB_m + at.R_OB * foot_position_B_m(model, leg, q));
      };
      const Vector3 now = foot_O(0.0);
      const Vector3 next = foot_O(kStep_s);
      const Vector3 last = foot_O(-kStep_s);
      const PointMotion foot = dynamics.foot(leg);
      const auto jacobian = point_jacobian_B(leg, foot);
      const Vector3 v = (next - last) / (2 * kStep_s);
      EXPECT_LT((place.R_OB * (jacobian * nu) - v).norm(), 2e-5);
      EXPECT_LT((jacobian * nu - foot.v_B_m_s).norm(), 1e-12);
      const Vector3 a = (next - 2 * now + last) / (kStep_s * kStep_s);
      EXPECT_LT((place.R_OB * (jacobian * rate + foot.bias_B_m_s2) - a).norm(), 1e-3 * a.norm());
    }
  }
}

// The contact point of a rolling foot: its velocity as a function of time, with an offset that does
// not turn, differentiated.
TEST(Dynamics, BiasOfARollingContactIsTheRateOfItsVelocity) {
  const RobotModel model = full_mini_cheetah();
  Random random(3);
  const Vector3 down_O(0, 0, -0.0175);
  constexpr double kStep_s = 1e-6;
  Dynamics dynamics;
  dynamics.reset(model);
  for (int trial = 0; trial < 300; ++trial) {
    const Place place = random_place(random);
    const GeneralisedVector nu = random_vector(random, 4.0);
    const std::size_t leg = random.below(4);
    const auto velocity_O = [&](double t) {
      const Place at = moved(place, nu, t);
      dynamics.update(motion(at, nu));
      return Vector3(at.R_OB * dynamics.foot(leg, at.R_OB.transpose() * down_O).v_B_m_s);
    };
    const Vector3 rate = (velocity_O(kStep_s) - velocity_O(-kStep_s)) / (2 * kStep_s);
    dynamics.update(motion(place, nu));
    const PointMotion contact = dynamics.foot(leg, place.R_OB.transpose() * down_O);
    EXPECT_LT((place.R_OB * contact.bias_B_m_s2 - rate).norm(), 1e-6);
  }
}

TEST(Dynamics, MassMatrixIsTheHessianOfTheKineticEnergyOfAllParts) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const Place place = random_place(random);
    const GeneralisedVector nu = random_vector(random, 3.0);
    dynamics.update(motion(place, nu));
    MassMatrix m;
    dynamics.mass_matrix(m);
    EXPECT_EQ((m - m.transpose()).norm(), 0.0);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<MassMatrix>(m).eigenvalues()[0], 1e-4);
    const double energy = sums(model, place, nu).energy;
    EXPECT_NEAR(0.5 * nu.dot(m * nu), energy, 1e-6 * energy);
    EXPECT_NEAR(dynamics.kinetic_energy_J(), energy, 1e-6 * energy);
    // The quadratic form at many velocities of one place fixes the matrix.
    for (int other = 0; other < 5; ++other) {
      const GeneralisedVector u = random_vector(random, 3.0);
      EXPECT_NEAR(0.5 * u.dot(m * u), sums(model, place, u).energy, 1e-5);
    }
  }
}

TEST(Dynamics, CentroidAgreesWithTheSumOverAllParts) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    Place place = random_place(random);
    place.p_OB_m.setZero();
    const GeneralisedVector nu = random_vector(random, 3.0);
    dynamics.update(motion(place, nu));
    const Centroid c = dynamics.centroid();
    const Sums total = sums(model, place, nu);
    EXPECT_NEAR(c.mass_kg, 8.912, 1e-12);
    EXPECT_NEAR(c.mass_kg, total.mass, 1e-12);
    EXPECT_LT((place.R_OB * c.p_B_m - total.centre).norm(), 1e-12);
    EXPECT_LT((place.R_OB * c.momentum_B_kg_m_s - total.momentum).norm(), 1e-6);
    const Vector3 about_centre = total.angular_momentum - total.centre.cross(total.momentum);
    EXPECT_LT((place.R_OB * c.angular_momentum_B_kg_m2_s - about_centre).norm(), 1e-6);
    const Matrix3 shift = total.mass * (total.centre.squaredNorm() * Matrix3::Identity() -
                                        total.centre * total.centre.transpose());
    EXPECT_LT(
        (place.R_OB * c.inertia_B_kg_m2 * place.R_OB.transpose() - total.inertia + shift).norm(),
        1e-10);
  }
}

TEST(Dynamics, InverseDynamicsIsMassTimesAccelerationPlusBias) {
  Dynamics dynamics;
  dynamics.reset(full_mini_cheetah());
  Random random(6);
  for (int trial = 0; trial < 1000; ++trial) {
    const Place place = random_place(random);
    dynamics.update(motion(place, random_vector(random, 8.0)));
    const GeneralisedVector a = random_vector(random, 50.0);
    MassMatrix m;
    dynamics.mass_matrix(m);
    const GeneralisedVector force = dynamics.inverse_dynamics(a);
    EXPECT_LT((force - m * a - dynamics.bias()).norm(), 1e-11 * force.norm());
    MassFactor factor;
    ASSERT_TRUE(factor.factor(m));
    EXPECT_LT((factor.solve(force - dynamics.bias()) - a).norm(), 1e-8);
    MassMatrix inverse;
    factor.inverse(inverse);
    EXPECT_LT((inverse * m - MassMatrix::Identity()).norm(), 1e-9);
  }
}

// The bias of a resting robot is the gradient of its potential energy.
TEST(Dynamics, GravityIsTheGradientOfThePotentialEnergy) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(7);
  constexpr double kStep = 1e-5;
  for (int trial = 0; trial < 50; ++trial) {
    const Place place = random_place(random);
    dynamics.update(motion(place, GeneralisedVector::Zero()));
    const GeneralisedVector gravity = dynamics.bias();
    for (int i = 0; i < kVelocities; ++i) {
      const GeneralisedVector along = GeneralisedVector::Unit(i);
      const double up = sums(model, moved(place, along, kStep), along).potential;
      const double down = sums(model, moved(place, along, -kStep), along).potential;
      EXPECT_NEAR(gravity[i], (up - down) / (2 * kStep), 1e-7);
    }
  }
}

// Fourth-order integration of the robot in free flight under joint torques.
struct Flight {
  Dynamics& dynamics;
  Place place;
  GeneralisedVector nu;
  JointVector torque;

  GeneralisedVector acceleration(const Place& at, const GeneralisedVector& v) {
    dynamics.update(motion(at, v));
    MassMatrix m;
    dynamics.mass_matrix(m);
    MassFactor factor;
    EXPECT_TRUE(factor.factor(m));
    GeneralisedVector force = -dynamics.bias();
    force.tail<12>() += torque;
    return factor.solve(force);
  }
  void step(double h) {
    const Place p0 = place;
    const GeneralisedVector a1 = acceleration(p0, nu);
    const GeneralisedVector v2 = nu + 0.5 * h * a1;
    const GeneralisedVector a2 = acceleration(advanced(p0, nu, v2, 0.5 * h), v2);
    place = advanced(p0, nu, nu + h * a2, h);
    nu += h * a2;
  }
  // By the mean of the velocities at both ends, linear part turned by half the turn.
  static Place advanced(const Place& from, const GeneralisedVector& v0, const GeneralisedVector& v1,
                        double h) {
    const GeneralisedVector mean = 0.5 * (v0 + v1);
    Place to = moved(from, mean, h);
    to.p_OB_m = from.p_OB_m + moved(from, mean, 0.5 * h).R_OB * mean.segment<3>(3) * h;
    return to;
  }
};

// In free flight internal torques change neither the angular momentum about the centre of mass nor,
// beyond gravity, the momentum; they change the energy by the work of the joints. Only the right
// velocity-dependent terms can do that.
TEST(Dynamics, FlightKeepsMomentumAndEnergy) {
  const RobotModel model = full_mini_cheetah();
  Dynamics dynamics;
  dynamics.reset(model);
  Random random(8);
  for (int trial = 0; trial < tests::samples(10, 3); ++trial) {
    Flight flight{dynamics, random_place(random), random_vector(random, 4.0), {}};
    for (int i = 0; i < 12; ++i) flight.torque[i] = random.uniform(-2, 2);
    const Sums start = sums(model, flight.place, flight.nu);
    double work = 0;
    constexpr int kSteps = 2000;
    constexpr double kStep_s = 1e-4;
    for (int i = 0; i < kSteps; ++i) {
      const JointVector before = flight.place.q_rad;
      flight.step(kStep_s);
      work += flight.torque.dot(flight.place.q_rad - before);
    }
    const Sums end = sums(model, flight.place, flight.nu);
    const double t = kSteps * kStep_s;
    const Vector3 expected = start.momentum - Vector3(0, 0, start.mass * kG * t);
    EXPECT_LT((end.momentum - expected).norm(), 2e-3) << trial;
    const auto spin = [](const Sums& s) {
      return Vector3(s.angular_momentum - s.centre.cross(s.momentum));
    };
    EXPECT_LT((spin(end) - spin(start)).norm(), 2e-4) << trial;
    EXPECT_NEAR(end.energy + end.potential, start.energy + start.potential + work,
                1e-3 * (1.0 + start.energy));
  }
}

}  // namespace
}  // namespace surefoot::robot
