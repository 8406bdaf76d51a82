// Starts that are off by a known amount, and how far a result is from the truth.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/registration/registration.h"

namespace surefoot::tests {

using registration::SourcePose;

inline constexpr double kRadPerDeg = math::kPi / 180.0;

inline Vector3 random_direction(Random& random) {
  Vector3 v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = random.normal();
  return v / math::sqrt(v.squaredNorm());
}

// Off by exactly these amounts, in random directions.
inline SourcePose random_motion(Random& random, double distance_m, double angle_rad) {
  SourcePose pose;
  pose.origin.m = distance_m * random_direction(random);
  const Vector3 turn_rad = angle_rad * random_direction(random);
  pose.rotation.matrix = geometry::to_matrix(geometry::from_rotation_vector(turn_rad));
  return pose;
}

// Turns about the source's own origin, as an odometry error does.
inline SourcePose displaced(const SourcePose& pose, const SourcePose& motion) {
  return {{motion.rotation.matrix * pose.rotation.matrix}, {pose.origin.m + motion.origin.m}};
}

inline double distance_m(const SourcePose& a, const SourcePose& b) {
  return math::sqrt((a.origin.m - b.origin.m).squaredNorm());
}
inline double angle_rad(const SourcePose& a, const SourcePose& b) {
  const Matrix3 difference = a.rotation.matrix * b.rotation.matrix.transpose();
  return math::sqrt(geometry::to_rotation_vector(difference).squaredNorm());
}

// The two clouds and the aligner: too large for a stack.
struct Workbench {
  std::unique_ptr<registration::Cloud> source = std::make_unique<registration::Cloud>();
  std::unique_ptr<registration::Cloud> target = std::make_unique<registration::Cloud>();
  std::unique_ptr<registration::Aligner> aligner = std::make_unique<registration::Aligner>();
  registration::Registration result;
  std::size_t refused = 0;  // points that a cloud did not take

  // Empties both clouds. False: the configuration is refused.
  bool configure(const registration::RegistrationConfig& config) {
    refused = 0;
    return ok(aligner->configure(config)) && ok(source->reset(config.cell_m)) &&
           ok(target->reset(config.cell_m));
  }
  void fill(registration::Cloud& cloud, const std::vector<Vector3>& points) {
    for (const Vector3& p : points) refused += ok(cloud.add(p)) ? 0u : 1u;
    refused += ok(cloud.finish()) ? 0u : 1u;
  }
  Status align(const registration::Prior& prior) {
    return aligner->align(*source, *target, prior, result);
  }
};

// Points of the frame that `pose` places: p_source = pose^-1 p_target.
inline std::vector<Vector3> seen_from(const SourcePose& pose, const std::vector<Vector3>& points) {
  const SourcePose inverse = {{pose.rotation.matrix.transpose()},
                              {pose.rotation.matrix.transpose() * -pose.origin.m}};
  std::vector<Vector3> out;
  out.reserve(points.size());
  for (const Vector3& p : points) out.push_back(inverse.rotation.matrix * p + inverse.origin.m);
  return out;
}

}  // namespace surefoot::tests
