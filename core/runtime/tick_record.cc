#include "core/runtime/tick_record.h"

namespace surefoot::runtime {
namespace {

// FieldWriter without the bounds check per byte; the caller has checked the size of the whole.
class UncheckedWriter : public FieldVisitor<UncheckedWriter> {
 public:
  explicit UncheckedWriter(std::uint8_t* out) : out_(out), begin_(out) {}

  template <class T>
  void scalar(const char*, const T& value) {
    const std::uint64_t bits = scalar_bits(value);
    for (std::size_t i = 0; i < sizeof(T); ++i)
      out_[i] = static_cast<std::uint8_t>(bits >> (8 * i));
    out_ += sizeof(T);
  }
  std::size_t size() const { return static_cast<std::size_t>(out_ - begin_); }

 private:
  std::uint8_t* out_;
  std::uint8_t* begin_;
};

// All fields before the pixels or ranges take less than this.
constexpr std::size_t kHeaderBound = 64;

template <class Frame>
Status encode(const Frame& frame, std::size_t data_size, std::span<std::uint8_t> out,
              std::size_t& size) {
  if (out.size() < kHeaderBound + data_size) return Status::kExhausted;
  UncheckedWriter writer(out.data());
  writer.members(frame);
  size = writer.size();
  return Status::kOk;
}

template <class Frame>
Status decode(std::span<const std::uint8_t> bytes, Frame& out) {
  FieldReader reader(bytes);
  reader.members(out);
  if (!ok(reader.status())) return reader.status();
  return reader.position() == bytes.size() ? Status::kOk : Status::kCorrupt;
}

}  // namespace

Status decode_tick(std::span<const std::uint8_t> bytes, TickRecord& out) {
  FieldReader reader(bytes);
  reader.members(out);
  out.inputs.depth = nullptr;
  out.inputs.stereo = nullptr;
  out.inputs.lidar = nullptr;
  if (!ok(reader.status())) return reader.status();
  return reader.position() == bytes.size() ? Status::kOk : Status::kCorrupt;
}

Status encode_depth(const hal::DepthFrame& frame, std::span<std::uint8_t> out, std::size_t& size) {
  if (frame.pixel_count() > frame.depth.size()) return Status::kInvalid;
  return encode(frame, 2 * frame.pixel_count(), out, size);
}

Status decode_depth(std::span<const std::uint8_t> bytes, hal::DepthFrame& out) {
  const Status decoded = decode(bytes, out);
  return out.pixel_count() > out.depth.size() ? Status::kCorrupt : decoded;
}

Status encode_stereo(const hal::StereoFrame& frame, std::span<std::uint8_t> out,
                     std::size_t& size) {
  if (frame.pixel_count() > frame.left.size()) return Status::kInvalid;
  return encode(frame, 2 * frame.pixel_count(), out, size);
}

Status decode_stereo(std::span<const std::uint8_t> bytes, hal::StereoFrame& out) {
  const Status decoded = decode(bytes, out);
  return out.pixel_count() > out.left.size() ? Status::kCorrupt : decoded;
}

Status encode_lidar(const hal::LidarScan& scan, std::span<std::uint8_t> out, std::size_t& size) {
  if (scan.beam_count > scan.range_m.size()) return Status::kInvalid;
  return encode(scan, sizeof(float) * scan.beam_count, out, size);
}

Status decode_lidar(std::span<const std::uint8_t> bytes, hal::LidarScan& out) {
  const Status decoded = decode(bytes, out);
  return out.beam_count > out.range_m.size() ? Status::kCorrupt : decoded;
}

}  // namespace surefoot::runtime
