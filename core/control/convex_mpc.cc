#include "core/control/convex_mpc.h"

#include "core/control/friction_pyramid.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/math/gravity.h"

namespace surefoot::control {
namespace {

// Directions of force space whose squared lever is below this move nothing (feet in one line, one
// foot, none): they are left to effort.
constexpr double kSmallestPivot = 1e-9;

using Matrix36 = Eigen::Matrix<double, 3, 6>;

bool finite(const Vector3& v) {
  return math::is_finite(v[0]) && math::is_finite(v[1]) && math::is_finite(v[2]);
}

bool finite(const MpcState& state) {
  return finite(state.p_OB_m) && finite(state.v_OB_m_s) && finite(state.roll_pitch_yaw_rad) &&
         finite(state.angular_velocity_O_rad_s);
}

bool positive_definite(const Matrix3& m) {
  return m(0, 0) > 0 && m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) > 0 && m.determinant() > 0;
}

bool usable(const MpcProblem& problem) {
  bool good = finite(problem.p_OB_m) && finite(problem.v_OB_m_s) &&
              finite(problem.angular_velocity_O_rad_s) && problem.mass_kg > 0 &&
              math::is_finite(problem.mass_kg);
  for (Eigen::Index i = 0; i < 3; ++i) {
    good = good && finite(problem.R_OB.col(i)) && finite(problem.inertia_B_kg_m2.col(i));
  }
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    good = good && finite(problem.reference[k]);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      good = good && (!problem.stands[k][leg] || finite(problem.contact_O_m[k][leg]));
    }
  }
  return good && positive_definite(problem.inertia_B_kg_m2);
}

Vector3 as_vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace

void ConvexMpc::reset(const MpcConfig& config) {
  config_ = config;
  qp_.reset();
  solution_ = MpcSolution{};
  has_last_ = false;
}

const MpcSolution& ConvexMpc::solve(const MpcProblem& problem) {
  const std::size_t shift = problem.steps_since_last;
  const bool continues = has_last_ && shift < kMpcHorizon;
  if (continues) {
    qp_.shift(shift);
  } else {
    qp_.reset();
  }
  const bool plan_continues = continues && problem.stands[0] == stood_[shift];
  bool solved = false;
  if (usable(problem)) {
    describe_steps(problem);
    coast(problem);
    condense(problem);
    bound_forces(problem);
    qp_.solve();
    solution_.residual_N = qp_.residual_N();
    solution_.iterations = HorizonQp::kIterations;
    solved = take_solution(problem);
    if (!solved) fall_back(problem, plan_continues);
    predict(problem);
  } else {
    solution_.residual_N = 0;
    solution_.iterations = 0;
    fall_back(problem, plan_continues);
    solution_.predicted.fill(MpcState{});
  }
  if (!solved) qp_.reset();
  if (solved) solution_.source = MpcSource::kSolved;
  solution_.fallbacks += solved ? 0 : 1;
  stood_ = problem.stands;
  has_last_ = true;
  return solution_;
}

void ConvexMpc::describe_steps(const MpcProblem& problem) {
  const double yaw_rad = geometry::to_roll_pitch_yaw(problem.R_OB)[2];
  const Matrix3 inverse_inertia_B = problem.inertia_B_kg_m2.inverse();
  double last_yaw_rad = yaw_rad;
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    Step& step = steps_[k];
    step.reference = problem.reference[k];
    double& yaw = step.reference.roll_pitch_yaw_rad[2];
    yaw = last_yaw_rad + math::wrap_angle(yaw - last_yaw_rad);
    last_yaw_rad = yaw;
    // Half way through the step; the turn within the first one is the reference's, too.
    const double middle = yaw - 0.5 * config_.step_s * step.reference.angular_velocity_O_rad_s[2];
    const Matrix3 turn = geometry::rotation_z(middle);
    step.angle_rate = turn.transpose();
    step.inverse_inertia = turn * inverse_inertia_B * turn.transpose();
    describe_contacts(problem, k);
  }
}

