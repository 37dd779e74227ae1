#include "supple/base/memory_account.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "supple/base/threads.h"

namespace supple {
namespace {

struct Counter final : MemoryAccount {
  void add(std::int64_t bytes) noexcept override {
    sum += bytes;
    ++calls;
  }
  bool allows(std::int64_t bytes) noexcept override { return bytes < most; }

  std::atomic<std::int64_t> sum{0};
  std::atomic<int> calls{0};
  std::int64_t most = 1LL << 40;
};

constexpr std::int64_t kibibyte = 1 << 10;

TEST(MemoryAccount, OfAThreadIsTheInnermostThatItUses) {
  EXPECT_EQ(MemoryAccount::of_this_thread(), nullptr);
  Counter outer;
  Counter inner;
  {
    const MemoryAccount::Use first(&outer);
    note_block(100 * kibibyte);
    {
      const MemoryAccount::Use second(&inner);
      EXPECT_EQ(MemoryAccount::of_this_thread(), &inner);
      note_block(20 * kibibyte);
      const MemoryAccount::Use nobody(nullptr);
      EXPECT_EQ(MemoryAccount::of_this_thread(), nullptr);
    }
    EXPECT_EQ(MemoryAccount::of_this_thread(), &outer);
    note_block(50 * kibibyte);
  }
  EXPECT_EQ(outer.sum, 150 * kibibyte);
  EXPECT_EQ(inner.sum, 20 * kibibyte);
  EXPECT_EQ(MemoryAccount::of_this_thread(), nullptr);
}

TEST(MemoryAccount, KeepsASmallSumUntilItsThreadComesBack) {
  Counter counter;
  for (int i = 0; i < 100; ++i) {
    const MemoryAccount::Use use(&counter);
    note_block(kibibyte);
  }
  EXPECT_GE(counter.sum, 80 * kibibyte);
  EXPECT_LE(counter.sum, 100 * kibibyte);
  EXPECT_LE(counter.calls, 10);
  Counter other;
  {
    const MemoryAccount::Use use(&other);
    note_block(20 * kibibyte);
  }
  EXPECT_EQ(other.sum, 20 * kibibyte) << "what was gathered for another account is not this one's";
}

TEST(MemoryAccount, HearsOfSmallSumsTogetherAndOfLargeOnesAtOnce) {
  Counter counter;
  const MemoryAccount::Use use(&counter);
  for (int i = 0; i < 1000; ++i) note_block(16);
  EXPECT_EQ(counter.calls, 0);
  note_block(1 << 20);
  EXPECT_EQ(counter.sum, 1000 * 16 + (1 << 20));
  note_block(-(1 << 20));
  EXPECT_EQ(counter.sum, 1000 * 16);
}

TEST(MemoryAccount, IsAskedForLargeBlocksOnly) {
  Counter counter;
  counter.most = 1000;
  EXPECT_TRUE(may_allocate(large_block)) << "this thread has no account";
  const MemoryAccount::Use use(&counter);
  note_block(5000);
  EXPECT_TRUE(may_allocate(large_block - 1));
  EXPECT_EQ(counter.sum, 0);
  EXPECT_FALSE(may_allocate(large_block));
  EXPECT_EQ(counter.sum, 5000) << "it knows all before it is asked";
  counter.most = large_block + 1;
  EXPECT_TRUE(may_allocate(large_block));
}

TEST(MemoryAccount, GoesWithALoopToTheThreadsThatHelp) {
  set_thread_count(4);
  Counter counter;
  std::atomic<int> strangers{0};
  {
    const MemoryAccount::Use use(&counter);
    parallel_for(200, [&](int) {
      if (MemoryAccount::of_this_thread() != &counter) ++strangers;
      note_block(30 * kibibyte);
      // The sum is large enough to be reported at the end of a part. A thread that helps with a smaller part would keep
      // it unreported.
      parallel_for(2, [&](int) { note_block(20 * kibibyte); });
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    });
  }
  EXPECT_EQ(strangers, 0);
  EXPECT_EQ(counter.sum, 200 * 70 * kibibyte);
  parallel_for(50, [&](int) {
    if (MemoryAccount::of_this_thread()) ++strangers;
  });
  EXPECT_EQ(strangers, 0) << "a thread that helped keeps the account";
}

}  // namespace
}  // namespace supple
