#include "supple/weave/layout_warnings.h"

#include <gtest/gtest.h>

#include "layouts.h"
#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

TEST(LayoutWarnings, SayNothingOfPatterns) {
  EXPECT_TRUE(layout_warnings(regular_weave(uniform_block(Connection::fused))).empty());
  EXPECT_TRUE(layout_warnings(interlacing_squares(SquareType::all_slide_x)).empty());
  EXPECT_TRUE(layout_warnings(interlacing_circles(CircleType::all_slide)).empty());
  EXPECT_TRUE(layout_warnings(interlacing_squares_sheet(SquareType::all_fused, 2, 2)).empty());
  EXPECT_TRUE(layout_warnings(actuated_rings()).empty());
}

TEST(LayoutWarnings, NameStrandsThatNothingConnectsAndSeparateParts) {
  Weave weave;
  weave.strands = {line({0, 0}, {4, 0}), line({1, -1}, {1, 1}), line({20, 0}, {24, 0}), line({21, -1}, {21, 1}),
                   line({50, 0}, {51, 0})};
  weave.crossings = find_crossings(weave.strands);
  const auto warnings = layout_warnings(weave);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "1 strands have no crossing: nothing connects them; the first is 4.");
  EXPECT_EQ(warnings[1], "The strands with crossings form 2 parts that nothing connects.");
}

TEST(LayoutWarnings, CountPlacesWhereStrandsCrossWithoutACrossing) {
  Weave weave = wavy();
  weave.crossings.erase(weave.crossings.begin() + 1, weave.crossings.begin() + 3);
  const auto warnings = layout_warnings(weave);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0], "Strands cross at 2 places without a crossing; the first is on strand 0.");
}

TEST(LayoutWarnings, NameCrossingsAtSmallAnglesAndCloseTogether) {
  Weave weave;
  weave.strands = {line({0, 0}, {10, 0}), line({0, -0.5}, {10, 0.5}), line({2, -2}, {2, 2}), line({2.3, -2}, {2.3, 2})};
  weave.crossings = find_crossings(weave.strands);
  const auto warnings = layout_warnings(weave);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "1 crossings have strands that meet at less than 0.2 rad; the first is 0.");
  EXPECT_EQ(warnings[1], "3 crossings lie closer to the next one of a strand than its diameter; the first is 1.");
}

}  // namespace
}  // namespace supple::weave
