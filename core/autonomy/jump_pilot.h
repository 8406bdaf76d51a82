// Brings a walking robot over what it cannot walk over: finds the edge ahead in the published map,
// picks the motion whose range covers it, walks up to the motion's start square to the edge,
// stands, crouches, checks the start set and jumps, or refuses and says why.
//
// Beside a mission that walks: while steers() the pilot's command and gait replace the mission's,
// while jumps() its joint commands replace locomotion's; when ended() is true locomotion starts
// anew from where the robot stands. Nothing else of the mission changes.
//
// Cost per tick: with a new map one find_ledge; while a motion plays one JumpController::update.
// Memory: the motions are the configuration's and must outlive the pilot.
#pragma once

#include <cstdint>

#include "core/autonomy/jump_pilot_config.h"
#include "core/autonomy/ledge.h"
#include "core/control/config.h"
#include "core/control/foothold.h"
#include "core/control/gait.h"
#include "core/estimation/estimator.h"
#include "core/mapping/map_window.h"
#include "core/motions/jump.h"
#include "core/motions/motion.h"

namespace surefoot::autonomy {

enum class PilotStage : std::uint8_t {
  kWatch = 0,  // the mission walks
  kApproach,   // to the motion's start
  kSquare,     // steps in place
  kStop,       // until all feet stand
  kJump,       // the motion's controller acts
  kGivenUp,    // stands before the edge
};
inline constexpr const char* kPilotStageNames[] = {"watch", "approach", "square",
                                                   "stop",  "jump",     "given_up"};

struct JumpCounters {
  std::uint32_t attempts = 0;  // crouches
  std::uint32_t jumps = 0;     // motions played
  std::uint32_t refusals = 0;
  motions::JumpRefusal last_refusal = motions::JumpRefusal::kNone;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("attempts", self.attempts);
    visit("jumps", self.jumps);
    visit("refusals", self.refusals);
    visit("last_refusal", self.last_refusal);
  }
};

class JumpPilot {
 public:
  // motions: of the configuration; empty: the pilot only says that there is none.
  void reset(const JumpPilotConfig& config, const motions::JumpConfig& jump,
             const robot::RobotModel& model, double standing_height_m,
             const motions::MotionLibrary& motions);

  // Forgets edge and jump under way: the robot fell, or does not walk.
  void abandon();

  // Every tick while the mission walks. ground_z_m: under the feet. window: nullptr: no map.
  void update(const estimation::RobotState& state, const mapping::MapWindow* window,
              double ground_z_m, bool all_in_stance, double step_s);

  bool steers() const { return stage_ != PilotStage::kWatch; }
  const control::VelocityCommand& command() const { return command_; }
  control::GaitKind gait(control::GaitKind walking) const;
  bool jumps() const { return stage_ == PilotStage::kJump; }
  // This tick the controller gave the legs back.
  bool ended() const { return ended_; }
  bool given_up() const { return stage_ == PilotStage::kGivenUp; }

  PilotStage stage() const { return stage_; }
  const motions::JumpController& jump() const { return jump_; }
  const actuation::JointCommands& joints() const { return joints_; }
  const JumpCounters& counters() const { return counters_; }
  const Ledge& ledge() const { return ledge_; }
  double distance_m() const { return start_.edge_m; }
  double heading_error_rad() const { return start_.heading_rad; }
  double rise_m() const { return start_.rise_m; }

 private:
  void enter(PilotStage stage);
  void look(const estimation::RobotState& state, const mapping::MapWindow& window,
            double ground_z_m);
  void measure(const estimation::RobotState& state, const mapping::MapWindow& window,
               double ground_z_m);
  const motions::Motion* choose() const;
  void watch();
  void steer();
  bool in_place() const;
  void refuse(motions::JumpRefusal reason);
  void decide(const estimation::RobotState& state);
  void run_jump(const estimation::RobotState& state, double step_s);

  JumpPilotConfig config_;
  const motions::MotionLibrary* motions_ = nullptr;
  motions::JumpController jump_;
  actuation::JointCommands joints_;
  PilotStage stage_ = PilotStage::kWatch;
  double stage_s_ = 0;
  bool ended_ = false;
  bool has_ledge_ = false;
  double unseen_s_ = 0;          // since the ledge was last found
  std::uint64_t looked_at_ = 0;  // frames of the window
  Ledge ledge_;
  double top_z_m_ = 0;
  const motions::Motion* motion_ = nullptr;
  motions::StartState start_;
  std::uint32_t attempts_here_ = 0;
  bool refused_ledge_ = false;  // no motion takes the ledge in sight: counted
  JumpCounters counters_;
  control::VelocityCommand command_;
};

}  // namespace surefoot::autonomy
