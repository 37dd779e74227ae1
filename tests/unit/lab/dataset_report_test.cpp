#include "supple/lab/dataset_report.h"

#include <gtest/gtest.h>

#include <string>

#include "sample_data.h"
#include "supple/lab/dataset_options.h"

namespace supple::lab {
namespace {

dataset::Dataset sample() {
  DatasetOptions options;
  options.family = "IH21";
  options.simulation.mesh.mesh_size = 0.77;
  dataset::Dataset data = dataset::sample_dataset({0, 8, 0, 1});
  data.recipe = recipe_of(options);
  return data;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(DatasetReport, CountsAndNamesEveryFailure) {
  const std::string text = report(sample());
  EXPECT_TRUE(contains(text, "rows: 60 of 72 planned")) << text;
  EXPECT_TRUE(contains(text, "rejected designs: 2 of 8")) << text;
  EXPECT_TRUE(contains(text, "tiling.hole_closed")) << text;
  EXPECT_TRUE(contains(text, "design 3 (")) << text;
  EXPECT_TRUE(contains(text, "paths that stopped early: 6 of 18")) << text;
  EXPECT_TRUE(contains(text, "State 2 could not be reached.")) << text;
}

TEST(DatasetReport, ListsNoMoreFailuresThanAskedForButCountsAll) {
  const std::string text = report(sample(), 1);
  EXPECT_TRUE(contains(text, "design 3 (")) << text;
  EXPECT_FALSE(contains(text, "design 7 (")) << text;
  EXPECT_TRUE(contains(text, "rejected designs: 2 of 8")) << text;
}

TEST(DatasetReport, AddsUpWhatStagesCost) {
  const auto data = sample();
  std::int64_t count = 0;
  for (const auto& design : data.designs)
    for (const auto& cost : design.costs)
      if (cost.name == "assembly") count += cost.count;
  EXPECT_TRUE(contains(report(data), " " + std::to_string(count) + " times"));
}

TEST(DatasetDescription, NamesTheCommandThatMakesItAgain) {
  EXPECT_TRUE(contains(command_line(sample()), "--family IH21 --designs 8 --seed 1 --mesh-size 0.77"))
      << command_line(sample());
  EXPECT_TRUE(contains(describe(sample()), "engine 0.1.1: 4 designs")) << describe(sample());
}

}  // namespace
}  // namespace supple::lab
