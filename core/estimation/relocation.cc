#include "core/estimation/relocation.h"

namespace surefoot::estimation {
namespace {

constexpr TimeNs kLongestGap = milliseconds(200);

}  // namespace

void Relocation::reset() {
  pairs_.clear();
  pinned_ = false;
  now_ = CameraPose{};
}

// An outage ends what was pinned before it.
void Relocation::follow(const CameraPose& camera) {
  if (camera.stamp - now_.stamp > kLongestGap) pinned_ = false;
  now_ = camera;
}

void Relocation::observe(const CameraPose& camera) {
  follow(camera);
  pairs_.clear();
}

void Relocation::observe(const CameraPose& camera, const PoseAtStamp& own) {
  if (camera.stamp - now_.stamp > kLongestGap) pairs_.clear();
  follow(camera);
  pairs_.push_overwrite({camera, own});
}

void Relocation::pin(TimeNs stamp) {
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (pairs_[i].camera.stamp > stamp) break;
    then_ = pairs_[i];
    pinned_ = true;
  }
}

Result<PoseAtStamp> Relocation::pose(TimeNs now) const {
  if (!pinned_ || now - now_.stamp > kLongestGap) return Status::kUnavailable;
  const Matrix3 R_OS = geometry::to_matrix(then_.own.q_OB) * then_.camera.R_SB.transpose();
  PoseAtStamp pose;
  pose.p_OB_m = then_.own.p_OB_m + R_OS * (now_.p_SB_m - then_.camera.p_SB_m);
  pose.q_OB = geometry::to_quaternion(R_OS * now_.R_SB);
  return pose;
}

}  // namespace surefoot::estimation
