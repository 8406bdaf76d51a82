#include "apps/surefoot-lab/jump/jump_problem.h"

#include <algorithm>
#include <cmath>

#include "apps/surefoot-lab/jump/jet.h"

namespace surefoot::apps::jump {
namespace {

using First = FirstJet<kNodeSize>;
using Second = SecondJet<kNodeSize>;

constexpr double kUnbounded = 1e19;
constexpr double kEdgeWidth_m = 0.02;  // of the smooth step that stands for a platform's face

constexpr double kContactDrift_m = 0.006;

int torque_of(int joint) { return kTorque + joint; }
// The two coordinates whose difference is a joint's angle.
int outer_of(int joint) { return 3 + joint; }
int inner_of(int joint) { return joint % 2 == 0 ? 2 : 2 + joint; }

}  // namespace

JumpProblem::JumpProblem(const robot::RobotModel& robot, const JumpSettings& settings)
    : robot_(robot), settings_(settings), model_(make_planar_model(robot)) {
  const JumpSettings& s = settings_;
  const auto pose = [&](double x, double ground, double height, double front, double hind) {
    const auto f = leg_angles(model_, front, height - model_.foot_radius_m);
    const auto h = leg_angles(model_, hind, height - model_.foot_radius_m);
    return std::array<double, kCoordinates>{x, ground + height, 0, f[0], f[1], h[0], h[1]};
  };
  first_q_ = pose(0, 0, s.start_height_m, s.start_foot_m, s.start_foot_m);
  last_q_ = pose(s.travel_m, s.rise_m, s.landing_height_m, s.landing_front_m, s.landing_hind_m);
  make_nodes();
  find_structure();
}

void JumpProblem::make_nodes() {
  int step = 0;
  for (int phase = 0; phase < 3; ++phase) {
    const int steps = settings_.steps[static_cast<std::size_t>(phase)];
    for (int i = 0; i <= steps; ++i) {
      JumpNode node;
      node.phase = static_cast<JumpPhase>(phase);
      node.time_s = settings_.step_s * (step + i);
      node.from_phase_start = static_cast<double>(i) / steps;
      const auto use = [&](int first, int count) {
        for (int row = 0; row < count; ++row) node.rows.push_back(first + row);
      };
      use(kMotionRow, 7);
      if (node.phase == JumpPhase::kFourFeet) use(kContactRow, 4);
      if (node.phase == JumpPhase::kTwoFeet) use(kContactRow + 2, 2);
      if (node.phase == JumpPhase::kFourFeet) use(kFrictionRow, 4);
      if (node.phase == JumpPhase::kTwoFeet) use(kFrictionRow + 2, 2);
      use(kJointRow, 4);
      use(kSpeedRow, 8);
      if (node.phase != JumpPhase::kFourFeet) use(kClearanceRow, 1);
      if (node.phase == JumpPhase::kFlight) use(kClearanceRow + 1, 1);
      use(kClearanceRow + 2, 4);
      nodes_.push_back(node);
    }
    step += steps;
  }
}

// The functions of one node, in SI units inside.
template <class T>
void JumpProblem::evaluate(const T* scaled, std::array<T, kNodeRows>& out) const {
  std::array<T, kNodeSize> z;
  for (int i = 0; i < kNodeSize; ++i) z[static_cast<std::size_t>(i)] = scaled[i] * scale_of(i);
  const T* q = z.data();
  const T* v = q + kVelocity;
  const T* torque = q + kTorque;
  const T* force = q + kForce;
  const auto at = [&](int row) -> T& { return out[static_cast<std::size_t>(row)]; };
  const PlanarMotion<T> motion = planar_motion(model_, q, v, q + kAcceleration, torque, force);
  for (int i = 0; i < kCoordinates; ++i) {
    at(kMotionRow + i) = motion.residual[static_cast<std::size_t>(i)] * 0.1;
  }
  T cost(0.0);
  for (int leg = 0; leg < 2; ++leg) {
    const LegPlane<T>& place = motion.legs[static_cast<std::size_t>(leg)];
    // The foot rolls: its centre moves back as the shank turns forward.
    at(kContactRow + 2 * leg) =
        (place.foot_acceleration.x +
         z[static_cast<std::size_t>(kAcceleration + 4 + 2 * leg)] * model_.foot_radius_m) *
        0.1;
    at(kContactRow + 2 * leg + 1) = place.foot_acceleration.z * 0.1;
    at(kFrictionRow + 2 * leg) = (force[2 * leg] - force[2 * leg + 1] * settings_.friction) * 0.01;
    at(kFrictionRow + 2 * leg + 1) =
        (-force[2 * leg] - force[2 * leg + 1] * settings_.friction) * 0.01;
  }
  for (int joint = 0; joint < kPairJoints; ++joint) {
    const int outer = outer_of(joint);
    const int inner = inner_of(joint);
    const auto& actuator = robot_.actuators[joint % 2 == 0 ? 1 : 2];
    at(kJointRow + joint) = q[outer] - q[inner];
    const T speed = v[outer] - v[inner];
    const double slope = 2.0 * actuator.stall_torque_Nm / actuator.no_load_speed_rad_s;
    at(kSpeedRow + 2 * joint) = (torque[joint] + speed * slope) * 0.1;
    at(kSpeedRow + 2 * joint + 1) = (-torque[joint] - speed * slope) * 0.1;
    const double final_rad =
        last_q_[static_cast<std::size_t>(outer)] - last_q_[static_cast<std::size_t>(inner)];
    const T away = at(kJointRow + joint) - final_rad;
    cost += away * away * settings_.posture_weight;
    cost += torque[joint] * torque[joint] * (0.01 * settings_.torque_weight);
    cost += speed * speed * (0.04 * settings_.velocity_weight);
    const T change = (q[kAcceleration + outer] - q[kAcceleration + inner]) * 0.02;
    cost += change * change * settings_.acceleration_weight;
  }
  at(kCostRow) = cost;
  const auto above = [&](const Plane<T>& p, double margin_m) {
    if (settings_.wall_m <= 0) return p.z;
    return p.z - smooth_step((p.x - (settings_.edge_m - margin_m)) * (1.0 / kEdgeWidth_m)) *
                     settings_.wall_m;
  };
  for (int leg = 0; leg < 2; ++leg) {
    const LegPlane<T>& place = motion.legs[static_cast<std::size_t>(leg)];
    at(kClearanceRow + leg) = above(place.foot, settings_.edge_margin_m) - model_.foot_radius_m;
    at(kClearanceRow + 2 + leg) = above(place.knee, settings_.edge_margin_m);
    using std::cos;
    using std::sin;
    const double cx = (leg == 0 ? 0.5 : -0.5) * robot_.trunk_size_m[0];
    const double cz = -0.5 * robot_.trunk_size_m[2];
    const T c = cos(q[2]);
    const T s = sin(q[2]);
    at(kClearanceRow + 4 + leg) =
        above(Plane<T>{q[0] + c * cx - s * cz, q[1] + s * cx + c * cz}, settings_.edge_margin_m);
  }
}

template <class T>
void JumpProblem::evaluate_at(const double* x, std::size_t node,
                              std::array<T, kNodeRows>& out) const {
  std::array<T, kNodeSize> z;
  for (int i = 0; i < kNodeSize; ++i) {
    const double value = x[node * kNodeSize + static_cast<std::size_t>(i)];
    if constexpr (Jet<T>) {
      z[static_cast<std::size_t>(i)] = T::variable(value, i);
    } else {
      z[static_cast<std::size_t>(i)] = value;
    }
  }
  evaluate(z.data(), out);
}

// Which variables a row depends on, and which pairs meet in a product: read off the derivatives at
// points in general position, some of them where the platform's face is felt.
void JumpProblem::find_structure() {
  Eigen::Matrix<bool, kNodeRows, kNodeSize> depends;
  Eigen::Matrix<bool, kNodeSize, kNodeSize> meets;
  depends.setConstant(false);
  meets.setConstant(false);
  auto out = std::vector<std::array<Second, kNodeRows>>(1);
  constexpr int kSamples = 40;
  for (int sample = 0; sample < kSamples; ++sample) {
    std::array<double, kNodeSize> x;
    for (int i = 0; i < kNodeSize; ++i) {
      x[static_cast<std::size_t>(i)] = 0.3 + 0.4 * std::sin(1.0 + 7.3 * i + 1.7 * sample);
    }
    x[0] = settings_.edge_m + 1.0 - 2.0 * sample / kSamples;
    evaluate_at(x.data(), 0, out[0]);
    for (int row = 0; row < kNodeRows; ++row) {
      const Second& jet = out[0][static_cast<std::size_t>(row)];
      for (int i = 0; i < kNodeSize; ++i) {
        depends(row, i) = depends(row, i) || jet.gradient[i] != 0;
        for (int k = 0; k <= i; ++k) meets(i, k) = meets(i, k) || jet.hessian(i, k) != 0;
      }
    }
  }
  for (int row = 0; row < kNodeRows; ++row) {
    for (int i = 0; i < kNodeSize; ++i) {
      if (depends(row, i)) row_columns_[static_cast<std::size_t>(row)].push_back(i);
    }
  }
  for (int i = 0; i < kNodeSize; ++i) {
    for (int k = 0; k <= i; ++k) {
      // The smoothing of torques adds to their diagonal.
      const bool torque = i == k && i >= kTorque && i < kForce;
      if (meets(i, k) || torque) node_hessian_.push_back({i, k});
    }
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const int first = static_cast<int>(n) * kNodeSize;
    first_row_.push_back(constraints_);
    for (const int row : nodes_[n].rows) {
      for (const int i : row_columns_[static_cast<std::size_t>(row)]) {
        jacobian_entries_.push_back({constraints_, first + i});
      }
      ++constraints_;
    }
    for (const Entry& entry : node_hessian_) {
      hessian_entries_.push_back({first + entry.row, first + entry.column});
    }
  }
  for (std::size_t n = 0; n + 1 < nodes_.size(); ++n) {
    const int here = static_cast<int>(n) * kNodeSize;
    const int next = here + kNodeSize;
    const bool same = nodes_[n].phase == nodes_[n + 1].phase;
    for (int i = 0; i < 2 * kCoordinates; ++i) {
      jacobian_entries_.push_back({constraints_, here + i});
      jacobian_entries_.push_back({constraints_, next + i});
      if (same) {
        jacobian_entries_.push_back({constraints_, here + i + kCoordinates});
        jacobian_entries_.push_back({constraints_, next + i + kCoordinates});
        const int stretch = stretch_of(nodes_[n].phase);
        jacobian_entries_.push_back({constraints_, stretch});
        hessian_entries_.push_back({stretch, here + i + kCoordinates});
        hessian_entries_.push_back({stretch, next + i + kCoordinates});
      }
      ++constraints_;
    }
    for (int i = 0; i < kPairJoints; ++i) {
      hessian_entries_.push_back({next + torque_of(i), here + torque_of(i)});
    }
  }
}

double JumpProblem::half_step(int index) const {
  return 0.5 * settings_.step_s * scale_of(index + kCoordinates) / scale_of(index);
}

double JumpProblem::unscaled(const double* x, std::size_t node, int index) {
  return x[node * kNodeSize + static_cast<std::size_t>(index)] * scale_of(index);
}

void JumpProblem::fix_pose(std::size_t node, bool start, Bounds& bounds) const {
  const auto set = [&](int index, double low, double high) {
    const std::size_t i = node * kNodeSize + static_cast<std::size_t>(index);
    bounds.low[i] = low / scale_of(index);
    bounds.high[i] = high / scale_of(index);
  };
  const auto& q = start ? first_q_ : last_q_;
  for (int i = 0; i < kCoordinates; ++i) {
    set(i, q[static_cast<std::size_t>(i)], q[static_cast<std::size_t>(i)]);
    if (start) set(kVelocity + i, 0, 0);
  }
  if (start) return;
  set(kVelocity, 0.0, settings_.max_landing_forward_m_s);
  set(kVelocity + 1, -settings_.max_landing_speed_m_s, 0.0);
  const double rate = settings_.max_landing_pitch_rate_rad_s;
  set(kVelocity + 2, -rate, rate);
  for (int i = 3; i < kCoordinates; ++i) set(kVelocity + i, -6.0, 6.0);
}

Bounds JumpProblem::variable_bounds() const {
  Bounds bounds;
  bounds.low.assign(static_cast<std::size_t>(variables()), -kUnbounded);
  bounds.high.assign(static_cast<std::size_t>(variables()), kUnbounded);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const auto set = [&](int index, double low, double high) {
      const std::size_t i = n * kNodeSize + static_cast<std::size_t>(index);
      bounds.low[i] = low / scale_of(index);
      bounds.high[i] = high / scale_of(index);
    };
    set(2, -settings_.max_pitch_rad, settings_.max_pitch_rad);
    for (int joint = 0; joint < kPairJoints; ++joint) {
      const double limit =
          2.0 * settings_.torque_share * robot_.actuators[joint % 2 == 0 ? 1 : 2].torque_limit_Nm;
      set(torque_of(joint), -limit, limit);
    }
    for (int leg = 0; leg < 2; ++leg) {
      const bool contact = leg == 0 ? nodes_[n].phase == JumpPhase::kFourFeet
                                    : nodes_[n].phase != JumpPhase::kFlight;
      set(kForce + 2 * leg, contact ? -500 : 0, contact ? 500 : 0);
      set(kForce + 2 * leg + 1, contact ? settings_.min_normal_N : 0, contact ? 1000 : 0);
    }
  }
  for (int phase = 0; phase < 3; ++phase) {
    const auto i = static_cast<std::size_t>(stretch_of(static_cast<JumpPhase>(phase)));
    bounds.low[i] = 1.0 / settings_.stretch;
    bounds.high[i] = settings_.stretch;
  }
  fix_pose(0, true, bounds);
  fix_pose(nodes_.size() - 1, false, bounds);
  return bounds;
}