// The step's six rows Q = C^-1 G, with G the forces' wrench about the body and C the Cholesky
// factor of G G'. Three rows are the mean force, three what is left of the levers about the feet's
// centre.
void ConvexMpc::describe_contacts(const MpcProblem& problem, std::size_t k) {
  Step& step = steps_[k];
  const Vector3 from = k == 0 ? problem.p_OB_m : problem.reference[k - 1].p_OB_m;
  const Vector3 body = 0.5 * (from + problem.reference[k].p_OB_m);
  double feet = 0;
  Vector3 centre = Vector3::Zero();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (!problem.stands[k][leg]) continue;
    step.lever_O_m[leg] = problem.contact_O_m[k][leg] - body;
    centre += step.lever_O_m[leg];
    feet += 1.0;
  }
  if (feet > 0) centre /= feet;
  step.force_root = math::sqrt(feet);
  Matrix3 spread = Matrix3::Zero();
  std::array<Matrix3, robot::kLegs> arm;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    arm[leg].setZero();
    if (problem.stands[k][leg]) arm[leg] = geometry::cross_matrix(step.lever_O_m[leg] - centre);
    spread += arm[leg] * arm[leg].transpose();
  }
  // Cholesky of a matrix that may be singular: a pivot of nothing leaves a column and a row of 0.
  Matrix3 root = Matrix3::Zero();
  Vector3 scale = Vector3::Zero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    double pivot = spread(j, j);
    for (Eigen::Index i = 0; i < j; ++i) pivot -= root(j, i) * root(j, i);
    if (pivot < kSmallestPivot) continue;
    root(j, j) = math::sqrt(pivot);
    scale[j] = 1.0 / root(j, j);
    for (Eigen::Index i = j + 1; i < 3; ++i) {
      double sum = spread(i, j);
      for (Eigen::Index l = 0; l < j; ++l) sum -= root(i, l) * root(j, l);
      root(i, j) = sum * scale[j];
    }
  }
  step.moment_root << geometry::cross_matrix(centre) * step.force_root, root;

  const double mean = feet > 0 ? 1.0 / step.force_root : 0.0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const double share = problem.stands[k][leg] ? mean : 0.0;
    Matrix3 rows;  // root^-1 arm, by forward substitution
    for (Eigen::Index j = 0; j < 3; ++j) {
      rows.row(j) = arm[leg].row(j);
      for (Eigen::Index i = 0; i < j; ++i) rows.row(j) -= root(j, i) * rows.row(i);
      rows.row(j) *= scale[j];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t axis = 3 * leg + i;
      for (std::size_t j = 0; j < 3; ++j) {
        qp_.problem().q[j][axis][k] = i == j ? static_cast<float>(share) : 0.0f;
        qp_.problem().q[3 + j][axis][k] =
            static_cast<float>(rows(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)));
      }
    }
  }
}

// The body in free fall.
void ConvexMpc::coast(const MpcProblem& problem) {
  const double dt = config_.step_s;
  const Vector3 gravity(0.0, 0.0, -kGravity_m_s2);
  MpcState state;
  state.p_OB_m = problem.p_OB_m;
  state.v_OB_m_s = problem.v_OB_m_s;
  state.roll_pitch_yaw_rad = geometry::to_roll_pitch_yaw(problem.R_OB);
  state.angular_velocity_O_rad_s = problem.angular_velocity_O_rad_s;
  for (Step& step : steps_) {
    state.p_OB_m += dt * state.v_OB_m_s + 0.5 * dt * dt * gravity;
    state.v_OB_m_s += dt * gravity;
    state.roll_pitch_yaw_rad += dt * (step.angle_rate * state.angular_velocity_O_rad_s);
    step.free = state;
  }
}

void ConvexMpc::condense(const MpcProblem& problem) {
  const double dt = config_.step_s;
  for (std::size_t j = 0; j < kMpcHorizon; ++j) {
    Matrix3 sum = 0.5 * dt * dt * steps_[j].angle_rate;
    angle_response_[j][j] = sum;
    for (std::size_t k = j + 1; k < kMpcHorizon; ++k) {
      sum += dt * dt * steps_[k].angle_rate;
      angle_response_[k][j] = sum;
    }
    turning_[j] = steps_[j].inverse_inertia * steps_[j].moment_root;
  }
  condense_turning();
  condense_motion(problem.mass_kg);
}

