#include "tests/support/mpc_oracle.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

namespace surefoot::tests {
namespace {

using Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr Index kHorizon = static_cast<Index>(control::kMpcHorizon);
constexpr Index kStates = 13;  // roll pitch yaw, p, omega, v, gravity

Matrix3 turn_z(double angle) {
  Matrix3 r;
  r << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return r;
}

Matrix3 skew(const Vector3& v) {
  Matrix3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

Matrix exponential(const Matrix& m) {
  Matrix term = Matrix::Identity(m.rows(), m.cols());
  Matrix sum = term;
  for (int i = 1; i < 20; ++i) {
    term = term * m / static_cast<double>(i);
    sum += term;
  }
  return sum;
}

struct Foot {
  std::size_t step;
  std::size_t leg;
};

struct Model {
  std::vector<Matrix> a;
  std::vector<Matrix> b;  // 12 columns, zero for feet that do not stand
  Vector start;
  std::vector<Vector> wanted;
  Vector weight;
  std::vector<Foot> feet;
};

Vector start_of(const control::MpcProblem& problem) {
  const Matrix3& r = problem.R_OB;
  Vector x(kStates);
  x << std::atan2(r(2, 1), r(2, 2)), -std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
      std::atan2(r(1, 0), r(0, 0)), problem.p_OB_m, problem.angular_velocity_O_rad_s,
      problem.v_OB_m_s, -9.81;
  return x;
}

Model model_of(const control::MpcProblem& problem, const control::MpcConfig& config) {
  Model model;
  model.start = start_of(problem);
  model.weight = Vector::Zero(kStates);
  for (Index i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    model.weight[i] = config.attitude_weight[axis];
    model.weight[3 + i] = config.position_weight[axis];
    model.weight[6 + i] = config.rate_weight[axis];
    model.weight[9 + i] = config.velocity_weight[axis];
  }
  double yaw = model.start[2];
  Vector3 from = problem.p_OB_m;
  for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
    const control::MpcState& reference = problem.reference[k];
    yaw += std::remainder(reference.roll_pitch_yaw_rad[2] - yaw, 2.0 * M_PI);
    Vector wanted(kStates);
    wanted << reference.roll_pitch_yaw_rad, reference.p_OB_m, reference.angular_velocity_O_rad_s,
        reference.v_OB_m_s, 0.0;
    wanted[2] = yaw;
    model.wanted.push_back(wanted);

    const double middle = yaw - 0.5 * config.step_s * reference.angular_velocity_O_rad_s[2];
    const Matrix3 turn = turn_z(middle);
    const Matrix3 inertia = turn * problem.inertia_B_kg_m2 * turn.transpose();
    const Vector3 body = 0.5 * (from + reference.p_OB_m);
    from = reference.p_OB_m;
    Matrix m = Matrix::Zero(kStates + 12, kStates + 12);
    m.block<3, 3>(0, 6) = turn.transpose();
    m.block<3, 3>(3, 9).setIdentity();
    m(11, 12) = 1.0;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      if (!problem.stands[k][leg]) continue;
      const Index column = kStates + 3 * static_cast<Index>(leg);
      m.block<3, 3>(6, column) = inertia.inverse() * skew(problem.contact_O_m[k][leg] - body);
      m.block<3, 3>(9, column) = Matrix3::Identity() / problem.mass_kg;
      model.feet.push_back({k, leg});
    }
    const Matrix step = exponential(m * config.step_s);
    model.a.push_back(step.topLeftCorner(kStates, kStates));
    model.b.push_back(step.topRightCorner(kStates, 12));
  }
  return model;
}

struct Dense {
  Matrix hessian;
  Vector gradient;
};

Dense condense(const Model& model, double effort) {
  const auto count = static_cast<Index>(model.feet.size());
  Matrix response = Matrix::Zero(kStates * kHorizon, 3 * count);
  Vector error(kStates * kHorizon);
  Vector weight(kStates * kHorizon);
  Vector x = model.start;
  Matrix last = Matrix::Zero(kStates, 3 * count);
  for (Index k = 0; k < kHorizon; ++k) {
    const auto step = static_cast<std::size_t>(k);
    x = model.a[step] * x;
    last = model.a[step] * last;
    for (Index i = 0; i < count; ++i) {
      const Foot& foot = model.feet[static_cast<std::size_t>(i)];
      if (foot.step != step) continue;
      last.block(0, 3 * i, kStates, 3) =
          model.b[step].block(0, 3 * static_cast<Index>(foot.leg), kStates, 3);
    }
    response.middleRows(kStates * k, kStates) = last;
    error.segment(kStates * k, kStates) = x - model.wanted[step];
    weight.segment(kStates * k, kStates) = model.weight;
  }
  const Matrix weighted = weight.asDiagonal() * response;
  Dense dense;
  dense.hessian = 2.0 * (response.transpose() * weighted);
  dense.hessian.diagonal().array() += 2.0 * effort;
  dense.gradient = 2.0 * (weighted.transpose() * error);
  return dense;
}

// Six rows per foot: C f <= d.
Eigen::Matrix<double, 6, 3> sides(double mu) {
  Eigen::Matrix<double, 6, 3> c;
  c << 1, 0, -mu, -1, 0, -mu, 0, 1, -mu, 0, -1, -mu, 0, 0, -1, 0, 0, 1;
  return c;
}

double longest_step(const Vector& value, const Vector& change) {
  double step = 1.0;
  for (Index i = 0; i < value.size(); ++i) {
    if (change[i] < 0.0) step = std::min(step, -0.995 * value[i] / change[i]);
  }
  return step;
}

class InteriorPoint {
 public:
  InteriorPoint(const Dense& dense, const control::MpcConfig& config)
      : dense_(dense), side_(sides(config.friction)), n_(dense.gradient.size()) {
    limit_ << 0, 0, 0, 0, -config.min_normal_N, config.max_normal_N;
    f_ = Vector::Zero(n_);
    for (Index i = 2; i < n_; i += 3) {
      f_[i] = 0.5 * (config.min_normal_N + config.max_normal_N);
    }
    slack_ = (limits() - forward(f_)).cwiseMax(1.0);
    dual_ = Vector::Constant(slack_.size(), 0.01);
  }