Bounds JumpProblem::row_bounds(const JumpNode& node) const {
  Bounds b;
  b.low.assign(kNodeRows, -kUnbounded);
  b.high.assign(kNodeRows, kUnbounded);
  const auto set = [&](int row, double low, double high) {
    b.low[static_cast<std::size_t>(row)] = low;
    b.high[static_cast<std::size_t>(row)] = high;
  };
  for (int i = 0; i < kFrictionRow; ++i) set(i, 0, 0);
  for (int i = kFrictionRow; i < kJointRow; ++i) set(i, -kUnbounded, 0);
  for (int joint = 0; joint < kPairJoints; ++joint) {
    const auto& actuator = robot_.actuators[joint % 2 == 0 ? 1 : 2];
    set(kJointRow + joint, actuator.min_rad + settings_.joint_margin_rad,
        actuator.max_rad - settings_.joint_margin_rad);
    for (int i = 0; i < 2; ++i) {
      set(kSpeedRow + 2 * joint + i, -kUnbounded,
          0.1 * 2.0 * settings_.torque_share * actuator.stall_torque_Nm);
    }
  }
  // A foot leaves the ground and comes back to it: its clearance grows and shrinks over a few
  // hundredths of a second.
  const double s = node.from_phase_start;
  const bool flight = node.phase == JumpPhase::kFlight;
  const double leaving = std::min(1.0, 5.0 * s);
  const double landing = flight ? std::min(1.0, 4.0 * (1.0 - s)) : 1.0;
  const double front = flight ? landing : leaving;
  // Less the drift of a contact that is kept by its acceleration.
  const auto clearance = [&](double part) {
    return (settings_.clearance_m + kContactDrift_m) * part - kContactDrift_m;
  };
  set(kClearanceRow, clearance(front), kUnbounded);
  set(kClearanceRow + 1, clearance(std::min(leaving, landing)), kUnbounded);
  for (int i = 2; i < 6; ++i) set(kClearanceRow + i, settings_.body_clearance_m, kUnbounded);
  return b;
}

