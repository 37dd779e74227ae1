#include "supple/numerics/element_loop.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "support/expect_error.h"

namespace supple::numerics {
namespace {

/// Large enough that a round holds few: several rounds are run.
struct Local {
  double value;
  std::array<double, 1000> rest;
};

double sum_of(std::size_t count, std::size_t grain) {
  double sum = 0;
  add_elements<Local>(
      count, grain, [](std::size_t i, Local& local) { local.value = std::sin(static_cast<double>(i) + 0.1); },
      [&](std::size_t, const Local& local) {
        sum += local.value;
        return true;
      });
  return sum;
}

class AddElements : public ::testing::Test {
 protected:
  void TearDown() override { set_thread_count(0); }
};

TEST_F(AddElements, GivesTheSameBitsForAnyNumberOfThreads) {
  double expected = 0;
  for (int i = 0; i < 1003; ++i) expected += std::sin(i + 0.1);
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    for (const std::size_t grain : {1U, 7U, 64U, 2000U}) EXPECT_EQ(sum_of(1003, grain), expected) << threads;
  }
}

TEST_F(AddElements, AddsEachElementOnceInAscendingOrder) {
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    for (const std::size_t count : {0U, 1U, 8U, 999U}) {
      std::vector<std::size_t> order;
      add_elements<Local>(
          count, 8, [](std::size_t i, Local& local) { local.value = static_cast<double>(i); },
          [&](std::size_t i, const Local& local) {
            EXPECT_EQ(local.value, static_cast<double>(i));
            order.push_back(i);
            return true;
          });
      std::vector<std::size_t> expected(count);
      std::iota(expected.begin(), expected.end(), 0U);
      EXPECT_EQ(order, expected);
    }
  }
}

TEST_F(AddElements, LeavesOutTheRestWhereAnElementHasNoValue) {
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    std::size_t added = 0;
    add_elements<Local>(
        1000, 8, [](std::size_t i, Local& local) { local.value = i == 300 ? -1 : 1; },
        [&](std::size_t, const Local& local) {
          if (local.value < 0) return false;
          ++added;
          return true;
        });
    EXPECT_EQ(added, 300U);
  }
}

TEST_F(AddElements, HandsAnExceptionToTheCaller) {
  testing::expect_cancelled(StopReason::cancelled, [] {
    add_elements<Local>(
        1000, 8,
        [](std::size_t i, Local&) {
          if (i == 617) throw Cancelled(StopReason::cancelled);
        },
        [](std::size_t, const Local&) { return true; });
  });
}

}  // namespace
}  // namespace supple::numerics
