// What a run leaves for figures and pictures: samples of what the autonomy showed and of what the
// simulator knows. It grows with the run: ten minutes take half a gigabyte.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/autonomy/tick.h"
#include "core/base/time.h"
#include "sim_hal/simulator.h"

namespace surefoot::apps {

inline constexpr std::uint64_t kTicksPerSample = 4;  // 8 ms

struct RunSample {
  TimeNs stamp;
  autonomy::Telemetry telemetry;
  sim::Truth truth;  // meaningful where RunLog::has_truth()
};

// A foot came down: where it was meant to, where it was sent and why.
struct Touchdown {
  TimeNs stamp;
  std::size_t leg = 0;
  std::array<double, 3> nominal_O_m{};
  std::array<double, 3> chosen_O_m{};
  control::FootholdReason reason = control::FootholdReason::kNominal;
};

class RunLog {
 public:
  RunLog(std::size_t capacity, bool has_truth);

  // Between ticks: may allocate. Full: the sample is dropped and counted.
  void add(TimeNs stamp, const autonomy::Telemetry& telemetry, const sim::Truth* truth);

  bool has_truth() const { return has_truth_; }
  const std::vector<RunSample>& samples() const { return samples_; }
  std::uint64_t dropped() const { return dropped_; }
  // Index of the first sample of phase kWalk; samples().size() when there is none.
  std::size_t walk_begin() const;
  // One past the last sample of phase kWalk.
  std::size_t walk_end() const;
  std::vector<Touchdown> touchdowns() const;

 private:
  bool has_truth_;
  std::size_t capacity_;
  std::uint64_t dropped_ = 0;
  std::vector<RunSample> samples_;
};

// The odometry frame O in the world frame W: a turn about z and a shift, so that estimate and truth
// agree at one moment. Drift is what grows afterwards.
struct Alignment {
  double yaw_rad = 0;
  std::array<double, 3> p_WO_m{};

  std::array<double, 3> to_world(const std::array<double, 3>& p_O_m) const;
  std::array<double, 3> to_odometry(const std::array<double, 3>& p_W_m) const;
};

double yaw_of(const std::array<double, 4>& q_wxyz);
double tilt_of(const std::array<double, 4>& q_wxyz);  // angle between body z and up
Alignment align(const RunSample& sample);
// At the first sample of walking, else at the last sample; identity for an empty log.
Alignment align_at_start(const RunLog& log);

}  // namespace surefoot::apps
