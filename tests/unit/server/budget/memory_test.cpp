#include "supple/budget/memory.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "supple/problem/problem.h"

namespace supple::budget {
namespace {

using Reservation = MemoryBudget::Reservation;

problem::Problem refusal(Reservation& reservation, std::int64_t bytes) {
  try {
    reservation.add(bytes, "the body");
  } catch (const problem::ProblemError& error) {
    return error.problem();
  }
  return {};
}

TEST(MemoryBudget, GivesBackWhatARequestReserved) {
  MemoryBudget budget(100, 80);
  {
    Reservation first(budget);
    first.add(30, "the body");
    first.add(20, "the body");
    EXPECT_EQ(budget.used(), 50);
    Reservation second = std::move(first);
    EXPECT_EQ(budget.used(), 50);
    EXPECT_EQ(second.bytes(), 50);
    second = Reservation(budget);
    EXPECT_EQ(budget.used(), 0);
    second.add(10, "the body");
  }
  EXPECT_EQ(budget.used(), 0);
}

TEST(MemoryBudget, RefusesARequestBeyondItsOwnLimit) {
  MemoryBudget budget(100, 80);
  Reservation reservation(budget);
  reservation.add(50, "the body");
  const auto problem = refusal(reservation, 31);
  EXPECT_EQ(problem.code, "request.too_much_memory");
  ASSERT_TRUE(problem.limit);
  EXPECT_EQ(problem.limit->limit, 80);
  EXPECT_EQ(problem.limit->value, 81);
  EXPECT_EQ(problem.limit->setting, "--max-request-memory");
  EXPECT_EQ(budget.used(), 50);
  EXPECT_EQ(refusal(reservation, 30).code, "");
}

TEST(MemoryBudget, RefusesWhatAllRequestsTogetherHaveNoRoomFor) {
  MemoryBudget budget(100, 80);
  Reservation first(budget);
  first.add(60, "the body");
  Reservation second(budget);
  const auto problem = refusal(second, 41);
  EXPECT_EQ(problem.code, "server.out_of_memory");
  ASSERT_TRUE(problem.limit);
  EXPECT_EQ(problem.limit->limit, 100);
  EXPECT_EQ(problem.limit->value, 101);
  EXPECT_EQ(problem.limit->setting, "--memory");
  EXPECT_TRUE(problem.retry_after);
  first.release();
  EXPECT_EQ(refusal(second, 41).code, "");
}

TEST(MemoryBudget, RefusesWhatTheProcessHasNoRoomFor) {
  MemoryBudget budget(100, 80, memory_use().resident / 2);
  Reservation reservation(budget);
  const auto problem = refusal(reservation, 1);
  EXPECT_EQ(problem.code, "server.out_of_memory");
  EXPECT_TRUE(problem.retry_after);
  EXPECT_EQ(budget.used(), 0);
}

TEST(MemoryBudget, OfAThreadIsThatOfTheRequestItAnswers) {
  MemoryBudget budget(100, 80);
  reserve(1000, "nothing");  // ignored: this thread answers no request
  Reservation outer(budget);
  {
    const RequestMemory memory(outer);
    reserve(10, "the body");
    Reservation inner(budget);
    {
      const RequestMemory nested(inner);
      reserve(20, "the body");
    }
    reserve(5, "the body");
    EXPECT_EQ(outer.bytes(), 15);
    EXPECT_EQ(inner.bytes(), 20);
  }
  reserve(1000, "nothing");
  EXPECT_EQ(budget.used(), 15);
}

TEST(MemoryUse, GrowsWithWhatIsAllocated) {
  const auto before = memory_use();
  constexpr std::size_t bytes = std::size_t{64} << 20;
  std::vector<char> block(bytes, 1);
  const auto after = memory_use();
  EXPECT_GE(after.resident - before.resident, static_cast<std::int64_t>(bytes) * 9 / 10);
  EXPECT_GE(after.virtual_size, after.resident);
  EXPECT_EQ(block.back(), 1);
}

TEST(MemoryLimits, AreDividedInShares) {
  EXPECT_GT(memory_limits().resident, 0);
  EXPECT_EQ(memory_defaults({1000, 0}).requests, 500);
  EXPECT_EQ(memory_defaults({1000, 500}).requests, 250);
  EXPECT_EQ(memory_defaults({1000, 5000}).requests, 500);
  EXPECT_EQ(memory_defaults({1000, 0}).request, 1LL << 30);
  EXPECT_EQ(memory_defaults({1LL << 40, 0}).request, 1LL << 38);
  EXPECT_EQ(memory_defaults({1000, 0}).meshes, 125);
  EXPECT_EQ(memory_defaults({1000, 0}).helper, 250);
  EXPECT_EQ(memory_defaults({1000, 0}).process, 682);
  EXPECT_EQ(memory_defaults({1LL << 40, 0}).meshes, 2LL << 30);
  EXPECT_EQ(memory_defaults({1LL << 40, 0}).helper, 8LL << 30);
}

}  // namespace
}  // namespace supple::budget