// W and h of the moments: blocks of six by six for every two steps.
void ConvexMpc::condense_turning() {
  HorizonQp::Problem& qp = qp_.problem();
  const double dt = config_.step_s;
  const Vector3 angle_weight = as_vector(config_.attitude_weight);
  const Vector3 rate_weight = as_vector(config_.rate_weight);
  for (std::size_t j = 0; j < kMpcHorizon; ++j) {
    Vector3 pull = Vector3::Zero();
    for (std::size_t k = j; k < kMpcHorizon; ++k) {
      const Vector3 angle =
          steps_[k].free.roll_pitch_yaw_rad - steps_[k].reference.roll_pitch_yaw_rad;
      const Vector3 rate =
          steps_[k].free.angular_velocity_O_rad_s - steps_[k].reference.angular_velocity_O_rad_s;
      pull += angle_response_[k][j].transpose() * angle_weight.cwiseProduct(angle) +
              dt * rate_weight.cwiseProduct(rate);
    }
    const Wrench h = turning_[j].transpose() * pull;
    for (std::size_t c = 0; c < HorizonQp::kComponents; ++c) {
      qp.h[c * kMpcHorizon + j] = h[static_cast<Eigen::Index>(c)];
    }
    for (std::size_t i = 0; i <= j; ++i) {
      const double steps_after = static_cast<double>(kMpcHorizon - j);
      Matrix3 middle = (dt * dt * steps_after * rate_weight).asDiagonal();
      for (std::size_t k = j; k < kMpcHorizon; ++k) {
        const Matrix3 weighted = angle_weight.asDiagonal() * angle_response_[k][j];
        middle += angle_response_[k][i].transpose() * weighted;
      }
      const Matrix36 right = middle * turning_[j];
      const Matrix6 block = turning_[i].transpose() * right;
      for (std::size_t c = 0; c < HorizonQp::kComponents; ++c) {
        for (std::size_t d = 0; d < HorizonQp::kComponents; ++d) {
          const double value = block(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d));
          qp.w[c * kMpcHorizon + i][d * kMpcHorizon + j] = value;
          qp.w[d * kMpcHorizon + j][c * kMpcHorizon + i] = value;
        }
      }
    }
  }
}

// W and h of the forces: they move the body along each axis by itself.
void ConvexMpc::condense_motion(double mass_kg) {
  HorizonQp::Problem& qp = qp_.problem();
  const double dt = config_.step_s;
  const double speed = dt / mass_kg;  // gained in one step, per newton
  // Way at the end of step k from one newton in step j.
  const auto way = [&](std::size_t k, std::size_t j) {
    return speed * dt * (static_cast<double>(k - j) + 0.5);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    const double place_weight = config_.position_weight[axis];
    const double speed_weight = config_.velocity_weight[axis];
    for (std::size_t j = 0; j < kMpcHorizon; ++j) {
      double pull = 0;
      for (std::size_t k = j; k < kMpcHorizon; ++k) {
        const MpcState& free = steps_[k].free;
        const MpcState& wanted = steps_[k].reference;
        pull += way(k, j) * place_weight * (free.p_OB_m[row] - wanted.p_OB_m[row]) +
                speed * speed_weight * (free.v_OB_m_s[row] - wanted.v_OB_m_s[row]);
      }
      qp.h[axis * kMpcHorizon + j] += steps_[j].force_root * pull;
      for (std::size_t i = 0; i <= j; ++i) {
        double sum = static_cast<double>(kMpcHorizon - j) * speed * speed * speed_weight;
        for (std::size_t k = j; k < kMpcHorizon; ++k) sum += way(k, i) * place_weight * way(k, j);
        sum *= steps_[i].force_root * steps_[j].force_root;
        qp.w[axis * kMpcHorizon + i][axis * kMpcHorizon + j] += sum;
        if (i != j) qp.w[axis * kMpcHorizon + j][axis * kMpcHorizon + i] += sum;
      }
    }
  }
}

