#include "core/mapping/self_filter.h"

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

bool finite(const Vector3& v) {
  return math::is_finite(v.x()) && math::is_finite(v.y()) && math::is_finite(v.z());
}

using Axes = std::array<DoubleLanes, 3>;

DoubleLanes dot(const Axes& a, const Axes& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

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
    const double radius = capsule.radius_m + inflation_m;
    const Vector3 around = Vector3::Constant(radius);
    const Box box{capsule.a_O_m.cwiseMin(capsule.b_O_m) - around,
                  capsule.a_O_m.cwiseMax(capsule.b_O_m) + around};
    all_ = {all_.low.cwiseMin(box.low), all_.high.cwiseMax(box.high)};
    links_[i / kDoubleLanes].set(static_cast<int>(i % kDoubleLanes), capsule, box, radius);
  }
  pairs_ = (self.capsules.size() + kDoubleLanes - 1) / kDoubleLanes;
}

void SelfFilter::LinkPair::set(int lane, const SelfCapsule& capsule, const Box& box,
                               double radius_m) {
  const Vector3 along = capsule.b_O_m - capsule.a_O_m;
  const double length2 = along.dot(along);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    low[k][lane] = box.low[axis];
    high[k][lane] = box.high[axis];
    a[k][lane] = capsule.a_O_m[axis];
    ab[k][lane] = along[axis];
  }
  inverse_length2[lane] = length2 > 0 ? 1.0 / length2 : 0.0;
  radius2[lane] = radius_m * radius_m;
}

bool SelfFilter::LinkPair::covers(const Vector3& p) const {
  const DoubleMask boxed = (low[0] <= p.x()) & (high[0] >= p.x()) & (low[1] <= p.y()) &
                           (high[1] >= p.y()) & (low[2] <= p.z()) & (high[2] >= p.z());
  if (!any(boxed)) return false;
  const Axes ap{p.x() - a[0], p.y() - a[1], p.z() - a[2]};
  const DoubleLanes share = dot(ap, ab) * inverse_length2;
  const DoubleLanes along = larger(smaller(share, all_lanes(1.0)), all_lanes(0.0));
  const Axes off{ap[0] - along * ab[0], ap[1] - along * ab[1], ap[2] - along * ab[2]};
  return any(boxed & (dot(off, off) <= radius2));
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
  for (std::size_t i = 0; i < pairs_; ++i) {
    if (links_[i].covers(p_O_m)) return true;
  }
  return false;
}

}  // namespace surefoot::mapping
