// A body without legs that follows velocities as a trot would: late, not quite, swaying, stumbling
// on rough ground, stopped by what stands in its way. For runs of which only the navigation is of
// interest: README.md "The fast plant" has the model.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/random.h"
#include "core/base/time.h"
#include "core/robot/robot_model.h"
#include "sim_hal/plant.h"
#include "sim_hal/robot/footprint.h"
#include "sim_hal/robot/pushes.h"
#include "sim_hal/robot/sim_gait_port.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/terrain_index.h"
#include "sim_hal/world/walkers.h"

namespace surefoot::sim {

class FastPlant final : public Plant {
 public:
  // Index, solids and walkers must outlive it. Throws SimulatorError.
  FastPlant(const robot::RobotModel& robot, const SimulatorConfig& config,
            const TerrainIndex& index, const SolidIndex& solids, const Walkers& walkers,
            std::uint64_t seed);

  void set_down(std::uint64_t seed) override;
  void step(TimeNs now) override;
  void place_obstacle(const TerrainBox& box) override;
  void place_walkers(const Walkers&) override {}
  void set_force(const Vector3& force_W_N) override { force_W_N_ = force_W_N; }
  bool on_obstacle() const override { return touching_ || over_step_; }

  Vector3 position_m() const override { return p_WB_m_; }
  Matrix3 rotation() const override { return R_WB_; }
  Vector3 angular_velocity_W() const override { return w_WB_rad_s_; }
  Vector3 point_velocity_W(const Vector3& p_B_m) const override {
    return v_WB_m_s_ + w_WB_rad_s_.cross(R_WB_ * p_B_m);
  }
  std::span<const Capsule> leg_shapes() override { return {}; }

  void attach(hal::Board& board) override { board.gait = &port_; }
  void tell(Truth& truth) const override;
  void count(SimulatorCounters&) const override {}
  void hash(Fnv64& digest) const override;

 private:
  // Follows a target like a spring, critically damped: rate and value go on steadily.
  struct Follower {
    double value = 0;
    double rate = 0;

    void follow(double target, double rate_1_s, double step_s) {
      const double pull = rate_1_s * rate_1_s * (target - value) - 2 * rate_1_s * rate;
      rate += pull * step_s;
      value += rate * step_s;
    }
  };
  // What differs from run to run.
  struct Errors {
    double forward = 1;  // velocity that comes of a commanded one
    double left = 1;
    double turn = 1;
    double drift = 0;             // yaw rate per forward velocity [rad/m]
    double odometry_forward = 1;  // what the legs tell of a velocity
    double odometry_left = 1;
    double odometry_across = 0;  // leftward, of the forward one
  };
  struct Ground {
    double height_m = 0;  // mean under the feet
    double along = 0;     // slope, forward and to the left
    double across = 0;
    double twist_m = 0;  // how far the feet are from one plane
  };
  // Added to the followed pose: the gait's rhythm.
  struct Rhythm {
    double left_m = 0;
    double up_m = 0;
    double roll_rad = 0;
    double pitch_rad = 0;
  };

  Ground ground() const;
  double height_m(TimeNs now) const;
  void drive(TimeNs now);
  void blow();
  void stumble(const Ground& ground);
  bool over_step() const;
  Rhythm rhythm(double phase_rad) const;
  void pose(TimeNs now, const Ground& ground);
  Vector2 kept_out(const Vector2& from_m, Vector2 to_m);
  void turn_to(double roll, double pitch, double yaw);
  hal::GaitSample odometry(TimeNs now);

  robot::RobotModel robot_;
  Footprint footprint_;
  double step_s_;
  TimeNs step_;
  const TerrainIndex& index_;
  const SolidIndex& solids_;
  const Walkers& walkers_;
  std::optional<Solid> obstacle_;
  StartConfig start_;
  Pushes pushes_;
  Random random_;
  SimGaitPort port_;
  Errors errors_;
  double folded_m_ = 0;  // height of B over the feet
  double standing_m_ = 0;
  double fastest_m_s_ = 0;

  std::uint64_t steps_ = 0;
  double activity_ = 0;  // 0: stands, 1: trots
  double phase_rad_ = 0;
  Rhythm rhythm_;
  double forward_m_s_ = 0;  // what the gait does, without its disturbances
  double left_m_s_ = 0;
  double yaw_rate_rad_s_ = 0;
  Vector3 wind_ = Vector3::Zero();   // disturbance of the three, as drawn
  Vector3 swing_ = Vector3::Zero();  // and as it acts
  double stumble_ = 0;               // 1: just now
  double stumble_side_ = 1;
  Follower up_;
  Follower roll_;
  Follower pitch_;
  double yaw_rad_ = 0;
  Vector3 force_W_N_ = Vector3::Zero();
  bool touching_ = false;
  bool over_step_ = false;

  Vector3 p_WB_m_ = Vector3::Zero();
  Matrix3 R_WB_ = Matrix3::Identity();
  Vector3 v_WB_m_s_ = Vector3::Zero();
  Vector3 w_WB_rad_s_ = Vector3::Zero();
};

}  // namespace surefoot::sim
