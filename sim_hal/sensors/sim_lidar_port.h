// Simulated planar laser scanner (class of the SICK LMS291): beams against ground, solids and
// saplings, then the errors of such a device. README.md "Laser scanner" has the model.
//
// A sweep is remembered as where the body was; its beams are cast when receive() fetches the scan,
// so a scanner that nobody listens to costs nothing. Each scan draws from its own random sequence:
// what was fetched before changes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/fixed_vector.h"
#include "core/base/random.h"
#include "core/base/ring_buffer.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/lidar_port.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

struct LidarCounters {
  std::uint64_t beams = 0;  // of fetched scans
  std::uint64_t mixed = 0;  // two surfaces in one beam gave a range between them
  std::uint64_t random_dropouts = 0;
  std::uint64_t sapling_returns = 0;
  std::uint64_t no_returns = 0;  // nothing within the range
  std::uint64_t scans_lost = 0;  // by the fault
};

// What is not where it was, at the time of a sweep.
struct MovingThings {
  FixedVector<Solid, kMaxWalkers> solids;
  std::optional<TerrainBox> obstacle;
};

class SimLidarPort final : public hal::LidarPort {
 public:
  static constexpr std::size_t kQueue = 8;

  SimLidarPort(const robot::LidarSpecification& specification, const LidarNoiseConfig& noise,
               const FaultConfig& faults, const TerrainIndex& terrain, const SolidIndex& solids,
               std::uint64_t seed);

  // Once per physics step, after it.
  void advance(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
               std::span<const Solid> moving, const TerrainBox* obstacle);

  const LidarCounters& lidar_counters() const { return lidar_counters_; }

 private:
  struct Pose {
    Vector3 p_WL_m = Vector3::Zero();
    Eigen::Quaterniond q_WL = Eigen::Quaterniond::Identity();
  };
  struct Sweep {
    TimeNs stamp;
    std::uint32_t sequence = 0;
    Pose first;  // at the first beam
    Pose last;   // at `end`, just after the last beam
    TimeNs end;
    MovingThings moving;  // in the sweep's middle
  };
  struct Beam {  // directions in L: a footprint in three parts
    Vector3 right;
    Vector3 centre;
    Vector3 left;
  };

  Status do_receive(hal::LidarScan& out) override;
  hal::SensorCounters do_counters() const override { return counters_; }

  Pose pose(const Vector3& p_WB_m, const Matrix3& rotation_WB) const;
  void finish(TimeNs now, const Pose& pose);
  void cast(const Sweep& sweep, hal::LidarScan& out);
  double surface(const Sweep& sweep, const Vector3& origin, const Vector3& direction) const;
  double echo(const Sweep& sweep, const Pose& at, const Beam& beam, Random& random);
  double measure(const Sweep& sweep, const Pose& at, const Beam& beam, Random& random);

  robot::LidarSpecification specification_;
  LidarNoiseConfig noise_;
  FaultConfig faults_;
  const TerrainIndex& terrain_;
  const SolidIndex& solids_;
  std::uint64_t seed_;
  Vector3 mount_B_m_;
  Matrix3 rotation_BL_;
  std::vector<Beam> beams_;
  TimeNs beam_interval_;
  TimeNs latency_;
  TimeNs now_;
  std::uint64_t next_ = 1;  // the next sweep begins at next_ / rate
  std::uint32_t sequence_ = 0;
  std::uint32_t expected_ = 0;  // sequence number that follows the last arrival
  bool arrived_ = false;
  bool sweeping_ = false;
  bool seen_moving_ = false;
  Sweep current_;
  RingBuffer<Sweep, kQueue> queue_;
  hal::SensorCounters counters_;
  LidarCounters lidar_counters_;
};

}  // namespace surefoot::sim
