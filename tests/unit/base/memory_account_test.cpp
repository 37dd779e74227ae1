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

TEST(MemoryAccount, OfAThreadIsTheInnermostThatItUses) {
  EXPECT_EQ(MemoryAccount::of_this_thread(), nullptr);
  Counter outer;
  Counter inner;
  {
    const MemoryAccount::Use first(&outer);
    note_allocated(100);
    {
      const MemoryAccount::Use second(&inner);
      EXPECT_EQ(MemoryAccount::of_this_thread(), &inner);
      note_allocated(20);
      note_freed(5);
      const MemoryAccount::Use nobody(nullptr);
      note_allocated(7);
    }
    EXPECT_EQ(MemoryAccount::of_this_thread(), &outer);
    note_allocated(1);
  }
  note_allocated(1000);
  EXPECT_EQ(outer.sum, 101);
  EXPECT_EQ(inner.sum, 15);
  EXPECT_EQ(MemoryAccount::of_this_thread(), nullptr);
}

TEST(MemoryAccount, HearsOfSmallSumsTogetherAndOfLargeOnesAtOnce) {
  Counter counter;
  const MemoryAccount::Use use(&counter);
  for (int i = 0; i < 1000; ++i) note_allocated(16);
  EXPECT_EQ(counter.calls, 0);
  note_allocated(1 << 20);
  EXPECT_EQ(counter.sum, 1000 * 16 + (1 << 20));
  note_freed(1 << 20);
  EXPECT_EQ(counter.sum, 1000 * 16);
}

TEST(MemoryAccount, IsAskedForLargeBlocksOnly) {
  Counter counter;
  counter.most = 1000;
  EXPECT_TRUE(may_allocate(large_block)) << "this thread has no account";
  const MemoryAccount::Use use(&counter);
  note_allocated(5000);
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
      note_allocated(3);
      parallel_for(2, [&](int) { note_allocated(1); });
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    });
  }
  EXPECT_EQ(strangers, 0);
  EXPECT_EQ(counter.sum, 200 * 5);
  parallel_for(50, [&](int) {
    if (MemoryAccount::of_this_thread()) ++strangers;
  });
  EXPECT_EQ(strangers, 0) << "a thread that helped keeps the account";
}

}  // namespace
}  // namespace supple
