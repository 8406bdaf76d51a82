// Workload of core/registration: two scans of a board of blocks and waves.
#include <memory>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/registration/registration.h"
#include "tests/rules/core_hash/workloads.h"

namespace surefoot::tests {
namespace {

using registration::Cloud;

double height_m(double x_m, double y_m) {
  const bool block =
      static_cast<int>(5 * x_m + 100) % 3 == 0 && static_cast<int>(4 * y_m + 100) % 2 == 0;
  return (block ? 0.05 : 0.0) + 0.1 * x_m * y_m - 0.2 * y_m * y_m * y_m;
}

void scan(double begin_m, const registration::SourcePose& pose, Random& random, Cloud& out) {
  const Matrix3 back = pose.rotation.matrix.transpose();
  for (int i = 0; i < 6000; ++i) {
    const double x_m = begin_m + random.uniform(0.0, 1.2);
    const double y_m = random.uniform(-0.6, 0.6);
    const double z_m = height_m(x_m, y_m) + 0.003 * random.normal();
    (void)out.add(back * (Vector3(x_m, y_m, z_m) - pose.origin.m));
  }
  (void)out.finish();
}

}  // namespace

void hash_registration(Fnv64& hash) {
  const auto target = std::make_unique<Cloud>();
  const auto source = std::make_unique<Cloud>();
  const auto aligner = std::make_unique<registration::Aligner>();
  registration::RegistrationConfig config;
  hash.byte(static_cast<std::uint8_t>(aligner->configure(config)));
  Random random(17);
  for (int i = 0; i < 3; ++i) {
    registration::SourcePose pose;
    pose.rotation.matrix = geometry::from_roll_pitch_yaw(0.01 * i, 0.01, -0.02);
    pose.origin.m = Vector3(0.01, 0.02 - 0.01 * i, -0.005);
    (void)target->reset(config.cell_m);
    (void)source->reset(config.cell_m);
    scan(-0.6, {}, random, *target);
    scan(-0.3, pose, random, *source);
    registration::Registration result;
    hash.byte(
        static_cast<std::uint8_t>(aligner->align(*source, *target, {{}, 0.05, 0.05}, result)));
    hash.word(static_cast<std::uint64_t>(result.iterations), 4);
    hash.word(static_cast<std::uint64_t>(result.pairs), 4);
    hash.word(static_cast<std::uint64_t>(result.observed_directions), 4);
    mix(hash, result.X_TS.origin.m);
    mix(hash, result.X_TS.rotation.matrix);
    mix(hash, result.covariance);
    mix(hash, result.residual_m);
  }
}

}  // namespace surefoot::tests
