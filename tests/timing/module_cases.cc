// Parts of the control task on their own, with inputs worse than the whole task can be given.
#include <algorithm>

#include "core/autonomy/tick.h"
#include "core/base/assert.h"
#include "core/control/locomotion.h"
#include "core/estimation/estimator.h"
#include "core/mapping/foothold.h"
#include "core/math/gravity.h"
#include "core/robot/kinematics.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

constexpr double kStep_s = 0.002;

// A level window of 100 x 100 cells around O's origin where every cell has a height.
void fill(mapping::MapWindow& window, double cell_size_m, mapping::Traversability traversability) {
  window.frames = 1;
  window.stamp = milliseconds(1);
  window.cell_size_m = cell_size_m;
  window.first = {-mapping::kWindowSide / 2, -mapping::kWindowSide / 2};
  mapping::WindowCell cell;
  cell.state = mapping::CellState::kMeasured;
  cell.traversability = traversability;
  cell.margin_cells =
      traversability == mapping::Traversability::kSteppable ? mapping::kMaxMargin_cells : 0;
  window.cells.fill(cell);
}

// Sixteen IMU samples and four feet, which all stand; when `slip`, their joints turn as no standing
// foot can, and the feet are left out.
template <bool kSlip>
class Estimate final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({});
    model_ = config.robot;
    estimator_.reset(config.autonomy.estimation, model_, kStep_s);
    stand(config.autonomy.control.body.height_m);
    for (int i = 0; i < 500; ++i) {
      sample(2);
      update();
    }
    sample(imu_.size());
    if (kSlip) {
      for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
        joints_[robot::joint_index(leg, 0)].velocity_rad_s = 6.0;
      }
    }
    return true;
  }
  void run() override { update(); }
  bool did_the_work() override {
    const auto& feet = estimator_.state().feet;
    const bool sure = estimator_.state().v_OB_m_s.norm() < 0.05;  // nothing of the slip got in
    return refused_ == 0 && estimator_.ready() && sure &&
           std::all_of(feet.begin(), feet.end(), [](const auto& foot) { return foot.in_contact; });
  }

 private:
  void stand(double height_m) {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      Vector3 foot = robot::hip_joint_B_m(model_, leg);
      foot[2] = -height_m + model_.foot_radius_m;
      const Vector3 q = robot::solve_leg(model_, leg, foot).q_rad;
      const Vector3 weight(0, 0, 0.25 * model_.total_mass_kg() * kGravity_m_s2);
      const Vector3 torque = -(robot::foot_jacobian_B(model_, leg, q).transpose() * weight);
      for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
        actuation::JointState& joint = joints_[robot::joint_index(leg, i)];
        joint.position_rad = q[static_cast<Eigen::Index>(i)];
        joint.torque_Nm = torque[static_cast<Eigen::Index>(i)];
        joint.valid = true;
      }
    }
  }
  void sample(std::size_t count) {
    count_ = count;
    for (std::size_t i = 0; i < count; ++i) {
      imu_[i].stamp = stamp_ + TimeNs{milliseconds(2).ns * static_cast<std::int64_t>(i + 1) /
                                      static_cast<std::int64_t>(count)};
      imu_[i].angular_velocity_I_rad_s = {0.002, -0.001, 0.003};
      imu_[i].specific_force_I_m_s2 = {0.05, -0.04, kGravity_m_s2};
    }
    stamp_ = stamp_ + milliseconds(2);
  }
  void update() {
    refused_ += estimator_.update(stamp_, {imu_.data(), count_}, joints_, gait_, false);
  }

  robot::RobotModel model_;
  estimation::Estimator estimator_;
  TimeNs stamp_;
  std::size_t count_ = 0;
  std::size_t refused_ = 0;
  std::array<hal::ImuSample, autonomy::kMaxImuSamplesPerTick> imu_{};
  std::array<actuation::JointState, robot::kJoints> joints_{};
  std::array<estimation::GaitPhase, robot::kLegs> gait_{};
};

