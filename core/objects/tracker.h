// Objects from scan to scan: identity, velocity, shape.
//
// Distance between a piece and an object (gate_m): of small things (up to 1.2 m, not cut) between
// the piece's and the object's predicted position; of others the mean distance of the points of the
// one to the nearest points of the other, the smaller way round. So a wall that comes into sight
// bit by bit stays the same object.
//
// Position. What is seen of a trunk or a person is its face, and that goes round it as the robot
// walks by. Of a circle of radius r the mean of the face's points lies 0.785 r (pi / 4) before the
// centre, so this is added along the line of sight, with r half the width seen (at most 0.25 m).
// Across the line of sight it is the middle of what is seen. Where an edge of the piece is not its
// own (something nearer hides it, the sweep ends), the measurement counts with four times the noise
// for what stands and ten times for what moves (its visible part stays behind), and the first that
// shows both edges starts the filter anew.
//
// Velocity. A constant-velocity Kalman filter, one covariance for both axes. An object is moving
// when the filter's speed is over moving_on_m_s and over three of its standard deviations and the
// object has left its place of up to 1 s ago by 0.15 m (0.4 m while half hidden), the space between
// two beams there and 0.01 rad. It stands again when the speed was under
// moving_off_m_s for 0.5 s, or it was not seen for 1 s. Long things do not move.
#pragma once

#include "core/objects/matching.h"
#include "core/objects/memory.h"
#include "core/objects/segmentation.h"

namespace surefoot::objects {

struct TrackerCounters {
  std::uint64_t matched = 0;
  std::uint64_t split = 0;            // pieces made by splitting
  std::uint64_t candidates_full = 0;  // pairs within the gate that were not looked at
  std::uint64_t points_full = 0;      // of an object; not kept

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("matched", self.matched);
    visit("split", self.split);
    visit("candidates_full", self.candidates_full);
    visit("points_full", self.points_full);
  }
};

// Where and when the pieces were seen from.
struct View {
  TimeNs stamp;
  Vector2 robot_O_m = Vector2::Zero();
  Vector2 scanner_O_m = Vector2::Zero();
  double beam_step_rad = 0;
  bool by_scan = true;  // else the height map: no velocities
};

class Tracker {
 public:
  void reset(const ObjectsConfig& config);

  // Matches the pieces to objects of the kind in the memory, updates these and adds what is new.
  // Splits pieces in place. At most pieces x objects boxes, kMaxCandidates x 16 x 64 distances.
  void update(Pieces& pieces, ObjectClass kind, const View& view, ObjectMemory& memory);

  // Velocities of what is out of sight end. After the updates of a scan.
  void settle(TimeNs now, ObjectMemory& memory) const;

  const TrackerCounters& counters() const { return counters_; }

 private:
  void find_candidates(const Pieces& pieces, ObjectClass kind, const View& view,
                       const ObjectMemory& memory);
  void refresh(const Piece& piece, const View& view, Object& object, Track& track);
  void refresh_points(const Piece& piece, Object& object, Track& track);
  void start(const Piece& piece, const View& view, Track& track) const;
  void filter(const Piece& piece, const View& view, Object& object, Track& track) const;

  ObjectsConfig config_;
  Candidates candidates_;
  Assignment object_of_piece_{};
  TrackerCounters counters_;
};

}  // namespace surefoot::objects