Bounds JumpProblem::constraint_bounds() const {
  Bounds bounds;
  for (const JumpNode& node : nodes_) {
    const Bounds rows = row_bounds(node);
    for (const int row : node.rows) {
      bounds.low.push_back(rows.low[static_cast<std::size_t>(row)]);
      bounds.high.push_back(rows.high[static_cast<std::size_t>(row)]);
    }
  }
  bounds.low.resize(static_cast<std::size_t>(constraints_), 0.0);
  bounds.high.resize(static_cast<std::size_t>(constraints_), 0.0);
  return bounds;
}

double JumpProblem::cost(const double* x) const {
  double sum = 0;
  std::array<double, kNodeRows> out;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    evaluate_at(x, n, out);
    sum += out[kCostRow];
    if (n + 1 == nodes_.size()) break;
    for (int i = 0; i < kPairJoints; ++i) {
      const std::size_t t = n * kNodeSize + static_cast<std::size_t>(torque_of(i));
      const double change = x[t + kNodeSize] - x[t];
      sum += settings_.smooth_weight * change * change;
    }
  }
  return sum;
}

void JumpProblem::gradient(const double* x, double* out) const {
  std::array<First, kNodeRows> jets;
  std::fill(out, out + variables(), 0.0);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    evaluate_at(x, n, jets);
    for (int i = 0; i < kNodeSize; ++i) {
      out[n * kNodeSize + static_cast<std::size_t>(i)] += jets[kCostRow].gradient[i];
    }
    if (n + 1 == nodes_.size()) break;
    for (int i = 0; i < kPairJoints; ++i) {
      const std::size_t t = n * kNodeSize + static_cast<std::size_t>(torque_of(i));
      const double change = 2.0 * settings_.smooth_weight * (x[t + kNodeSize] - x[t]);
      out[t + kNodeSize] += change;
      out[t] -= change;
    }
  }
}

