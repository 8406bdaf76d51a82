// Which returns are ground and which stand on it (paper 003, section III-A.2: the system must
// "navigate around walls, but not appear to be afraid of the ground").
//
// One scan cannot tell a wall from a slope: both are long rows. What can:
// 1. Height. Ground no steeper than max_slope rises over the feet by at most max_slope x distance,
//    plus roughness_m. What is higher stands on it. With the scanner 0.9 m above the feet and 11
//    degrees that decides within 3.9 m, whatever the body does.
// 2. Attitude. While the body pitches, a wall is hit at many heights at one place; a row on the
//    ground slides away and comes back, and every place has one height. A grid of cells keeps the
//    lowest and highest return of the last evidence_s to 2 evidence_s: more than
//    wall_spread_m + 0.01 x distance apart is no ground.
// 3. The height map, where it reaches: what stands over the lowest ground nearby is no ground. It
//    is never used to call something ground: the map may hold the obstacle itself.
// 4. The plane under the feet: what lies on it (roughness_m + feet_slope_error x distance) is
//    ground, if none of the above spoke.
// 5. Shape, for what remains: a row shorter than row_length_m and nearer than compact_range_m is an
//    obstacle (a trunk, a person), what is longer or farther is ground until 1, 2 or 3 speaks: on
//    rolling ground a quarter of such short rows is bare ground (README.md). A row goes on to the
//    next return if that is within 0.5 m or within 15 % of the range (ground at a grazing angle is
//    seen in patches), with at most two beams between that gave none.
// 6. The row: where 1 and 2 speak for a third of it, the rest but for rule 4 is the same wall.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.h"
#include "core/mapping/map_window.h"
#include "core/objects/config.h"
#include "core/objects/object.h"
#include "core/objects/scan_points.h"

namespace surefoot::objects {

// The plane through the feet, in O.
struct GroundPlane {
  Vector3 feet_O_m = Vector3::Zero();  // on the ground below the trunk
  Vector2 slope = Vector2::Zero();     // dz/dx, dz/dy
};

struct GroundCounters {
  std::uint64_t high = 0;    // obstacle by rule 1
  std::uint64_t spread = 0;  // by rule 2
  std::uint64_t mapped = 0;  // by rule 3
  std::uint64_t ground = 0;  // by rule 4
  std::uint64_t compact = 0;
  std::uint64_t row = 0;        // by rule 6
  std::uint64_t undecided = 0;  // long or far rows taken for ground

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("high", self.high);
    visit("spread", self.spread);
    visit("mapped", self.mapped);
    visit("ground", self.ground);
    visit("compact", self.compact);
    visit("row", self.row);
    visit("undecided", self.undecided);
  }
};

class GroundOrWall {
 public:
  void reset(const ObjectsConfig& config);

  // Parts a scan's points, in the order of their beams; every point goes to one of the two. map may
  // be nullptr. Linear in the points, and 200 map cells for each within 2 m that needs them.
  void part(const SurfacePoints& points, TimeNs stamp, const GroundPlane& ground,
            const mapping::MapWindow* map, SurfacePoints& obstacles, SurfacePoints& grounds);

  const GroundCounters& counters() const { return counters_; }

 private:
  static constexpr std::int32_t kSide = 128;
  static constexpr double kCell_m = 0.25;

  struct Heights {
    float low_m = 0;
    float high_m = 0;
  };
  // Where the torus of cells was last hit, in the current and the previous period.
  struct Cell {
    std::int32_t ix = 0;
    std::int32_t iy = 0;
    std::int32_t period = -2;
    Heights now;
    Heights before;
  };

  Cell& cell_at(const SurfacePoint& point, std::int32_t period);
  void record(const SurfacePoint& point, std::int32_t period);
  enum class Verdict : std::uint8_t { kHigh, kSpread, kMapped, kGround, kUndecided };
  Verdict decide(const SurfacePoint& point, const GroundPlane& ground, std::int32_t period,
                 const mapping::MapWindow* map);
  ObjectClass conclude(Verdict verdict, bool waits, bool wall);
  std::size_t row_end(const SurfacePoints& points, std::size_t begin, bool& long_row) const;

  ObjectsConfig config_;
  std::array<Cell, static_cast<std::size_t>(kSide) * kSide> cells_{};
  std::array<Verdict, kMaxSurfacePoints> verdicts_{};
  GroundCounters counters_;
};

}  // namespace surefoot::objects
