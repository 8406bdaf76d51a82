#include "core/mapping/self_filter.h"

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

bool finite(const Vector3& v) {
  return math::is_finite(v.x()) && math::is_finite(v.y()) && math::is_finite(v.z());
}

double distance2_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length2 = ab.dot(ab);
  const double along = length2 > 0 ? math::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  const Vector3 off = p - a - along * ab;
  return off.dot(off);
}

}  // namespace

Status validate(const SelfModel& self) {
  if (!finite(self.X_OB.origin.m)) return Status::kInvalid;
  for (int i = 0; i < 3; ++i) {
    if (!finite(self.X_OB.rotation.matrix.col(i))) return Status::kInvalid;
  }
  for (const double size : self.trunk_size_m) {
    if (!(size >= 0 && size <= 10)) return Status::kInvalid;
  }
  for (const SelfCapsule& capsule : self.capsules) {
    const bool good = finite(capsule.a_O_m) && finite(capsule.b_O_m) && capsule.radius_m >= 0 &&
                      capsule.radius_m <= 10;
    if (!good) return Status::kInvalid;
  }
  return Status::kOk;
}

SelfFilter::SelfFilter(const SelfModel& self, double inflation_m)
    : self_(self), inflation_m_(inflation_m) {
  // The trunk's ball: its box turned by any attitude fits in.
  double half2 = 0;
  for (const double size : self.trunk_size_m) half2 += math::square(0.5 * size + inflation_m);
  const Vector3 reach = Vector3::Constant(half2 > 0 ? math::sqrt(half2) : 0.0);
  all_ = {self.X_OB.origin.m - reach, self.X_OB.origin.m + reach};
  for (std::size_t i = 0; i < self.capsules.size(); ++i) {
    const SelfCapsule& capsule = self.capsules[i];
    const Vector3 radius = Vector3::Constant(capsule.radius_m + inflation_m);
    boxes_[i] = {capsule.a_O_m.cwiseMin(capsule.b_O_m) - radius,
                 capsule.a_O_m.cwiseMax(capsule.b_O_m) + radius};
    all_ = {all_.low.cwiseMin(boxes_[i].low), all_.high.cwiseMax(boxes_[i].high)};
  }
}

bool SelfFilter::Box::covers(const Vector3& p) const {
  return p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y() &&
         p.z() >= low.z() && p.z() <= high.z();
}

bool SelfFilter::covers(const Vector3& p_O_m) const {
  if (!all_.covers(p_O_m)) return false;
  const Vector3 p_B = self_.X_OB.rotation.matrix.transpose() * (p_O_m - self_.X_OB.origin.m);
  bool in_trunk = true;
  for (int i = 0; i < 3; ++i) {
    const double size = self_.trunk_size_m[static_cast<std::size_t>(i)];
    const double half = 0.5 * size + inflation_m_;
    in_trunk = in_trunk && size > 0 && p_B[i] >= -half && p_B[i] <= half;
  }
  if (in_trunk) return true;
  for (std::size_t i = 0; i < self_.capsules.size(); ++i) {
    if (!boxes_[i].covers(p_O_m)) continue;
    const SelfCapsule& capsule = self_.capsules[i];
    const double radius = capsule.radius_m + inflation_m_;
    if (distance2_to_segment(p_O_m, capsule.a_O_m, capsule.b_O_m) <= radius * radius) return true;
  }
  return false;
}

}  // namespace surefoot::mapping
