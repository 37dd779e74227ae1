// The nine sheets whose printed files' statistics are published are printed anew. Path lengths agree within 2 %,
// filament within 5 % and sizes within 0.1 mm. The numbers of channels and the heights are equal.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "supple/weave/gcode.h"
#include "supple/weave/gcode_check.h"
#include "supple/weave/printed_samples.h"

namespace supple::weave {
namespace {

/// Published statistics of a sheet; lengths in mm.
struct Published {
  Sample sample;
  double width, depth;
  double filament;
  double extruded;
  int channels;
  /// Without the height 0.2, to which that file presses the overruns of lifted strands.
  std::vector<double> heights;
};

const std::vector<Published> published{
    {Sample::fused_grid, 128, 128, 422.7, 5456, 0, {0.5}},
    {Sample::sliding_grid, 128, 128, 438.4, 7437, 400, {0.5, 1.5}},
    {Sample::squares_1, 98.2, 80.4, 394.9, 5202, 0, {0.5}},
    {Sample::squares_2, 98.2, 80.4, 418.6, 5931, 128, {0.5, 1.75}},
    {Sample::squares_3, 98.2, 80.4, 423.2, 5924, 128, {0.5, 1.75}},
    {Sample::squares_4, 98.2, 80.4, 422.6, 5760, 96, {0.5, 1.75}},
    {Sample::circles_fused, 91, 73.6, 331.4, 4278, 0, {0.5}},
    {Sample::circles_sliding, 91, 73.6, 342.2, 4794, 86, {0.5, 1.5}},
    {Sample::actuation, 56, 109.2, 48.6, 645, 6, {0.5, 2}},
};

class PublishedLayouts : public ::testing::TestWithParam<Published> {};

TEST_P(PublishedLayouts, AreReproducedByTheToolpath) {
  const Published& expected = GetParam();
  const PrintJob job = printed_sample(expected.sample);
  const ToolpathStatistics s = toolpath(job.weave, job.profile, job.options).statistics;
  EXPECT_NEAR(s.extruded_length, expected.extruded, 0.02 * expected.extruded);
  EXPECT_NEAR(s.filament, expected.filament, 0.05 * expected.filament);
  EXPECT_EQ(s.channels, expected.channels);
  // The published boxes are those of centre lines.
  EXPECT_NEAR(s.highest[0] - s.lowest[0], expected.width, 0.1);
  EXPECT_NEAR(s.highest[1] - s.lowest[1], expected.depth, 0.1);
  ASSERT_EQ(s.heights.size(), expected.heights.size());
  for (std::size_t i = 0; i < s.heights.size(); ++i) EXPECT_NEAR(s.heights[i], expected.heights[i], 1e-9);
}

TEST_P(PublishedLayouts, PassTheIndependentCheckWhichFindsTheSameStatistics) {
  const PrintJob job = printed_sample(GetParam().sample);
  const Toolpath path = toolpath(job.weave, job.profile, job.options);
  const ToolpathStatistics& s = path.statistics;
  const GcodeReport report = check_gcode(to_gcode(path, job.profile), limits_of(job.profile, job.weave));
  for (const Violation& v : report.violations)
    ADD_FAILURE() << v.line << ": " << to_string(v.kind) << ": " << v.message;
  EXPECT_EQ(report.violation_count, 0);
  EXPECT_NEAR(report.extruded_length, s.extruded_length, 1e-3 * s.extruded_length);
  EXPECT_NEAR(report.filament, s.filament, 1e-3 * s.filament);
  EXPECT_NEAR(report.minutes, s.minutes, 0.01 * s.minutes);
  EXPECT_NEAR(report.channel_length, s.channel_length, 1e-2 + 1e-3 * s.channel_length);
  EXPECT_EQ(static_cast<int>(report.channels.size()), s.channels);
  EXPECT_EQ(report.travels, s.travels);
  EXPECT_EQ(report.heights.size(), s.heights.size());
  EXPECT_LT((report.lowest - s.lowest).norm() + (report.highest - s.highest).norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Nine, PublishedLayouts, ::testing::ValuesIn(published),
                         [](const auto& layout) { return std::string(to_string(layout.param.sample)); });

/// The published total lengths consist of strands of 80 and 24 beyond each end, and of a frame with a lead-in of 16.
TEST(PublishedLayouts, HaveTheStrandsAndSupportsThatAddUpToTheirLengths) {
  const auto statistics = [](Sample sample) {
    const PrintJob job = printed_sample(sample);
    return toolpath(job.weave, job.profile, job.options).statistics;
  };
  EXPECT_NEAR(statistics(Sample::fused_grid).strand_length, 40 * 128, 1e-6);
  EXPECT_NEAR(statistics(Sample::fused_grid).support_length, 4 * 80 + 16, 1e-6);
  // There are 154 sides of 12 and twice 0.6, and two bars of 20 passes. Here each pass is connected to the next one.
  EXPECT_NEAR(statistics(Sample::squares_1).strand_length, 154 * 13.2, 1e-6);
  EXPECT_NEAR(statistics(Sample::squares_1).support_length, 2 * (20 * 79.2 + 19 * 0.5), 1e-6);
  // There are 20 circles and 10 half circles of radius 8. Circles are printed 1.6 beyond their beginning, and half
  // circles 1.6 beyond both ends.
  const double turn = 2 * std::acos(-1.0) * 8;
  EXPECT_NEAR(statistics(Sample::circles_fused).strand_length, 20 * (turn + 1.6) + 10 * (turn / 2 + 3.2), 2);
}

TEST(PublishedLayouts, TakeMoreFilamentWithRoundBeadsAsThickAsTheStrands) {
  PrintJob job = printed_sample(Sample::fused_grid);
  job.profile.bead_area.reset();
  EXPECT_NEAR(toolpath(job.weave, job.profile, job.options).statistics.filament, 5456 * 0.0816327, 0.1);
}

}  // namespace
}  // namespace supple::weave