void JumpProblem::constraints(const double* x, double* out) const {
  std::array<double, kNodeRows> rows;
  std::size_t c = 0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    evaluate_at(x, n, rows);
    for (const int row : nodes_[n].rows) out[c++] = rows[static_cast<std::size_t>(row)];
  }
  for (std::size_t n = 0; n + 1 < nodes_.size(); ++n) {
    const bool same = nodes_[n].phase == nodes_[n + 1].phase;
    for (int i = 0; i < 2 * kCoordinates; ++i) {
      const std::size_t here = n * kNodeSize + static_cast<std::size_t>(i);
      const std::size_t next = here + kNodeSize;
      double value = x[next] - x[here];
      if (same) {
        const double h = half_step(i) * x[stretch_of(nodes_[n].phase)];
        value -= h * (x[here + kCoordinates] + x[next + kCoordinates]);
      }
      out[c++] = value;
    }
  }
}

void JumpProblem::jacobian(const double* x, double* out) const {
  std::array<First, kNodeRows> jets;
  std::size_t c = 0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    evaluate_at(x, n, jets);
    for (const int row : nodes_[n].rows) {
      const auto r = static_cast<std::size_t>(row);
      for (const int i : row_columns_[r]) out[c++] = jets[r].gradient[i];
    }
  }
  for (std::size_t n = 0; n + 1 < nodes_.size(); ++n) {
    const bool same = nodes_[n].phase == nodes_[n + 1].phase;
    for (int i = 0; i < 2 * kCoordinates; ++i) {
      out[c++] = -1.0;
      out[c++] = 1.0;
      if (!same) continue;
      const double h = half_step(i) * x[stretch_of(nodes_[n].phase)];
      out[c++] = -h;
      out[c++] = -h;
      const std::size_t here = n * kNodeSize + static_cast<std::size_t>(i + kCoordinates);
      out[c++] = -half_step(i) * (x[here] + x[here + kNodeSize]);
    }
  }
}

