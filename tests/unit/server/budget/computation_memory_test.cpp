#include "supple/budget/computation_memory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include "supple/base/threads.h"
#include "supple/budget/counting_malloc.h"
#include "supple/problem/problem.h"

namespace supple::budget {
namespace {

constexpr std::int64_t mebibyte = 1 << 20;

/// The token and the memory account of a computation.
struct Computation {
  explicit Computation(MemoryBudget& budget) : memory(budget, token) {}

  problem::Problem problem() const {
    try {
      memory.throw_if_stopped();
    } catch (const problem::ProblemError& error) {
      return error.problem();
    }
    return {};
  }

  CancellationToken token;
  ComputationMemory memory;
};

TEST(ComputationMemory, CountsWhatIsTakenAndGivenBack) {
  MemoryBudget budget(100, 80);
  {
    Computation computation(budget);
    computation.memory.add(50);
    computation.memory.add(-20);
    EXPECT_EQ(budget.used(), 30);
    computation.memory.add(-70);  // it frees blocks that another computation has allocated
    EXPECT_EQ(budget.used(), 0);
    computation.memory.add(10);
    EXPECT_EQ(budget.used(), 10);
    EXPECT_EQ(computation.memory.peak(), 50);
    EXPECT_FALSE(computation.token.requested());
    EXPECT_EQ(computation.problem().code, "");
  }
  EXPECT_EQ(budget.used(), 0);
}

TEST(ComputationMemory, StopsOneThatHoldsMoreThanARequestMay) {
  MemoryBudget budget(1000, 80);
  Computation computation(budget);
  computation.memory.add(80);
  EXPECT_FALSE(computation.token.requested());
  computation.memory.add(1);
  EXPECT_TRUE(computation.token.requested());
  computation.memory.add(-81);  // freeing memory afterwards does not change the cause of the stop
  const auto problem = computation.problem();
  EXPECT_EQ(problem.code, "request.too_much_memory");
  ASSERT_TRUE(problem.limit);
  EXPECT_EQ(problem.limit->limit, 80);
  EXPECT_EQ(problem.limit->value, 81);
  EXPECT_EQ(problem.limit->setting, "--max-request-memory");
}

TEST(ComputationMemory, StopsTheLargestWhereAllTogetherHoldTooMuch) {
  MemoryBudget budget(100, 80);
  MemoryBudget::Reservation body(budget);
  body.add(10, "the body");
  Computation large(budget);
  Computation small(budget);
  large.memory.add(60);
  small.memory.add(30);
  EXPECT_FALSE(large.token.requested());
  small.memory.add(1);
  EXPECT_TRUE(large.token.requested());
  EXPECT_FALSE(small.token.requested());
  const auto problem = large.problem();
  EXPECT_EQ(problem.code, "server.out_of_memory");
  ASSERT_TRUE(problem.limit);
  EXPECT_EQ(problem.limit->limit, 100);
  EXPECT_EQ(problem.limit->value, 101);
  EXPECT_EQ(problem.limit->setting, "--memory");
  EXPECT_TRUE(problem.retry_after);
}

TEST(ComputationMemory, RefusesALargeBlockBeforeItIsAllocated) {
  MemoryBudget budget(100, 80);
  Computation computation(budget);
  computation.memory.add(10);
  EXPECT_TRUE(computation.memory.allows(70));
  EXPECT_FALSE(computation.memory.allows(71));
  EXPECT_EQ(computation.problem().code, "request.too_much_memory");
}

TEST(ComputationMemory, GivesABlockAMarginWhileALargerOneIsStopping) {
  MemoryBudget budget(80, 80);
  Computation large(budget);
  Computation small(budget);
  large.memory.add(60);
  EXPECT_TRUE(small.memory.allows(30));
  EXPECT_TRUE(large.token.requested());
  EXPECT_FALSE(small.token.requested());
  EXPECT_FALSE(small.memory.allows(31));  // beyond the margin of an eighth
  EXPECT_EQ(small.problem().code, "server.out_of_memory");
}

TEST(ComputationMemory, StopsAReportThatNeedsMoreThanItsReserve) {
  MemoryBudget budget(1000, 80);
  Computation computation(budget);
  computation.memory.add(81);
  ASSERT_TRUE(computation.token.resume(StopReason::memory));
  computation.memory.add(8);
  EXPECT_TRUE(computation.memory.allows(1)) << "the reserve is an eighth";
  EXPECT_FALSE(computation.token.requested());
  computation.memory.add(2);
  EXPECT_EQ(computation.token.reason(), StopReason::memory);
  EXPECT_EQ(computation.problem().code, "request.too_much_memory");
  ASSERT_TRUE(computation.token.resume(StopReason::memory));
  EXPECT_FALSE(computation.memory.allows(1));
  EXPECT_EQ(computation.token.reason(), StopReason::memory) << "it is stopped each time";
}

TEST(ComputationMemory, StopsAReportWhereAllTogetherNeedMoreThanTheReserve) {
  MemoryBudget budget(80, 80);
  Computation large(budget);
  Computation small(budget);
  large.memory.add(60);
  small.memory.add(21);
  ASSERT_TRUE(large.token.resume(StopReason::memory));
  EXPECT_TRUE(large.memory.allows(9));
  large.memory.add(9);
  EXPECT_FALSE(large.token.requested() || small.token.requested());
  small.memory.add(1);
  EXPECT_EQ(large.token.reason(), StopReason::memory);
  EXPECT_FALSE(small.token.requested());
  EXPECT_EQ(large.problem().code, "server.out_of_memory");
}

TEST(ComputationMemory, StopsTheLargestOnceTheProcessComesNearItsLimit) {
  // The ballast is so large that the memory of the test itself is negligible.
  const std::vector<char> ballast(64 * mebibyte, 'x');
  const auto now = memory_use().resident;
  MemoryBudget enough(1000, 1000, 2 * now);
  Computation unhurt(enough);
  enough.relieve();
  EXPECT_FALSE(unhurt.token.requested());

  MemoryBudget budget(1000, 1000, now - now / 16);
  Computation large(budget);
  Computation small(budget);
  large.memory.add(20);
  small.memory.add(10);
  budget.relieve();
  EXPECT_TRUE(large.token.requested());
  EXPECT_EQ(large.problem().code, "server.out_of_memory");
  budget.relieve();
  EXPECT_FALSE(small.token.requested()) << "the other one has time to end";
  ASSERT_TRUE(large.token.resume(StopReason::memory));
  budget.relieve();
  EXPECT_FALSE(large.token.requested() || small.token.requested()) << "it has time for its report";

  MemoryBudget urgent(1000, 1000, now / 2);
  Computation first(urgent);
  Computation second(urgent);
  urgent.relieve();
  urgent.relieve();
  EXPECT_TRUE(first.token.requested());
  EXPECT_TRUE(second.token.requested()) << "there is no time";
  ASSERT_TRUE(first.token.resume(StopReason::memory));
  urgent.relieve();
  EXPECT_TRUE(first.token.requested()) << "nor for a report";
  EXPECT_EQ(ballast.back(), 'x');
}

TEST(ComputationMemory, CountsTheBlocksOfEveryThreadThatHelps) {
  if (!counts_allocations()) GTEST_SKIP() << "a sanitizer allocates";
  set_thread_count(2);
  MemoryBudget budget(1000 * mebibyte, 1000 * mebibyte);
  Computation computation(budget);
  std::vector<std::unique_ptr<char[]>> blocks(16);
  {
    const MemoryAccount::Use use(&computation.memory);
    parallel_for(16, [&](int i) { blocks[static_cast<std::size_t>(i)] = std::make_unique<char[]>(4 * mebibyte); });
  }
  EXPECT_GE(budget.used(), 64 * mebibyte);
  EXPECT_LT(budget.used(), 66 * mebibyte);
  std::thread([] { std::vector<char>(32 * mebibyte, 'x'); }).join();
  EXPECT_LT(computation.memory.peak(), 66 * mebibyte);
  {
    const MemoryAccount::Use use(&computation.memory);
    blocks.clear();
  }
  EXPECT_LT(budget.used(), mebibyte);
}

TEST(ComputationMemory, CountsEveryWayToAllocate) {
  if (!counts_allocations()) GTEST_SKIP() << "a sanitizer allocates";
  MemoryBudget budget(1000 * mebibyte, 1000 * mebibyte);
  Computation computation(budget);
  const MemoryAccount::Use use(&computation.memory);
  constexpr std::size_t bytes = 2 * mebibyte;
  std::int64_t expected = 0;
  const auto expect_more = [&](const char* what) {
    expected += bytes;
    EXPECT_NEAR(static_cast<double>(budget.used()), static_cast<double>(expected), 0.05 * bytes) << what;
  };
  void* const plain = std::malloc(bytes);
  expect_more("malloc");
  void* const zeroed = std::calloc(2, bytes / 2);
  expect_more("calloc");
  void* grown = std::realloc(std::malloc(bytes / 2), bytes);
  expect_more("realloc");
  void* const aligned = std::aligned_alloc(64, bytes);
  expect_more("aligned_alloc");
  void* placed = nullptr;
  ASSERT_EQ(posix_memalign(&placed, 64, bytes), 0);
  expect_more("posix_memalign");
  auto* const made = new std::vector<double>(bytes / sizeof(double));
  expect_more("new");
  for (void* const block : {plain, zeroed, grown, aligned, placed}) std::free(block);
  delete made;
  EXPECT_LT(budget.used(), mebibyte);
}

TEST(ComputationMemory, IsABadAllocWhereABlockIsRefused) {
  if (!counts_allocations()) GTEST_SKIP() << "a sanitizer allocates";
  MemoryBudget budget(1000 * mebibyte, 8 * mebibyte);
  Computation computation(budget);
  const MemoryAccount::Use use(&computation.memory);
  EXPECT_THROW(std::vector<char>(9 * mebibyte, 'x'), std::bad_alloc);
  EXPECT_TRUE(computation.token.requested());
  EXPECT_EQ(computation.problem().code, "request.too_much_memory");
  void* const block = std::malloc(mebibyte);
  ASSERT_NE(block, nullptr);
  void* const moved = std::realloc(block, 9 * mebibyte);
  EXPECT_EQ(moved, nullptr);
  std::free(moved ? moved : block);
  void* unset = &computation;
  EXPECT_EQ(posix_memalign(&unset, 64, 9 * mebibyte), ENOMEM);
  EXPECT_EQ(unset, &computation);
}

}  // namespace
}  // namespace supple::budget
