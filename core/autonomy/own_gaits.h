// A body with gaits of its own, behind hal::GaitPort: it stands in for drives, legs, stand-up and
// locomotion. Off: nothing is asked of it.
#pragma once

#include "core/control/foothold.h"
#include "core/control/gait.h"
#include "hal/api/gait_port.h"

namespace surefoot::autonomy {

class OwnGaits {
 public:
  // silence_s: for how long samples may fail to come.
  void reset(bool enabled, double silence_s);

  // Once per tick. newest: the sample taken last; null: none yet. fresh: it came in this tick.
  void update(const hal::GaitSample* newest, bool fresh, double step_s);

  bool enabled() const { return enabled_; }
  bool standing() const { return enabled_ && sample_.standing && !silent(); }
  bool fallen() const { return enabled_ && sample_.fallen; }
  bool silent() const { return enabled_ && silent_s_ > silence_s_; }
  // Hardly moves over the ground.
  bool at_rest() const;
  // B's origin over the ground below the feet that stand, along gravity.
  double height_m() const { return sample_.height_m; }

  hal::GaitCommand command(control::GaitKind gait, const control::VelocityCommand& velocity) const;

 private:
  bool enabled_ = false;
  double silence_s_ = 0;
  double silent_s_ = 0;
  hal::GaitSample sample_;
};

}  // namespace surefoot::autonomy
