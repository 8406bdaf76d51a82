// The mission `navigate`: what stands around the robot, the way between it, the velocity along it.
#include "core/autonomy/autonomy.h"

namespace surefoot::autonomy {
namespace {

constexpr double kSlopeMemory_s = 1.0;  // the trunk sways with every step, the ground does not

navigation::RobotPose pose_of(const estimation::RobotState& state) {
  return {state.p_OB_m.head<2>(), state.yaw_rad};
}

}  // namespace

Status Autonomy::reset_navigation() {
  navigates_ = config_.mission.kind == MissionConfig::Kind::kNavigate;
  objects_.reset(config_.navigation.objects, model_.lidar);
  slope_ = Vector2::Zero();
  blind_s_ = 0;
  navigation_command_ = control::VelocityCommand{};
  if (!navigates_) return Status::kOk;
  if (!config_.navigation.present || model_.lidar.rate_Hz <= 0) return Status::kInvalid;
  const Status ready = navigator_.reset(config_.navigation.planner);
  if (!ok(ready)) return ready;
  return navigator_.set_goal(Vector2(config_.mission.goal_x_m, 0.0));
}

// The trunk lies along the ground, in the mean.
void Autonomy::follow_slope(const estimation::RobotState& state) {
  const Vector3 up = state.R_OB.col(2);
  const Vector2 slope(-up[0] / up[2], -up[1] / up[2]);
  slope_ += tick_s_ / kSlopeMemory_s * (slope - slope_);
}

// Without eyes it stands.
void Autonomy::navigate(const estimation::RobotState& state) {
  if (!navigates_) return;
  blind_s_ = inputs_->lidar_fresh ? 0.0 : blind_s_ + tick_s_;
  if (!walking_ready_ || is_tilted(state)) return;
  follow_slope(state);
  if (mission_.phase() != MissionPhase::kWalk) return;
  const navigation::VelocityCommand wanted =
      navigator_.follow(pose_of(state), objects_.objects(), state.stamp);
  const bool blind = blind_s_ > config_.navigation.blind_s;
  navigation_command_ = {blind ? 0.0 : wanted.forward_m_s, blind ? 0.0 : wanted.left_m_s,
                         blind ? 0.0 : wanted.yaw_rate_rad_s};
}

StopReason Autonomy::navigation_fault() const {
  if (!navigates_ || mission_.phase() != MissionPhase::kWalk) return StopReason::kNone;
  switch (navigator_.status().state) {
    case navigation::NavigationState::kNoPath: return StopReason::kNoPath;
    case navigation::NavigationState::kLiveLock: return StopReason::kLiveLock;
    case navigation::NavigationState::kIdle:
    case navigation::NavigationState::kGoing:
    case navigation::NavigationState::kArrived: break;
  }
  return StopReason::kNone;
}

bool Autonomy::begin_objects(const TickInputs& inputs) {
  if (!navigates_ || !walking_ready_) return false;
  ObjectSight sight;
  sight.scan = inputs.lidar_fresh ? inputs.lidar : nullptr;
  sight.window = window();
  sight.window_digest = map_.window_digest();
  sight.ground = {footing_O_m_, slope_};
  sight.robot_O_m = estimator_.state().p_OB_m.head<2>();
  return objects_.release(sight, history_);
}

bool Autonomy::begin_planning(const TickInputs& inputs) {
  if (!navigates_ || !walking_ready_ || !locomotion_acts()) return false;
  return navigator_.release(objects_.objects(), pose_of(estimator_.state()), inputs.stamp);
}

void Autonomy::report_navigation() {
  if (!navigates_) return;
  NavigationTelemetry& telemetry = outputs_.telemetry.navigation;
  const navigation::NavigationStatus& status = navigator_.status();
  telemetry.state = status.state;
  telemetry.reason = status.reason;
  telemetry.rest_m = status.rest_m;
  telemetry.off_path_m = status.off_path_m;
  telemetry.free_m = status.free_m;
  telemetry.plans = status.counters;
  telemetry.sight = objects_.counters();
  telemetry.objects = static_cast<std::uint32_t>(objects_.objects().size());
  telemetry.objects_digest = objects_.digest();
  telemetry.path_points = static_cast<std::uint32_t>(navigator_.path().size());
}

}  // namespace surefoot::autonomy