void JumpProblem::hessian(const double* x, double cost_factor, const double* multipliers,
                          double* out) const {
  std::vector<std::array<Second, kNodeRows>> jets(1);
  const double smooth = 2.0 * settings_.smooth_weight * cost_factor;
  std::size_t c = 0;
  std::size_t m = 0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    evaluate_at(x, n, jets[0]);
    Second::Hessian sum = cost_factor * jets[0][kCostRow].hessian;
    for (const int row : nodes_[n].rows) {
      sum += multipliers[m++] * jets[0][static_cast<std::size_t>(row)].hessian;
    }
    const int neighbours = (n > 0 ? 1 : 0) + (n + 1 < nodes_.size() ? 1 : 0);
    for (int i = 0; i < kPairJoints; ++i) {
      sum(torque_of(i), torque_of(i)) += smooth * neighbours;
    }
    for (const Entry& entry : node_hessian_) out[c++] = sum(entry.row, entry.column);
  }
  for (std::size_t n = 0; n + 1 < nodes_.size(); ++n) {
    const bool same = nodes_[n].phase == nodes_[n + 1].phase;
    for (int i = 0; i < 2 * kCoordinates; ++i) {
      const double multiplier = multipliers[m++];
      if (!same) continue;
      out[c++] = -half_step(i) * multiplier;
      out[c++] = -half_step(i) * multiplier;
    }
    for (int i = 0; i < kPairJoints; ++i) out[c++] = -smooth;
  }
}

}  // namespace surefoot::apps::jump
