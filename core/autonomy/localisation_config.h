// What can be tuned about the registration of pictures with each other.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"
#include "core/registration/registration_config.h"

namespace surefoot::autonomy {

inline constexpr std::size_t kMaxScans = 24;

// Defaults are none on purpose (core/base/parameters.h); recommended values: docs/robots.md.
struct LocalisationConfig {
  bool present = false;
  registration::RegistrationConfig registration;
  double drift_m = 0;          // of dead reckoning from one picture to the next, one sigma
  double drift_rad = 0;        // likewise, each axis
  double max_sigma_m = 0;      // points with more noise along their ray are left out
  double scan_distance_m = 0;  // the trunk's way between scans that are kept
  std::uint8_t scans = 0;      // that are kept: what a picture is registered with

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("registration", self.registration);
    visit.real("drift_m", self.drift_m, {1e-5, 1.0}, "of dead reckoning between pictures, 1 sigma");
    visit.real("drift_rad", self.drift_rad, {1e-6, 1.0}, "the same of the attitude, each axis");
    visit.real("max_sigma_m", self.max_sigma_m, {1e-4, 1.0}, "of a point along its ray");
    visit.real("scan_distance_m", self.scan_distance_m, {0.0, 10.0},
               "way between scans that are kept");
    visit.integer("scans", self.scans, {1, kMaxScans}, "kept to register with");
  }
};

}  // namespace surefoot::autonomy
