#include "core/base/fields.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace surefoot {
namespace {

enum class Mode : std::uint8_t { kIdle = 0, kWalk = 3 };

struct Contact {
  std::int16_t leg = 0;
  bool firm = false;
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("leg", self.leg);
    visit("firm", self.firm);
  }
};

struct Sample {
  TimeNs stamp;
  Mode mode = Mode::kIdle;
  double height_m = 0;
  float weight = 0;
  std::array<std::int32_t, 3> counts{};
  std::array<TimeNs, 2> times{};
  FixedVector<Contact, 4> contacts;
  Contact last;
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("mode", self.mode);
    visit("height_m", self.height_m);
    visit("weight", self.weight);
    visit("counts", self.counts);
    visit("times_ns", self.times);
    visit("contacts", self.contacts);
    visit("last", self.last);
  }
};

// 8 + 1 + 8 + 4 + 12 + 16 + (4 + 3 per contact) + 3
constexpr std::size_t kBytesOfTwoContacts = 62;
constexpr std::size_t kContactCountOffset = 49;

Sample example() {
  Sample sample;
  sample.stamp = {-5};
  sample.mode = Mode::kWalk;
  sample.height_m = -0.125;
  sample.weight = 3.5f;
  sample.counts = {1, -2, 0x7fffffff};
  sample.times = {TimeNs{7}, TimeNs{-8}};
  EXPECT_EQ(sample.contacts.push_back({-1, true}), Status::kOk);
  EXPECT_EQ(sample.contacts.push_back({2, false}), Status::kOk);
  sample.last = {3, true};
  return sample;
}

std::vector<std::uint8_t> bytes_of(const Sample& sample) {
  std::array<std::uint8_t, 256> buffer{};
  FieldWriter writer(buffer);
  writer.members(sample);
  EXPECT_EQ(writer.status(), Status::kOk);
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(writer.size())};
}

TEST(Fields, ReadsBackWhatWasWritten) {
  const std::vector<std::uint8_t> bytes = bytes_of(example());
  ASSERT_EQ(bytes.size(), kBytesOfTwoContacts);
  Sample copy;
  FieldReader reader(bytes);
  reader.members(copy);
  EXPECT_EQ(reader.status(), Status::kOk);
  EXPECT_EQ(reader.position(), bytes.size());
  EXPECT_EQ(copy.stamp.ns, -5);
  EXPECT_EQ(copy.mode, Mode::kWalk);
  EXPECT_EQ(copy.height_m, -0.125);
  EXPECT_EQ(copy.weight, 3.5f);
  EXPECT_EQ(copy.counts[1], -2);
  EXPECT_EQ(copy.times[1].ns, -8);
  ASSERT_EQ(copy.contacts.size(), 2u);
  EXPECT_EQ(copy.contacts[0].leg, -1);
  EXPECT_TRUE(copy.contacts[0].firm);
  EXPECT_FALSE(copy.contacts[1].firm);
  EXPECT_EQ(copy.last.leg, 3);
  EXPECT_EQ(bytes_of(copy), bytes);
}

TEST(Fields, CanonicalFormIsLittleEndianWithoutPadding) {
  const std::vector<std::uint8_t> bytes = bytes_of(example());
  const std::vector<std::uint8_t> start = {
      0xfb, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,  // stamp
      3,                                               // mode
      0,    0,    0,    0,    0,    0,    0xc0, 0xbf,  // -0.125
      0,    0,    0x60, 0x40,                          // 3.5f
      1,    0,    0,    0};
  ASSERT_GE(bytes.size(), start.size());
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(),
                                      bytes.begin() + static_cast<std::ptrdiff_t>(start.size())),
            start);
}

TEST(Fields, HashIsTheHashOfTheCanonicalBytes) {
  const std::vector<std::uint8_t> bytes = bytes_of(example());
  Fnv64 of_bytes;
  of_bytes.bytes(bytes.data(), bytes.size());
  Fnv64 of_fields;
  FieldHasher hasher(of_fields);
  const Sample sample = example();
  hasher.members(sample);
  EXPECT_EQ(of_fields.value(), of_bytes.value());
}

