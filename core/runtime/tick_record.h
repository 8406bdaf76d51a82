// The bytes of one tick in a record and in the hash chain: canonical TickInputs, canonical
// TickOutputs, then the chain's value (core/base/fields.h defines the canonical form).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/autonomy/tick.h"
#include "core/base/hash.h"
#include "core/base/status.h"

namespace surefoot::runtime {

// A tick with every list full needs 14.3 kB, a full depth frame 600 kB and a header, a full pair
// 1.5 MB.
inline constexpr std::size_t kMaxTickBytes = 16 * 1024;
inline constexpr std::size_t kMaxDepthBytes =
    2 * hal::kMaxDepthWidth_px * hal::kMaxDepthHeight_px + 64;
inline constexpr std::size_t kMaxStereoBytes =
    2 * hal::kMaxStereoWidth_px * hal::kMaxStereoHeight_px + 64;
inline constexpr std::size_t kMaxLidarBytes = 4 * hal::kMaxLidarBeams + 64;

struct TickRecord {
  autonomy::TickInputs inputs;
  autonomy::TickOutputs outputs;
  std::uint64_t hash = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("inputs", self.inputs);
    visit("outputs", self.outputs);
    visit("hash", self.hash);
  }
};

// Decodes one kTick message; inputs.depth, .stereo and .lidar are left null. kCorrupt: too short,
// too long, or a list beyond its capacity; `out` is then partly overwritten.
Status decode_tick(std::span<const std::uint8_t> bytes, TickRecord& out);

// Canonical bytes of a frame into `out`; `size` is how many. kInvalid: the size in the header is
// beyond the capacity. kExhausted: out is too small. Fast path of FieldWriter for the pixels: one
// pass, about 0.2 ms for a full frame.
Status encode_depth(const hal::DepthFrame& frame, std::span<std::uint8_t> out, std::size_t& size);

// Decodes one kDepth message. kCorrupt: lengths do not agree; `out` is then partly overwritten.
Status decode_depth(std::span<const std::uint8_t> bytes, hal::DepthFrame& out);

// The same for stereo pairs, on channel kStereo.
Status encode_stereo(const hal::StereoFrame& frame, std::span<std::uint8_t> out, std::size_t& size);
Status decode_stereo(std::span<const std::uint8_t> bytes, hal::StereoFrame& out);

// The same for laser scans, on channel kLidar.
Status encode_lidar(const hal::LidarScan& scan, std::span<std::uint8_t> out, std::size_t& size);
Status decode_lidar(std::span<const std::uint8_t> bytes, hal::LidarScan& out);

}  // namespace surefoot::runtime
