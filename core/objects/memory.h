// The bounded list of objects (paper 003, section III-B.1).
//
// Forgotten, besides what was seen through (line_of_sight.h):
//   P(30) and Q(15): unseen for far_age_s or longer and at least far_m away;
//   P(1800) and Q(10): unseen for old_age_s or longer and at least old_m away;
//   while there is no room: the one tracked for the shortest time;
//   but none that was seen in the last recent_s.
// Distance is the paper's: the smallest infinity norm from the robot to a point of the object.
// Where the paper's rules leave no way out, because everything in a full list is recent, the
// farthest gives way, and the new one counts among them; nothing nearer than near_m ever does.
// Ground is not remembered: it goes kGroundKept after it was seen, and first when room is needed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/objects/config.h"
#include "core/objects/object.h"

namespace surefoot::objects {

inline constexpr TimeNs kGroundKept = milliseconds(500);

// What is known of an object besides what planning needs. Same index as the object.
struct Track {
  Vector2 position_O_m = Vector2::Zero();  // filtered: of the thing, not of its visible face
  Vector2 velocity_O_m_s = Vector2::Zero();
  double p_pp = 0;  // covariance of the two, the same for x and y
  double p_pv = 0;
  double p_vv = 0;
  Vector2 anchor_O_m = Vector2::Zero();  // where it was at anchor_stamp
  TimeNs anchor_stamp;
  TimeNs filter_stamp;                // of position and velocity
  TimeNs fast_stamp;                  // last faster than moving_off_m_s
  Vector2 low_O_m = Vector2::Zero();  // box of its points
  Vector2 high_O_m = Vector2::Zero();
  float z_low_m = 0;  // heights its points were seen at
  float z_high_m = 0;
  bool compact = false;
  bool whole = false;                                    // was seen with both its edges
  bool matched = false;                                  // in the last scan or map
  bool by_map_only = false;                              // no scan has shown it
  std::array<std::uint8_t, kMaxObjectPoints> through{};  // of each point: seen through so often

  double extent_m() const { return (high_O_m - low_O_m).norm(); }
};

struct MemoryCounters {
  std::uint64_t made = 0;
  std::uint64_t far = 0;          // forgotten by the first rule
  std::uint64_t old = 0;          // by the second
  std::uint64_t short_lived = 0;  // gave way: tracked for the shortest time
  std::uint64_t recent = 0;       // gave way though seen in the last recent_s: was the farthest
  std::uint64_t refused = 0;      // the new one was the farthest
  std::uint64_t ground = 0;       // ground that went out of sight
  std::uint64_t cleared = 0;      // seen through

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("made", self.made);
    visit("far", self.far);
    visit("old", self.old);
    visit("short_lived", self.short_lived);
    visit("recent", self.recent);
    visit("refused", self.refused);
    visit("ground", self.ground);
    visit("cleared", self.cleared);
  }
};

// Smallest infinity norm from a place to a point of an object; 1e9 without points.
double distance_m(const FixedVector<Vector2, kMaxObjectPoints>& points_O_m,
                  const Vector2& robot_O_m);

class ObjectMemory {
 public:
  void reset(const ObjectsConfig& config);

  // The age rules. 512 objects; the distance of those older than far_age_s only.
  void forget(TimeNs now, const Vector2& robot_O_m);

  // A new object with its id, its points set to `points`. kExhausted: refused.
  // The index is valid until the next add, forget or remove_cleared. One pass when full.
  Result<std::size_t> add(const FixedVector<Vector2, kMaxObjectPoints>& points, ObjectClass kind,
                          TimeNs now, const Vector2& robot_O_m);

  // Drops objects without points; line of sight took them.
  void remove_cleared();
  void clear();

  Objects& objects() { return objects_; }
  const Objects& objects() const { return objects_; }
  Track& track(std::size_t i) { return tracks_[i]; }
  const Track& track(std::size_t i) const { return tracks_[i]; }
  const MemoryCounters& counters() const { return counters_; }

 private:
  bool make_room(double new_away_m, TimeNs now, const Vector2& robot_O_m);
  bool is_forgotten(const Object& object, TimeNs now, const Vector2& robot_O_m);
  void remove(std::size_t i);

  ObjectsConfig config_;
  Objects objects_;
  std::array<Track, kMaxObjects> tracks_{};
  std::uint32_t next_id_ = 1;
  MemoryCounters counters_;
};

// Centre and box from the points.
void measure(Object& object, Track& track);

}  // namespace surefoot::objects