TEST(Fields, EveryTruncationIsReported) {
  const std::vector<std::uint8_t> bytes = bytes_of(example());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Sample copy;
    FieldReader reader{std::span(bytes).first(size)};
    reader.members(copy);
    EXPECT_EQ(reader.status(), Status::kCorrupt) << size;
    EXPECT_LE(reader.position(), size);
  }
}

TEST(Fields, AFieldBeyondTheEndKeepsItsValue) {
  const std::vector<std::uint8_t> bytes = bytes_of(example());
  Sample copy;
  copy.last = {77, false};
  FieldReader reader{std::span(bytes).first(bytes.size() - 3)};
  reader.members(copy);
  EXPECT_EQ(copy.last.leg, 77);
}

TEST(Fields, AListLongerThanItsCapacityIsCorruptAndEmpty) {
  for (const std::uint8_t count : {std::uint8_t{5}, std::uint8_t{255}}) {
    std::vector<std::uint8_t> bytes = bytes_of(example());
    bytes[kContactCountOffset] = count;
    bytes.resize(bytes.size() + 1024);
    Sample copy;
    FieldReader reader(bytes);
    reader.members(copy);
    EXPECT_EQ(reader.status(), Status::kCorrupt);
    EXPECT_TRUE(copy.contacts.empty());
  }
}

TEST(Fields, EveryBufferThatIsTooSmallIsReported) {
  const Sample sample = example();
  std::array<std::uint8_t, kBytesOfTwoContacts + 1> buffer{};
  for (std::size_t size = 0; size < kBytesOfTwoContacts; ++size) {
    buffer.back() = 0xee;
    FieldWriter writer{std::span(buffer).first(size)};
    writer.members(sample);
    EXPECT_EQ(writer.status(), Status::kExhausted) << size;
    EXPECT_LE(writer.size(), size);
    EXPECT_EQ(buffer.back(), 0xee);
  }
  FieldWriter writer{std::span(buffer)};
  writer.members(sample);
  EXPECT_EQ(writer.status(), Status::kOk);
  constexpr std::array<std::uint8_t, 2> kTail = {1, 2};
  writer.raw(kTail.data(), kTail.size());
  EXPECT_EQ(writer.status(), Status::kExhausted);
}

// A visitor that follows the path: what replay uses to name the field that differs.
class PathVisitor : public FieldVisitor<PathVisitor> {
 public:
  template <class T>
  void scalar(const char* name, T&) {
    paths.push_back(prefix_ + name);
  }
  void enter(const char* name) { push(std::string(name) + "."); }
  void leave() { pop(); }
  void enter_index(std::size_t i) { push("[" + std::to_string(i) + "]"); }
  void leave_index() { pop(); }
  std::vector<std::string> paths;

 private:
  void push(const std::string& part) {
    lengths_.push_back(prefix_.size());
    prefix_ += part;
  }
  void pop() {
    prefix_.resize(lengths_.back());
    lengths_.pop_back();
  }
  std::string prefix_;
  std::vector<std::size_t> lengths_;
};

TEST(Fields, VisitsPathsInTheOrderListed) {
  const Sample sample = example();
  PathVisitor visitor;
  visitor.members(sample);
  ASSERT_EQ(visitor.paths.size(), 16u);
  EXPECT_EQ(visitor.paths[0], "stamp_ns");
  EXPECT_EQ(visitor.paths[5], "counts.[1]");
  EXPECT_EQ(visitor.paths[9], "contacts.size");
  EXPECT_EQ(visitor.paths[12], "contacts.[1]leg");
  EXPECT_EQ(visitor.paths[15], "last.firm");
}

TEST(Fields, ScalarBitsRoundTrip) {
  EXPECT_EQ(scalar_from_bits<double>(scalar_bits(-0.0)), -0.0);
  EXPECT_EQ(scalar_bits(-0.0), 0x8000000000000000ull);
  EXPECT_EQ(scalar_from_bits<std::int8_t>(scalar_bits(std::int8_t{-3})), -3);
  EXPECT_EQ(scalar_from_bits<bool>(2), true);
  EXPECT_EQ(scalar_from_bits<Mode>(scalar_bits(Mode::kWalk)), Mode::kWalk);
}

}  // namespace
}  // namespace surefoot
