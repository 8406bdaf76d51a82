// The fields: discs that stand for the objects the map has shown, remembered where the window has
// moved on, forgotten where the map shows free ground.
//
// As in paper 002, section IV-A, no field is made near an existing one: the discs of two fields
// never overlap. Every cell of an object lies within two radii of a field's centre as long as the
// pool has room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/math/linear.h"
#include "core/obstacles/config.h"
#include "core/obstacles/objects.h"

namespace surefoot::obstacles {

inline constexpr std::size_t kMaxFields = 64;

struct Field {
  Vector2 centre_O_m = Vector2::Zero();
  std::uint32_t free_windows = 0;  // in a row that showed its place free
};
using Fields = FixedVector<Field, kMaxFields>;

struct FieldCounters {
  std::uint64_t made = 0;
  std::uint64_t forgotten = 0;
  std::uint64_t refused = 0;   // no room, and none farther from the robot to give way
  std::uint64_t replaced = 0;  // gave way to one nearer to the robot

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("made", self.made);
    visit("forgotten", self.forgotten);
    visit("refused", self.refused);
    visit("replaced", self.replaced);
  }
};

class FieldPool {
 public:
  void reset(const ObstacleConfig& config);

  // After each published window. When the pool is full the field farthest from the robot gives way
  // to one that is nearer.
  void update(const mapping::MapWindow& window, const BlockingRule& rule, const Vector2& robot_O_m);

  // All fields whose centres lie in a square: nothing is known there any more.
  void forget_around(const Vector2& centre_O_m, double half_side_m);

  const Fields& fields() const { return fields_; }
  const FieldCounters& counters() const { return counters_; }

 private:
  void forget(const mapping::MapWindow& window);
  void cover(const mapping::MapWindow& window, const Vector2& robot_O_m);
  void make(const Vector2& centre_O_m, const Vector2& robot_O_m);
  bool is_near_field(const Vector2& p_O_m) const;

  ObstacleConfig config_;
  ObjectFinder finder_;
  Fields fields_;
  FieldCounters counters_;
};

}  // namespace surefoot::obstacles
