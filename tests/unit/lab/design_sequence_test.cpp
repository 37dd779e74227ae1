#include "supple/lab/design_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::lab {
namespace {

DatasetOptions options_for(const char* family) {
  DatasetOptions options;
  options.family = family;
  return options;
}

TEST(DesignSequence, BeginsWithTheCornersOfTheFamilysOwnBox) {
  const auto options = options_for("IH22");
  const auto& bounds = tiling::family("IH22").parameters;
  std::set<std::vector<double>> corners;
  for (int i = 0; i < 8; ++i) {
    const auto parameters = planned_design(options, i).parameters;
    for (std::size_t k = 0; k < bounds.size(); ++k)
      EXPECT_TRUE(parameters[k] == bounds[k].lower || parameters[k] == bounds[k].upper);
    corners.insert(parameters);
  }
  EXPECT_EQ(corners.size(), 8U);
}

TEST(DesignSequence, FillsTheWidenedBoxEvenly) {
  auto options = options_for("IH21");
  options.box_margin = 0.1;
  const auto& bounds = tiling::family("IH21").parameters;
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    const double width = bounds[k].upper - bounds[k].lower;
    std::set<int> strata;
    for (int i = 4; i < 4 + 64; ++i) {
      const double share = (planned_design(options, i).parameters[k] - (bounds[k].lower - 0.1 * width)) / (1.2 * width);
      strata.insert(static_cast<int>(share * 64));
    }
    EXPECT_EQ(strata.size(), 64U);
    EXPECT_EQ(*strata.begin(), 0);
    EXPECT_EQ(*strata.rbegin(), 63);
  }
}

TEST(DesignSequence, GivesListedDesignsTheirLoadsByPlace) {
  auto options = options_for("IH21");
  options.corners = false;
  const auto usual = planned_design(options, 1);
  options.list = {0.11, 0.6, 0.15, 0.7};
  options.designs = 2;
  options.corners = true;
  EXPECT_EQ(planned_design(options, 0).parameters, (std::vector<double>{0.11, 0.6}));
  const auto second = planned_design(options, 1);
  EXPECT_EQ(second.parameters, (std::vector<double>{0.15, 0.7}));
  ASSERT_EQ(second.paths.size(), usual.paths.size());
  EXPECT_EQ(second.paths[0].path.direction, usual.paths[0].path.direction);
  EXPECT_EQ(second.paths[0].stretches, usual.paths[0].stretches);
  options.directions = {0.25, 3};
  options.loads.compression_paths = 1;
  const auto turned = planned_design(options, 1);
  EXPECT_DOUBLE_EQ(turned.paths[0].path.direction, 3) << "of the first tension";
  EXPECT_DOUBLE_EQ(turned.paths[2].path.direction, 3) << "of the compression";
  EXPECT_EQ(turned.paths[0].stretches, usual.paths[0].stretches);
}

TEST(DesignSequence, FillsAPartOfTheBoxFromItsCorners) {
  auto options = options_for("IH21");
  options.part_lower = {0.11, 0.49050000000001};
  options.part_upper = {0.12, 0.6};
  check(options);
  std::set<std::vector<double>> corners;
  std::set<int> strata;
  for (int i = 0; i < 4 + 64; ++i) {
    const auto p = planned_design(options, i).parameters;
    if (i < 4)
      corners.insert(p);
    else
      strata.insert(static_cast<int>((p[0] - 0.11) / 0.01 * 64));
  }
  EXPECT_EQ(corners, (std::set<std::vector<double>>{
                         {0.11, 0.49050000000001}, {0.11, 0.6}, {0.12, 0.49050000000001}, {0.12, 0.6}}));
  EXPECT_EQ(strata.size(), 64U);
  EXPECT_EQ(*strata.begin(), 0);
  EXPECT_EQ(*strata.rbegin(), 63);
}

TEST(DesignSequence, APartEndsAtTheBordersOfTheWidenedBoxWhateverRoundingSays) {
  auto options = options_for("IH01");
  options.part_lower = {0.0375, 0.225, 0.045, 0.38};
  options.part_upper = {0.3125, 0.775, 0.155, 0.82};
  check(options);
  const auto& bounds = tiling::family("IH01").parameters;
  for (int i = 0; i < 16; ++i) {
    const auto p = planned_design(options, i).parameters;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double margin = options.box_margin * (bounds[k].upper - bounds[k].lower);
      EXPECT_GE(p[k], bounds[k].lower - margin);
      EXPECT_LE(p[k], bounds[k].upper + margin);
    }
  }
}

TEST(DesignSequence, DoesNotDependOnHowManyDesignsAreAskedForNorOnTheShard) {
  auto some = options_for("IH01");
  some.designs = 20;
  auto shard = options_for("IH01");
  shard.designs = 1000;
  shard.shards = 4;
  shard.shard = 3;
  const auto a = planned_design(some, 19);
  const auto b = planned_design(shard, 19);
  EXPECT_EQ(a.parameters, b.parameters);
  ASSERT_EQ(a.paths.size(), b.paths.size());
  for (std::size_t p = 0; p < a.paths.size(); ++p) EXPECT_EQ(a.paths[p].stretches, b.paths[p].stretches);
}

TEST(DesignSequence, TakesParametersThatAreGiven) {
  auto options = options_for("IH21");
  options.designs = 1;
  options.parameters = {0.12, 0.6};
  EXPECT_EQ(planned_design(options, 0).parameters, options.parameters);
  EXPECT_FALSE(planned_design(options, 0).paths.empty());
}

}  // namespace
}  // namespace supple::lab
