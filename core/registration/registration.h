// Aligns a cloud with another: point-to-plane ICP on a fixed pool (paper 001, section II).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/geometry/frames.h"
#include "core/registration/cloud.h"
#include "core/registration/normal_equations.h"
#include "core/registration/observability.h"
#include "core/registration/registration_config.h"

namespace surefoot::registration {

// Where the clouds are known in: S the source's (the sensor or the body at the new frame), T the
// target's (the map, or an earlier frame).
struct Source {};
struct Target {};
using SourcePose = geometry::Pose<Target, Source>;

// What dead reckoning says, and how far it may be off (one sigma, each axis).
struct Prior {
  SourcePose X_TS;
  double sigma_m = 0.05;
  double sigma_rad = 0.05;
};

struct Registration {
  SourcePose X_TS;
  // Of (displacement of S's origin [m], small rotation [rad]), both in T's axes. Directions that
  // the clouds do not tell about have the prior's variance.
  Matrix6 covariance = Matrix6::Zero();
  // Projects a motion of S, displacement and rotation each in units of the prior's sigma, onto what
  // is not observed: there half of the prior's variance or more is left. Zero: all is observed.
  Matrix6 unobserved = Matrix6::Zero();
  std::int32_t observed_directions = 0;  // 6: all; fewer: the prior was kept in the others
  std::int32_t level = kLevels;          // finest used
  bool converged = false;                // it ended before its last step
  std::int32_t iterations = 0;           // of all levels
  std::int32_t pairs = 0;                // in the last step
  double overlap = 0;                    // pairs per source surfel, last step
  double residual_m = 0;                 // robust standard deviation of the last step
};

class Aligner {
 public:
  // kInvalid: see validate(); nothing changed.
  Status configure(const RegistrationConfig& config);
  const RegistrationConfig& config() const { return config_; }
  // Writes every page, so that no later call meets one for the first time.
  void touch();

  // Moves `source` onto `target`, starting at the prior. Both clouds are finished and have the
  // configuration's cell size; they are changed only in what surfels they have computed.
  //   kInvalid      prior not finite, not a rotation, sigma not above 0; or other cell sizes
  //   kUnavailable  a cloud has fewer surfels than min_pairs: empty, too thin or nowhere a surface
  //   kNotFound     too few partners: no overlap, or another place
  //   kOutOfRange   the result is farther from the prior than gate_sigma allows
  // Unless kOk, out.X_TS is the prior's pose and out.covariance the prior's; the other fields say
  // how far it came. With kInvalid `out` is not touched.
  // Cost: at most the steps of each level times max_pairs times (27 cells + 40 products).
  Status align(Cloud& source, Cloud& target, const Prior& prior, Registration& out);

 private:
  // The finest level that the source has points enough for; the widest in use if none.
  int finest_level(Cloud& source);
  std::size_t choose_surfels(Cloud& source, int level);
  void find_pairs(Cloud& source, Cloud& target, int level);
  void weigh();
  // Adds what wider levels found in the directions that this one does not observe.
  void keep_wider(const Prior& prior, const Matrix6& to_centre, Observed& observed) const;
  void report_open_directions(const Prior& prior, Registration& out) const;
  // Moves X_TS_. False: the equations have no solution.
  bool solve(const Prior& prior, Registration& out);
  bool step(Cloud& source, Cloud& target, int level, const Prior& prior, Registration& out);
  bool within_gate(const Prior& prior) const;
  Status run_level(Cloud& source, Cloud& target, int level, const Prior& prior, Registration& out);

  RegistrationConfig config_;
  double min_normal_cosine_ = 0.7;
  SourcePose X_TS_;
  Matrix6 wider_covariance_ = Matrix6::Zero();  // of the level before; first, the prior's
  SourcePose wider_X_TS_;
  std::size_t chosen_count_ = 0;
  std::size_t pair_count_ = 0;
  double overlap_factor_ = 1;
  double residual_m_ = 0;
  double moved_m_ = 0;
  std::array<std::uint16_t, kMaxPairs> chosen_{};  // source cells with a surfel
  std::array<Pair, kMaxPairs> pairs_{};
  std::array<double, kMaxPairs> weights_{};
  std::array<double, kMaxPairs> sorted_{};
};

}  // namespace surefoot::registration
