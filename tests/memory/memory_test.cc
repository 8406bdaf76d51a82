// What a tick may not do: use the heap, touch a page for the first time.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <thread>

#include "hal/linux/memory_guard.h"
#include "hal/linux/memory_lock.h"
#include "hal/record/record_writer.h"
#include "hal/replay/surefoot_record.h"
#include "tests/unit/hal/record_fixture.h"
#include "tests/unit/runtime/fake_board.h"

namespace surefoot::hal {
namespace {

using testing::ScratchFolder;

// Keeps the compiler from leaving out an allocation nobody looks at.
void* volatile g_escape;

template <class Action>
std::uint64_t heap_calls_of(const Action& action) {
  MemoryGuard guard;
  guard.arm();
  action();
  guard.disarm();
  return guard.counts().heap_calls;
}

class MemoryGuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!heap_counting_available()) GTEST_SKIP() << "the sanitizer has its own malloc";
  }
};

TEST_F(MemoryGuardTest, CountsTheWholeFamily) {
  EXPECT_EQ(heap_calls_of([] {}), 0u);
  EXPECT_EQ(heap_calls_of([] { g_escape = std::malloc(10); }), 1u);
  EXPECT_EQ(heap_calls_of([] { g_escape = std::realloc(g_escape, 100); }), 1u);
  EXPECT_EQ(heap_calls_of([] { std::free(g_escape); }), 1u);
  EXPECT_EQ(heap_calls_of([] { std::free(nullptr); }), 0u);
  EXPECT_EQ(heap_calls_of([] { g_escape = std::calloc(3, 5); }), 1u);
  std::free(g_escape);
  EXPECT_EQ(heap_calls_of([] { g_escape = std::aligned_alloc(64, 128); }), 1u);
  std::free(g_escape);
  EXPECT_EQ(heap_calls_of([] {
              void* pointer = nullptr;
              if (::posix_memalign(&pointer, 64, 100) == 0) g_escape = pointer;
            }),
            1u);
  std::free(g_escape);
  EXPECT_EQ(heap_calls_of([] {
              g_escape = new int(3);
              delete static_cast<int*>(g_escape);
            }),
            2u);
  EXPECT_GT(heap_calls_of([] { g_escape = std::string(1000, 'x').data(); }), 0u);
}

TEST_F(MemoryGuardTest, CountsOnlyItsThreadAndOnlyWhileArmed) {
  MemoryGuard guard;
  std::thread other([] {
    for (int i = 0; i < 100; ++i) std::free(std::malloc(10));
  });
  guard.arm();
  // Joining allocates nothing; the other thread's calls are not ours.
  other.join();
  guard.disarm();
  EXPECT_EQ(guard.counts().heap_calls, 0u);
  g_escape = std::malloc(10);
  {
    const ScopedMemoryGuard scope(guard);
    std::free(g_escape);
  }
  EXPECT_EQ(guard.counts().heap_calls, 1u);
}

TEST(MemoryGuard, CountsPageFaults) {
  constexpr std::size_t kPages = 20;
  const std::size_t size = kPages * 4096;
  void* pages = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(pages, MAP_FAILED);
  ::madvise(pages, size, MADV_NOHUGEPAGE);
  const auto touch = [&] {
    for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(pages)[i * 4096] = 1;
  };
  MemoryGuard first;
  first.arm();
  touch();
  first.disarm();
  EXPECT_GE(first.counts().page_faults, kPages);
  MemoryGuard second;
  second.arm();
  touch();
  second.disarm();
  EXPECT_EQ(second.counts().page_faults, 0u);
  ::munmap(pages, size);
}

TEST(MemoryLock, LeavesNoFirstTouchOfWhatIsMapped) {
  if (!heap_counting_available())
    GTEST_SKIP() << "a sanitizer ignores memory locks and touches pages of its own";
  constexpr std::size_t kSize = std::size_t{4} << 20;
  void* pages = ::mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(pages, MAP_FAILED);
  const MemoryLockReport report = lock_memory();
  MemoryGuard guard;
  guard.arm();
  for (std::size_t i = 0; i < kSize; i += 4096) static_cast<volatile char*>(pages)[i] = 1;
  guard.disarm();
  EXPECT_EQ(guard.counts().page_faults, 0u) << report.note;
  ::munmap(pages, kSize);
}

// A control task and a slow one with nothing inside: what remains is the executive and the record.
bool release(void*, const autonomy::TickInputs&) { return true; }
void run(void*) {}
void publish(void*, autonomy::TickOutputs& outputs) {
  const Status status = outputs.can.push_back({});
  SUREFOOT_ASSERT(ok(status));
}

TEST(TickMemory, ATickWithDepthAndRecordUsesNoHeapAndFaultsNoPage) {
  if (!heap_counting_available())
    GTEST_SKIP() << "a sanitizer ignores memory locks and touches pages of its own";
  const ScratchFolder folder;
  testing::FakeBoard fake;
  fake.can.keep_sent = false;
  fake.gait.keep_sent = false;
  RecordWriter writer;
  RecordWriterOptions options;
  options.chunk_bytes = std::size_t{1} << 20;
  ASSERT_EQ(writer.open(folder.file("r.mcap"), surefoot_record_layout(), options), Status::kOk);
  fake.record.forward = &writer;
  fake.depth.frame.intrinsics.width_px = 640;
  fake.depth.frame.intrinsics.height_px = 480;

  const runtime::Task table[] = {
      {"control", 1, 0, 0, 0, nullptr, release, run, publish},
      {"slow", 4, 0, 2, 0, nullptr, release, run, publish},
  };
  runtime::InlineRunner runner(nullptr);
  TickMemoryGuard guard(10);
  auto executive = std::make_unique<runtime::Executive>();
  runtime::ExecutiveSetup setup{fake.board(), table, milliseconds(2), &runner, &guard};
  ASSERT_EQ(executive->start(setup), Status::kOk);
  lock_memory();
  for (int t = 0; t < 300; ++t) {
    if (t % 15 == 0) fake.depth.waiting = 1;
    ASSERT_EQ(executive->run_tick(), Status::kOk);
  }
  EXPECT_EQ(guard.guarded_ticks(), 290u);
  EXPECT_EQ(guard.counts().heap_calls, 0u);
  EXPECT_EQ(guard.counts().page_faults, 0u);
  EXPECT_EQ(executive->counters().records_refused, 0u);
  EXPECT_EQ(writer.close(), Status::kOk);
  EXPECT_EQ(writer.counters().messages, 320u);
}

}  // namespace
}  // namespace surefoot::hal
