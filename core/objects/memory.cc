#include "core/objects/memory.h"

#include <algorithm>

#include "core/math/elementary.h"
#include "core/objects/outline.h"

namespace surefoot::objects {
namespace {

constexpr double kNowhere_m = 1e9;

}  // namespace

double distance_m(const FixedVector<Vector2, kMaxObjectPoints>& points_O_m,
                  const Vector2& robot_O_m) {
  double nearest_m = kNowhere_m;
  for (const Vector2& p : points_O_m) {
    nearest_m = std::min(nearest_m, (p - robot_O_m).cwiseAbs().maxCoeff());
  }
  return nearest_m;
}

void measure(Object& object, Track& track) {
  if (object.points_O_m.empty()) return;
  const Outline outline = outline_of(object.points_O_m);
  track.low_O_m = outline.low_O_m;
  track.high_O_m = outline.high_O_m;
  object.centre_O_m = outline.mean_O_m;
}

void ObjectMemory::reset(const ObjectsConfig& config) {
  config_ = config;
  objects_.clear();
  next_id_ = 1;
  counters_ = MemoryCounters{};
}

void ObjectMemory::clear() { objects_.clear(); }

bool ObjectMemory::is_forgotten(const Object& object, TimeNs now, const Vector2& robot_O_m) {
  const TimeNs age = now - object.last_seen;
  if (object.kind == ObjectClass::kGround) {
    if (age < kGroundKept) return false;
    ++counters_.ground;
    return true;
  }
  const double age_s = age.seconds();
  if (age_s <= config_.recent_s || age_s < std::min(config_.far_age_s, config_.old_age_s)) {
    return false;
  }
  const double away_m = distance_m(object.points_O_m, robot_O_m);
  if (age_s >= config_.far_age_s && away_m >= config_.far_m) {
    ++counters_.far;
    return true;
  }
  if (age_s >= config_.old_age_s && away_m >= config_.old_m) {
    ++counters_.old;
    return true;
  }
  return false;
}

void ObjectMemory::forget(TimeNs now, const Vector2& robot_O_m) {
  std::size_t i = 0;
  while (i < objects_.size()) {
    if (is_forgotten(objects_[i], now, robot_O_m)) {
      remove(i);
    } else {
      ++i;
    }
  }
}

// The last takes its place: cheap, and the order is still the same on every machine.
void ObjectMemory::remove(std::size_t i) {
  const std::size_t last = objects_.size() - 1;
  if (i != last) {
    objects_[i] = objects_[last];
    tracks_[i] = tracks_[last];
  }
  static_cast<void>(objects_.resize(last));
}

bool ObjectMemory::make_room(double new_away_m, TimeNs now, const Vector2& robot_O_m) {
  std::size_t shortest = kMaxObjects;
  std::size_t farthest = kMaxObjects;
  double farthest_m = std::max(new_away_m, config_.near_m);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = objects_[i];
    if (object.kind == ObjectClass::kGround) {
      ++counters_.ground;
      remove(i);
      return true;
    }
    const double away_m = distance_m(object.points_O_m, robot_O_m);
    if (away_m <= config_.near_m) continue;
    if (away_m > farthest_m) {
      farthest = i;
      farthest_m = away_m;
    }
    if ((now - object.last_seen).seconds() <= config_.recent_s) continue;
    if (shortest == kMaxObjects || object.tracked_s < objects_[shortest].tracked_s) shortest = i;
  }
  if (shortest != kMaxObjects) {
    ++counters_.short_lived;
    remove(shortest);
    return true;
  }
  if (farthest == kMaxObjects) return false;
  ++counters_.recent;
  remove(farthest);
  return true;
}

Result<std::size_t> ObjectMemory::add(const FixedVector<Vector2, kMaxObjectPoints>& points,
                                      ObjectClass kind, TimeNs now, const Vector2& robot_O_m) {
  if (objects_.full()) {
    const double away_m = distance_m(points, robot_O_m);
    if (kind == ObjectClass::kGround || !make_room(away_m, now, robot_O_m)) {
      ++counters_.refused;
      return Status::kExhausted;
    }
  }
  static_cast<void>(objects_.resize(objects_.size() + 1));
  const std::size_t i = objects_.size() - 1;
  Object& object = objects_[i];
  object.id = next_id_++;
  object.kind = kind;
  object.first_seen = now;
  object.last_seen = now;
  object.tracked_s = 0;
  object.points_O_m = points;
  tracks_[i] = Track{};
  measure(object, tracks_[i]);
  ++counters_.made;
  return i;
}

void ObjectMemory::remove_cleared() {
  std::size_t i = 0;
  while (i < objects_.size()) {
    if (!objects_[i].points_O_m.empty()) {
      ++i;
      continue;
    }
    ++counters_.cleared;
    remove(i);
  }
}

}  // namespace surefoot::objects
