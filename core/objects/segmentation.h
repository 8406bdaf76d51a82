// Points to pieces of objects (paper 003, section III-A.2: "merging individual points that are
// separated by less than 0.5 meters").
//
// Single linkage: two points belong together if a chain of points leads from one to the other with
// no gap of merge_m or more. What is longer than piece_m that way (a wall) is cut along a grid of
// squares of piece_m that is fixed in O, so that the pieces are the same from scan to scan and a
// planner's object stays small.
//
// The grid's squares of merge_m / sqrt(2) make neighbours easy: points of one square are always
// linked, others are at most two squares away. Union-find with path halving; no recursion.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/math/linear.h"
#include "core/objects/config.h"
#include "core/objects/object.h"
#include "core/objects/scan_points.h"

namespace surefoot::objects {

inline constexpr std::size_t kMaxPieces = 256;

// What one scan or one height map shows of a thing.
struct Piece {
  Vector2 centre_O_m = Vector2::Zero();  // mean of all its points
  Vector2 low_O_m = Vector2::Zero();     // box around them
  Vector2 high_O_m = Vector2::Zero();
  float z_low_m = 0;
  float z_high_m = 0;
  std::uint16_t first_beam = kNoBeam;
  std::uint16_t last_beam = 0;
  std::uint32_t count = 0;                            // of all its points
  bool cut = false;                                   // part of something longer
  bool partial = false;                               // not all of its width was seen
  FixedVector<Vector2, kMaxObjectPoints> points_O_m;  // thinned
  double extent_m() const { return (high_O_m - low_O_m).norm(); }
};
using Pieces = FixedVector<Piece, kMaxPieces>;

struct SegmentCounters {
  std::uint64_t pieces = 0;
  std::uint64_t lone_points = 0;  // in pieces of fewer than min_points
  std::uint64_t dropped = 0;      // pieces: no room, and the others were nearer
  std::uint64_t points_full = 0;  // points over kMaxObjectPoints in a piece

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("pieces", self.pieces);
    visit("lone_points", self.lone_points);
    visit("dropped", self.dropped);
    visit("points_full", self.points_full);
  }
};

class Segmenter {
 public:
  void reset(const ObjectsConfig& config);

  // Pieces in the order of their first points. More than kMaxPieces: those nearest to the robot.
  // Cost: linear in the points of ordinary scans; at most N^2 / 2 distances where points crowd on
  // both sides of gaps just over merge_m.
  void segment(const SurfacePoints& points, const Vector2& robot_O_m, Pieces& out);

  // Linked component of each point of the last call: the index of one of its points.
  std::uint32_t component(std::size_t point) const { return component_[point]; }
  const SegmentCounters& counters() const { return counters_; }

 private:
  static constexpr std::size_t kSlots = 4096;
  static constexpr std::uint16_t kNone = 0xffff;

  struct Slot {
    std::int32_t ix = 0;
    std::int32_t iy = 0;
    std::uint32_t group = 0;  // component, when pieces are looked up
    std::uint16_t head = kNone;
  };
  struct Group {
    double nearest2 = 0;
    std::uint32_t count = 0;
    bool cut = false;
    std::uint16_t piece = kNone;
  };

  Slot& slot(std::int32_t ix, std::int32_t iy, std::uint32_t group);
  std::uint16_t root(std::uint16_t point);
  void unite(std::uint16_t a, std::uint16_t b);
  void link(const SurfacePoints& points);
  void link_squares(const SurfacePoints& points, std::uint16_t a, std::uint16_t b);
  void group(const SurfacePoints& points, const Vector2& robot_O_m);
  void choose(Pieces& out);
  void fill(const SurfacePoints& points, Pieces& out);

  ObjectsConfig config_;
  std::array<Slot, kSlots> slots_{};
  std::array<std::uint16_t, kMaxSurfacePoints> parent_{};
  std::array<std::uint16_t, kMaxSurfacePoints> next_{};  // in the same square
  std::array<std::uint32_t, kMaxSurfacePoints> component_{};
  std::array<std::uint16_t, kMaxSurfacePoints> group_of_{};
  std::array<Vector2, kMaxSurfacePoints> low_{};  // box of a component, at its root
  std::array<Vector2, kMaxSurfacePoints> high_{};
  FixedVector<Group, kMaxSurfacePoints> groups_;
  std::array<double, kMaxSurfacePoints> order_{};
  SegmentCounters counters_;
};

// Adds a point unless one of the list is within thin_m of it. False: there was no room.
bool add_thinned(const Vector2& p_O_m, double thin_m, FixedVector<Vector2, kMaxObjectPoints>& list);

}  // namespace surefoot::objects
