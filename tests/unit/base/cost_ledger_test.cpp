#include "supple/base/cost_ledger.h"

#include <gtest/gtest.h>

#include <thread>

namespace supple {
namespace {

TEST(CostLedger, AddsUpStagesInTheOrderOfTheirFirstUse) {
  CostLedger ledger;
  ledger.add_stage("search", 1.5);
  ledger.add_stage("path", 0.25, 3);
  ledger.add_stage("search", 0.5, 2);
  ASSERT_EQ(ledger.stages().size(), 2u);
  EXPECT_EQ(ledger.stages()[0].name, "search");
  EXPECT_DOUBLE_EQ(ledger.stages()[0].seconds, 2);
  EXPECT_EQ(ledger.stages()[0].count, 3);
  EXPECT_EQ(ledger.stages()[1].count, 3);
  EXPECT_DOUBLE_EQ(ledger.total_seconds(), 2.25);
}

TEST(CostLedger, AnEffectRanIfItRanOnceAndKeepsTheLatestReason) {
  CostLedger ledger;
  ledger.add_effect("mollifier", false, "no path passes a vertex");
  ledger.add_effect("mollifier", true, "a path passes vertex 3", 1, 0.5);
  ledger.add_effect("mollifier", false, "no path passes a vertex", 2);
  ASSERT_EQ(ledger.effects().size(), 1u);
  EXPECT_TRUE(ledger.effects()[0].ran);
  EXPECT_EQ(ledger.effects()[0].why, "no path passes a vertex");
  EXPECT_EQ(ledger.effects()[0].count, 3);
  EXPECT_DOUBLE_EQ(ledger.effects()[0].seconds, 0.5);
}

TEST(CostLedger, MergesTheBillsOfItsTasks) {
  CostLedger total, task;
  total.add_stage("search", 1);
  total.add_quantity("windows", 10);
  task.add_stage("search", 2, 5);
  task.add_stage("path", 3);
  task.add_effect("verification", true, "asked for");
  task.add_quantity("windows", 32);
  total.merge(task);
  ASSERT_EQ(total.stages().size(), 2u);
  EXPECT_DOUBLE_EQ(total.stages()[0].seconds, 3);
  EXPECT_EQ(total.stages()[0].count, 6);
  EXPECT_TRUE(total.effects().at(0).ran);
  EXPECT_DOUBLE_EQ(total.quantities().at(0).value, 42);
}

TEST(StageTimer, BillsTheTimeOfItsScope) {
  CostLedger ledger;
  {
    const StageTimer timer(&ledger, "wait");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(ledger.stages().size(), 1u);
  EXPECT_EQ(ledger.stages()[0].name, "wait");
  EXPECT_GE(ledger.stages()[0].seconds, 0.005);
}

TEST(StageTimer, WithoutALedgerDoesNothing) { EXPECT_NO_THROW(StageTimer(nullptr, "wait")); }

}  // namespace
}  // namespace supple
