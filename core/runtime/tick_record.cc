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

// All fields before the pixels take less than this.
constexpr std::size_t kHeaderBound = 64;

}  // namespace

Status decode_tick(std::span<const std::uint8_t> bytes, TickRecord& out) {
  FieldReader reader(bytes);
  reader.members(out);
  out.inputs.depth = nullptr;
  out.inputs.stereo = nullptr;
  if (!ok(reader.status())) return reader.status();
  return reader.position() == bytes.size() ? Status::kOk : Status::kCorrupt;
}

Status encode_depth(const hal::DepthFrame& frame, std::span<std::uint8_t> out, std::size_t& size) {
  if (frame.pixel_count() > frame.depth.size()) return Status::kInvalid;
  if (out.size() < kHeaderBound + 2 * frame.pixel_count()) return Status::kExhausted;
  UncheckedWriter writer(out.data());
  writer.members(frame);
  size = writer.size();
  return Status::kOk;
}

Status decode_depth(std::span<const std::uint8_t> bytes, hal::DepthFrame& out) {
  FieldReader reader(bytes);
  reader.members(out);
  if (!ok(reader.status())) return reader.status();
  if (out.pixel_count() > out.depth.size()) return Status::kCorrupt;
  return reader.position() == bytes.size() ? Status::kOk : Status::kCorrupt;
}

Status encode_stereo(const hal::StereoFrame& frame, std::span<std::uint8_t> out,
                     std::size_t& size) {
  if (frame.pixel_count() > frame.left.size()) return Status::kInvalid;
  if (out.size() < kHeaderBound + 2 * frame.pixel_count()) return Status::kExhausted;
  UncheckedWriter writer(out.data());
  writer.members(frame);
  size = writer.size();
  return Status::kOk;
}

Status decode_stereo(std::span<const std::uint8_t> bytes, hal::StereoFrame& out) {
  FieldReader reader(bytes);
  reader.members(out);
  if (!ok(reader.status())) return reader.status();
  if (out.pixel_count() > out.left.size()) return Status::kCorrupt;
  return reader.position() == bytes.size() ? Status::kOk : Status::kCorrupt;
}

}  // namespace surefoot::runtime
