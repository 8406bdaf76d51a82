// What became of the pictures that were registered with each other.
#pragma once

#include <cstdint>

namespace surefoot::autonomy {

// Every picture ends in one of these.
struct LocalisationCounters {
  std::uint64_t registered = 0;
  std::uint64_t first = 0;         // there was no scan yet
  std::uint64_t thin = 0;          // too few surfaces in the picture
  std::uint64_t unmatched = 0;     // too little in common with the scans
  std::uint64_t implausible = 0;   // farther off than dead reckoning can be
  std::uint64_t without_pose = 0;  // stamp outside the pose history

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("registered", self.registered);
    visit("first", self.first);
    visit("thin", self.thin);
    visit("unmatched", self.unmatched);
    visit("implausible", self.implausible);
    visit("without_pose", self.without_pose);
  }
};

}  // namespace surefoot::autonomy