  double solve() {
    for (int i = 0; i < 60 && optimality() > 1e-10; ++i) iterate();
    return optimality();
  }
  const Vector& forces() const { return f_; }

 private:
  Vector forward(const Vector& f) const {
    Vector out(2 * n_);
    for (Index i = 0; i < n_ / 3; ++i) out.segment<6>(6 * i) = side_ * f.segment<3>(3 * i);
    return out;
  }
  Vector backward(const Vector& y) const {
    Vector out(n_);
    for (Index i = 0; i < n_ / 3; ++i) {
      out.segment<3>(3 * i) = side_.transpose() * y.segment<6>(6 * i);
    }
    return out;
  }
  Vector limits() const { return limit_.replicate(n_ / 3, 1); }
  Vector stationarity() const { return dense_.hessian * f_ + dense_.gradient + backward(dual_); }
  double optimality() const {
    const double scale = 1.0 + dense_.gradient.lpNorm<Eigen::Infinity>();
    const double feasibility = (forward(f_) + slack_ - limits()).lpNorm<Eigen::Infinity>();
    const double gap = slack_.cwiseProduct(dual_).lpNorm<Eigen::Infinity>();
    return std::max({stationarity().lpNorm<Eigen::Infinity>() / scale, feasibility * 1e-3, gap});
  }

  void iterate() {
    Matrix kkt = dense_.hessian;
    for (Index i = 0; i < n_ / 3; ++i) {
      const Vector6 ratio = dual_.segment<6>(6 * i).cwiseQuotient(slack_.segment<6>(6 * i));
      kkt.block<3, 3>(3 * i, 3 * i) += side_.transpose() * ratio.asDiagonal() * side_;
    }
    factor_.compute(kkt);
    const Vector complementary = slack_.cwiseProduct(dual_);
    const double mean = complementary.mean();
    direction(complementary);
    const double primal = longest_step(slack_, slack_change_);
    const double dual = longest_step(dual_, dual_change_);
    const double after = (slack_ + primal * slack_change_).dot(dual_ + dual * dual_change_) /
                         static_cast<double>(slack_.size());
    const double centring = std::pow(after / mean, 3.0) * mean;
    direction((complementary + slack_change_.cwiseProduct(dual_change_)).array() - centring);
    // One step length: the objective couples the primal and the dual residual.
    const double step =
        std::min(longest_step(slack_, slack_change_), longest_step(dual_, dual_change_));
    f_ += step * force_change_;
    slack_ += step * slack_change_;
    dual_ += step * dual_change_;
  }

  void direction(const Vector& complementary) {
    const Vector infeasible = forward(f_) + slack_ - limits();
    const Vector right = (complementary - dual_.cwiseProduct(infeasible)).cwiseQuotient(slack_);
    force_change_ = factor_.solve(-stationarity() + backward(right));
    slack_change_ = -infeasible - forward(force_change_);
    dual_change_ = -(complementary + dual_.cwiseProduct(slack_change_)).cwiseQuotient(slack_);
  }

  const Dense& dense_;
  Eigen::Matrix<double, 6, 3> side_;
  Vector6 limit_;
  Index n_;
  Vector f_, slack_, dual_, force_change_, slack_change_, dual_change_;
  Eigen::LLT<Matrix> factor_;
};

}  // namespace

MpcOracleSolution solve_exactly(const control::MpcProblem& problem,
                                const control::MpcConfig& config) {
  const Model model = model_of(problem, config);
  MpcOracleSolution solution;
  for (auto& step : solution.force_O_N) step.fill(Vector3::Zero());
  if (model.feet.empty()) return solution;
  const Dense dense = condense(model, config.effort_weight);
  InteriorPoint method(dense, config);
  solution.optimality = method.solve();
  for (std::size_t i = 0; i < model.feet.size(); ++i) {
    solution.force_O_N[model.feet[i].step][model.feet[i].leg] =
        method.forces().segment<3>(3 * static_cast<Index>(i));
  }
  return solution;
}

double mpc_cost(const control::MpcProblem& problem, const control::MpcConfig& config,
                const std::array<std::array<Vector3, robot::kLegs>, control::kMpcHorizon>& force) {
  const Model model = model_of(problem, config);
  Vector x = model.start;
  double cost = 0;
  for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
    Vector u(12);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      u.segment<3>(3 * static_cast<Index>(leg)) = force[k][leg];
    }
    x = model.a[k] * x + model.b[k] * u;
    const Vector error = x - model.wanted[k];
    cost += error.dot(model.weight.cwiseProduct(error)) + config.effort_weight * u.squaredNorm();
  }
  return cost;
}

}  // namespace surefoot::tests
