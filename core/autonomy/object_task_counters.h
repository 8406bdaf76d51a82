// What became of the laser scanner's scans and of the map's windows.
#pragma once

#include <cstdint>

namespace surefoot::autonomy {

struct ObjectTaskCounters {
  std::uint64_t scans = 0;
  std::uint64_t scans_without_pose = 0;  // stamp outside the pose history
  std::uint64_t scans_refused = 0;       // by the object map
  std::uint64_t windows = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("scans", self.scans);
    visit("scans_without_pose", self.scans_without_pose);
    visit("scans_refused", self.scans_refused);
    visit("windows", self.windows);
  }
};

}  // namespace surefoot::autonomy