void ConvexMpc::bound_forces(const MpcProblem& problem) {
  HorizonQp::Problem& qp = qp_.problem();
  qp.effort = config_.effort_weight;
  qp.friction = config_.friction;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      const bool stands = problem.stands[k][leg];
      qp.low_N[leg][k] = stands ? static_cast<float>(config_.min_normal_N) : 0.0f;
      qp.high_N[leg][k] = stands ? static_cast<float>(config_.max_normal_N) : 0.0f;
    }
  }
}

// The solver's floats are feasible to their rounding; in double exactly.
Vector3 ConvexMpc::feasible(const Vector3& force_O_N) const {
  Vector3 f = force_O_N;
  FrictionPyramid<double>(config_.friction)
      .project(f[0], f[1], f[2], config_.min_normal_N, config_.max_normal_N);
  return f;
}

// False: not finite, or the two copies do not agree; solution_'s forces are then as they were.
bool ConvexMpc::take_solution(const MpcProblem& problem) {
  const HorizonQp::Forces& forces = qp_.forces_N();
  float sum = 0.0f;
  for (const HorizonQp::Lane& lane : forces) {
    for (const float force : lane) sum += force;
  }
  if (!math::is_finite(static_cast<double>(sum)) || !(qp_.residual_N() <= config_.max_residual_N)) {
    return false;
  }
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const Vector3 force(static_cast<double>(forces[3 * leg][k]),
                          static_cast<double>(forces[3 * leg + 1][k]),
                          static_cast<double>(forces[3 * leg + 2][k]));
      solution_.force_O_N[k][leg] = problem.stands[k][leg] ? feasible(force) : Vector3::Zero();
    }
  }
  return true;
}

void ConvexMpc::fall_back(const MpcProblem& problem, bool plan_continues) {
  const std::size_t shift = problem.steps_since_last;
  const bool mass_known = problem.mass_kg > 0 && math::is_finite(problem.mass_kg);
  solution_.source = plan_continues ? MpcSource::kShifted : MpcSource::kWeight;
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    double feet = 0;
    for (const bool stands : problem.stands[k]) feet += stands ? 1.0 : 0.0;
    const double share = feet > 0 && mass_known ? problem.mass_kg * kGravity_m_s2 / feet : 0.0;
    const bool known =
        plan_continues && k + shift < kMpcHorizon && problem.stands[k] == stood_[k + shift];
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const Vector3 last = known ? solution_.force_O_N[k + shift][leg] : Vector3(0.0, 0.0, share);
      solution_.force_O_N[k][leg] = problem.stands[k][leg] ? feasible(last) : Vector3::Zero();
    }
  }
}

void ConvexMpc::predict(const MpcProblem& problem) {
  const double dt = config_.step_s;
  Vector3 velocity = Vector3::Zero();  // beyond free fall
  Vector3 place = Vector3::Zero();
  Vector3 rate = Vector3::Zero();
  Vector3 angle = Vector3::Zero();
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    const Step& step = steps_[k];
    Vector3 force = Vector3::Zero();
    Vector3 moment = Vector3::Zero();
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      if (!problem.stands[k][leg]) continue;
      force += solution_.force_O_N[k][leg];
      moment += step.lever_O_m[leg].cross(solution_.force_O_N[k][leg]);
    }
    const Vector3 acceleration = force / problem.mass_kg;
    const Vector3 turning = step.inverse_inertia * moment;
    place += dt * velocity + 0.5 * dt * dt * acceleration;
    velocity += dt * acceleration;
    angle += step.angle_rate * (dt * rate + 0.5 * dt * dt * turning);
    rate += dt * turning;
    MpcState& state = solution_.predicted[k];
    state.p_OB_m = step.free.p_OB_m + place;
    state.v_OB_m_s = step.free.v_OB_m_s + velocity;
    state.roll_pitch_yaw_rad = step.free.roll_pitch_yaw_rad + angle;
    state.angular_velocity_O_rad_s = step.free.angular_velocity_O_rad_s + rate;
  }
}

}  // namespace surefoot::control