// The largest disc, where the only place to step lies in its last ring.
class FootholdSearch final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({});
    fill(window_, config.autonomy.mapping.cell_size_m, mapping::Traversability::kUnsteppable);
    const double size = window_.cell_size_m;
    query_.x_O_m = query_.y_O_m = 0.5 * size;
    query_.max_radius_m = mapping::kMaxSearchRadius_cells * size;
    query_.margin_weight_m = config.autonomy.control.foothold.margin_weight_m;
    constexpr std::int32_t kMiddle = mapping::kWindowSide / 2;
    const std::int32_t last = kMiddle + mapping::kMaxSearchRadius_cells;
    window_.cells[static_cast<std::size_t>(last * mapping::kWindowSide + kMiddle)].traversability =
        mapping::Traversability::kSteppable;
    return true;
  }
  void run() override { found_ = mapping::find_foothold(window_, query_); }
  bool did_the_work() override {
    return found_.ok() && found_.value().distance_m > 0.99 * query_.max_radius_m;
  }

 private:
  mapping::MapWindow window_;
  mapping::FootholdQuery query_;
  Result<mapping::Foothold> found_ = Status::kNotFound;
};

// Locomotion with four legs in the air whose footholds are all lost at once: each is searched again
// through the whole disc, found in the last rings, and the way there is measured against the map.
class Retarget final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({"control.gaits.trot.offset=[0.0, 0.0, 0.0, 0.0]",
                                      "control.foothold.search_radius_m=0.30"});
    place(config);
    fill(window_, config.autonomy.mapping.cell_size_m, mapping::Traversability::kSteppable);
    locomotion_.reset(config.autonomy.control, config.robot);
    locomotion_.start(state_);
    for (int i = 0; i < 1000 && !all_swing(); ++i) update();
    for (estimation::FootState& foot : state_.feet) foot.in_contact = false;
    for (int i = 0; i < 10; ++i) update();
    leave_rings();
    return true;
  }
  void run() override { update(); }
  bool did_the_work() override {
    const auto& legs = locomotion_.legs();
    return std::all_of(legs.begin(), legs.end(), [](const control::LegStatus& leg) {
      const Vector3 moved = leg.foothold.position_O_m - leg.foothold.nominal_O_m;
      return leg.mode == control::LegMode::kSwing && moved.head<2>().norm() > 0.27;
    });
  }

 private:
  void place(const apps::Config& config) {
    state_.p_OB_m = Vector3(0, 0, config.autonomy.control.body.height_m);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      Vector3 p_B = robot::hip_joint_B_m(config.robot, leg);
      p_B[2] = config.robot.foot_radius_m - state_.p_OB_m[2];
      const Vector3 q = robot::solve_leg(config.robot, leg, p_B).q_rad;
      estimation::FootState& foot = state_.feet[leg];
      foot.p_B_m = p_B;
      foot.p_O_m = state_.p_OB_m + p_B;
      foot.jacobian_B = robot::foot_jacobian_B(config.robot, leg, q);
      foot.in_contact = true;
    }
  }
  void update() {
    const control::WalkCommand command{{0.5, 0.0, 0.0}, control::GaitKind::kPronk};
    locomotion_.update(state_, &window_, command, control::ForcePlan{}, kStep_s);
  }
  bool all_swing() const {
    const auto& legs = locomotion_.legs();
    return std::all_of(legs.begin(), legs.end(), [](const control::LegStatus& leg) {
      return leg.mode == control::LegMode::kSwing;
    });
  }
  // Steppable stays what is at least 0.28 m from every leg's nominal foothold.
  void leave_rings() {
    for (std::size_t i = 0; i < window_.cells.size(); ++i) {
      const auto column = static_cast<std::int32_t>(i % mapping::kWindowSide);
      const auto row = static_cast<std::int32_t>(i / mapping::kWindowSide);
      const Vector2 centre(mapping::cell_centre(window_.first.ix + column, window_.cell_size_m),
                           mapping::cell_centre(window_.first.iy + row, window_.cell_size_m));
      mapping::WindowCell& cell = window_.cells[i];
      cell.margin_cells = 1;
      for (const control::LegStatus& leg : locomotion_.legs()) {
        const Vector2 nominal = leg.foothold.nominal_O_m.head<2>();
        if ((centre - nominal).norm() > 0.28) continue;
        cell.traversability = mapping::Traversability::kUnsteppable;
      }
    }
  }

  estimation::RobotState state_;
  mapping::MapWindow window_;
  control::Locomotion locomotion_;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kModuleCases[] = {
    {"estimator_standing", "state estimate, 16 IMU samples, four standing feet",
     make<Estimate<false>>},
    {"estimator_slipping", "the same, four slipping feet", make<Estimate<true>>},
    {"foothold_search", "one foothold, 1257 cells, found in the last ring", make<FootholdSearch>},
    {"locomotion_retarget", "four legs in the air lose their footholds and find far ones",
     make<Retarget>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
