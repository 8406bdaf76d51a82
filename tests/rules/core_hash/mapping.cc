// Workload of core/mapping: a camera flies over steps and looks down at them.
#include <memory>

#include "core/base/fields.h"
#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/mapping/map_window.h"
#include "core/mapping/mapper.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/mapping_setup.h"

namespace surefoot::tests {
namespace {

constexpr std::uint16_t kWidth_px = 160;
constexpr std::uint16_t kHeight_px = 90;
constexpr double kFocal_px = 84.0;

// The steps of the scene are too high for a step here, so that more classes are seen.
constexpr double kMaxStep_m = 0.03;
constexpr double kMaxJump_m = 0.05;

mapping::MappingConfig configuration() {
  mapping::MappingConfig config = mapping::test::recommended_config();
  config.max_jump_m = kMaxJump_m;
  return config;
}

mapping::TraversabilityLimits limits() {
  return mapping::test::limits_of(configuration(), kMaxStep_m);
}

mapping::CameraPose camera_pose(int frame) {
  Matrix3 optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  mapping::CameraPose pose;
  pose.rotation.matrix =
      geometry::from_roll_pitch_yaw(0.02 * (frame % 3), 0.7, 0.03 * frame) * optical;
  pose.origin.m = Vector3(0.02 * frame, 0.005 * frame, 0.35);
  return pose;
}

// Level ground with steps across it every 0.3 m; the walls between them are left out.
void render(const mapping::CameraPose& X_OC, Random& random, hal::DepthFrame& out) {
  for (int v = 0; v < kHeight_px; ++v) {
    for (int u = 0; u < kWidth_px; ++u) {
      const Vector3 ray_C((u - 79.5) / kFocal_px, (v - 44.5) / kFocal_px, 1.0);
      const Vector3 ray = X_OC.rotation.matrix * ray_C;
      double z_m = ray.z() < -1e-3 ? X_OC.origin.m.z() / -ray.z() : 0;
      const double ahead_m = X_OC.origin.m.x() + z_m * ray.x();
      if (z_m > 0 && static_cast<int>(ahead_m * 10 + 1000) % 6 < 3) {
        z_m = (X_OC.origin.m.z() - 0.04) / -ray.z();
      }
      z_m += z_m * z_m * 0.004 * random.normal();
      const double units = z_m > 0.2 && z_m < 3.5 ? z_m * 1000 : 0;
      out.depth[static_cast<std::size_t>(v) * kWidth_px + static_cast<std::size_t>(u)] =
          static_cast<std::uint16_t>(units);
    }
  }
}

}  // namespace

void hash_mapping(Fnv64& hash) {
  const auto mapper = std::make_unique<mapping::Mapper>();
  const auto frame = std::make_unique<hal::DepthFrame>();
  const auto window = std::make_unique<mapping::MapWindow>();
  hash.byte(
      static_cast<std::uint8_t>(mapper->configure(configuration(), {0.0006, 0.17, 4.0}, limits())));
  frame->intrinsics = {kWidth_px, kHeight_px, kFocal_px, kFocal_px, 79.5, 44.5};
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    const mapping::CameraPose X_OC = camera_pose(i);
    frame->stamp = milliseconds(33 * (i + 1));
    frame->sequence = static_cast<std::uint32_t>(i);
    render(X_OC, random, *frame);
    mapping::SelfModel self;
    self.X_OB.origin.m = X_OC.origin.m;
    mapping::IntegrationReport report;
    hash.byte(static_cast<std::uint8_t>(mapper->integrate(*frame, X_OC, self, &report)));
    hash.word(report.points, 4);
    hash.word(report.cells_fused, 4);
    hash.byte(static_cast<std::uint8_t>(
        mapper->publish(X_OC.origin.m.x() + 0.4, X_OC.origin.m.y(), *window)));
    FieldHasher hasher(hash);
    for (const mapping::WindowCell& cell : window->cells) hasher.members(cell);
  }
  hash.word(mapper->digest(), 8);
}

}  // namespace surefoot::tests
