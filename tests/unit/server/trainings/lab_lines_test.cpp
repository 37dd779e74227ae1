#include "supple/trainings/lab_lines.h"

#include <gtest/gtest.h>

namespace supple::trainings {
namespace {

TEST(LabPlanReader, ReadsWhatThePlanPrints) {
  LabPlanReader reader;
  EXPECT_FALSE(reader.plan());
  for (const auto* line : {"--even-designs 60 --rounds 2 --width 96 --round-designs 15", "simulation 1200 core-seconds",
                           "training 340.5 core-seconds"})
    reader.read(line);
  ASSERT_TRUE(reader.plan());
  EXPECT_EQ(reader.plan()->options, "--even-designs 60 --rounds 2 --width 96 --round-designs 15");
  EXPECT_EQ(reader.plan()->even_designs, 60);
  EXPECT_EQ(reader.plan()->rounds, 2);
  EXPECT_EQ(reader.plan()->round_designs, 15);
  EXPECT_EQ(reader.plan()->simulation_seconds, 1200);
  EXPECT_EQ(reader.plan()->training_seconds, 340.5);
}

TEST(LabPlanReader, HasNoPlanOfOtherLines) {
  LabPlanReader reader;
  for (const auto* line : {"simulation", "training x core-seconds", "", "something else"}) reader.read(line);
  EXPECT_FALSE(reader.plan());
}

TEST(LabLines, AreProgressOrAnErrorOrNothing) {
  const auto progress = progress_in("progress 0.250 error bars");
  ASSERT_TRUE(progress);
  EXPECT_EQ(progress->fraction, 0.25);
  EXPECT_EQ(progress->stage, "error bars");
  const auto error = error_in("error 0.031000 120");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->error, 0.031);
  EXPECT_EQ(error->designs, 120);
  for (const auto* line : {"", "progress", "progress x designs", "error", "error 0.1", "error 0.1 many", "begun"}) {
    EXPECT_FALSE(progress_in(line)) << line;
    EXPECT_FALSE(error_in(line)) << line;
  }
}

}  // namespace
}  // namespace supple::trainings
