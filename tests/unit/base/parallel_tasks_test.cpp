#include "supple/base/parallel_tasks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "supple/base/error.h"
#include "supple/base/threads.h"

namespace supple {
namespace {

class Heard : public ProgressSink {
 public:
  void report(double fraction, std::string_view stage) override {
    fractions.push_back(fraction);
    stages.emplace_back(stage);
  }
  std::vector<double> fractions;
  std::vector<std::string> stages;
};

TEST(ParallelTasks, RunEachOnceAndMergeTheirBillsInOrder) {
  CostLedger cost;
  Heard heard;
  std::vector<int> ran(40, 0);
  parallel_tasks(40, {{}, &heard, &cost}, "work", [&](int i, const Execution& own) {
    ++ran[static_cast<std::size_t>(i)];
    EXPECT_EQ(own.progress, nullptr) << "a task does not know how far the others are";
    own.cost->add_quantity("number " + std::to_string(i), i);
    own.cost->add_stage("task", 0.5);
  });
  EXPECT_EQ(ran, std::vector<int>(40, 1));
  ASSERT_EQ(cost.quantities().size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(cost.quantities()[i].value, static_cast<double>(i));
  ASSERT_EQ(cost.stages().size(), 1U);
  EXPECT_EQ(cost.stages()[0].count, 40);
  ASSERT_EQ(heard.fractions.size(), 40U);
  EXPECT_EQ(heard.fractions.front(), 1.0 / 40);
  EXPECT_EQ(heard.fractions.back(), 1);
  EXPECT_EQ(heard.stages.back(), "work");
}

TEST(ParallelTasks, BillNothingWhereNobodyAsks) {
  int ran = 0;
  const auto bills = parallel_bills(1, {}, "work", [&](int, const Execution& own) {
    EXPECT_EQ(own.cost, nullptr);
    ++ran;
  });
  EXPECT_EQ(ran, 1);
  EXPECT_EQ(bills.size(), 1U);
}

TEST(ParallelTasks, StopWhereTheyAreCancelledAndPassExceptionsOn) {
  const CancellationToken token;
  token.request(StopReason::cancelled);
  std::atomic<int> ran = 0;
  EXPECT_THROW(parallel_tasks(10, {token}, "work", [&](int, const Execution&) { ++ran; }), Cancelled);
  EXPECT_EQ(ran, 0);
  EXPECT_THROW(parallel_tasks(10, {}, "work",
                              [&](int i, const Execution&) {
                                if (i == 7) throw Error("a.fault", "It failed.");
                              }),
               Error);
}

TEST(ParallelTasks, BillWhatWasDoneBeforeOneOfThemFailed) {
  set_thread_count(1);
  for (const bool returned : {true, false}) {
    CostLedger cost;
    std::vector<int> began;
    const auto work = [&](int i, const Execution& own) {
      began.push_back(i);
      own.cost->add_quantity("number " + std::to_string(i), 1);
      if (began.size() == 5) throw Error("a.fault", "It failed.");
      own.cost->add_stage("task", 0.5);
    };
    if (returned)
      EXPECT_THROW(parallel_bills(10, {{}, nullptr, &cost}, "work", work), Error);
    else
      EXPECT_THROW(parallel_tasks(10, {{}, nullptr, &cost}, "work", work), Error);
    ASSERT_EQ(began.size(), 5U);
    ASSERT_EQ(cost.quantities().size(), 5U) << "also that of the task that failed";
    std::sort(began.begin(), began.end());
    for (std::size_t k = 0; k < 5; ++k)
      EXPECT_EQ(cost.quantities()[k].name, "number " + std::to_string(began[k])) << "in the order of the tasks";
    ASSERT_EQ(cost.stages().size(), 1U);
    EXPECT_EQ(cost.stages()[0].count, 4);
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace supple
