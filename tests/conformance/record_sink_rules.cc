#include "tests/conformance/record_sink_rules.h"

#include <array>
#include <cstdlib>
#include <new>
#include <string>

#include "core/base/random.h"

namespace {

thread_local std::uint64_t heap_calls = 0;

}  // namespace

// The replaced forms count and forward; the array and nothrow forms end here by default.
void* operator new(std::size_t size) {
  ++heap_calls;
  void* const memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace surefoot::conformance {
namespace {

constexpr std::array<hal::RecordChannel, 3> kChannels{
    hal::RecordChannel::kTick, hal::RecordChannel::kDepth, hal::RecordChannel::kLidar};

std::vector<StoredMessage> of_channel(const std::vector<StoredMessage>& all,
                                      hal::RecordChannel channel) {
  std::vector<StoredMessage> some;
  for (const StoredMessage& message : all) {
    if (message.channel == channel) some.push_back(message);
  }
  return some;
}

class RecordSinkSuite {
 public:
  explicit RecordSinkSuite(RecordSinkBench& bench) : bench_(bench), sink_(bench.sink()) {}

  Violations run() {
    before_ = sink_.counters();
    write(hal::RecordChannel::kConfiguration, 1, 3000);  // always the first
    Random random(1);
    for (std::int64_t i = 2; i < 500; ++i) {
      const hal::RecordChannel channel = kChannels[random.below(kChannels.size())];
      const std::size_t size = i % 50 == 0 ? 0 : random.below(20'000);
      write(channel, i, size);
    }
    check_counters();
    check_stored();
    return findings_.take();
  }

 private:
  void write(hal::RecordChannel channel, std::int64_t number, std::size_t size) {
    StoredMessage message{channel, milliseconds(number), {}};
    message.bytes.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      message.bytes[i] = static_cast<std::uint8_t>(i * 31 + static_cast<std::size_t>(number));
    }
    std::vector<std::uint8_t> bytes = message.bytes;
    const std::uint64_t heap_before = heap_calls_of_this_thread();
    const Status status = sink_.write(channel, message.stamp, bytes);
    findings_.expect(heap_calls_of_this_thread() == heap_before, "SINK-HEAP", "operator new");
    bytes.assign(bytes.size(), 0xEE);  // the sink must have its own copy by now
    if (ok(status)) {
      accepted_bytes_ += message.bytes.size();
      accepted_.push_back(std::move(message));
      return;
    }
    ++refused_;
    findings_.expect(status == Status::kExhausted || status == Status::kUnavailable, "SINK-STATUS",
                     to_string(status));
  }

  void check_counters() {
    const hal::RecordCounters after = sink_.counters();
    findings_.expect(after.messages - before_.messages == accepted_.size(), "SINK-COUNT",
                     std::to_string(after.messages - before_.messages) + " messages, not " +
                         std::to_string(accepted_.size()));
    findings_.expect(after.bytes - before_.bytes == accepted_bytes_, "SINK-COUNT",
                     std::to_string(after.bytes - before_.bytes) + " bytes, not " +
                         std::to_string(accepted_bytes_));
    findings_.expect(after.dropped - before_.dropped == refused_, "SINK-COUNT",
                     std::to_string(after.dropped - before_.dropped) + " dropped, not " +
                         std::to_string(refused_));
  }

  void check_stored() {
    const std::vector<StoredMessage> stored = bench_.stored();
    findings_.expect(!accepted_.empty(), "SINK-KEEP", "nothing was accepted");
    findings_.expect(
        stored.size() == accepted_.size(), "SINK-KEEP",
        std::to_string(stored.size()) + " stored, not " + std::to_string(accepted_.size()));
    for (const hal::RecordChannel channel :
         {hal::RecordChannel::kConfiguration, kChannels[0], kChannels[1], kChannels[2]}) {
      compare(of_channel(accepted_, channel), of_channel(stored, channel));
    }
  }

  void compare(const std::vector<StoredMessage>& wanted, const std::vector<StoredMessage>& got) {
    for (std::size_t i = 0; i < wanted.size() && i < got.size(); ++i) {
      const bool overwritten =
          !wanted[i].bytes.empty() && got[i].bytes.size() == wanted[i].bytes.size() &&
          got[i].bytes[0] == 0xEE && got[i].bytes.back() == 0xEE && got[i].bytes != wanted[i].bytes;
      findings_.expect(!overwritten, "SINK-COPY", "holds what the caller wrote afterwards");
      findings_.expect(overwritten || got[i] == wanted[i], "SINK-KEEP", "a message differs");
    }
  }

  RecordSinkBench& bench_;
  hal::RecordSink& sink_;
  Findings findings_;
  hal::RecordCounters before_;
  std::vector<StoredMessage> accepted_;
  std::uint64_t accepted_bytes_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace

Violations record_sink_violations(RecordSinkBench& bench) { return RecordSinkSuite(bench).run(); }

std::uint64_t heap_calls_of_this_thread() { return heap_calls; }

}  // namespace surefoot::conformance
