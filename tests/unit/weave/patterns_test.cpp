#include "supple/weave/patterns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "layouts.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

int count_sliding(const Weave& weave) {
  int count = 0;
  for (const Crossing& crossing : weave.crossings)
    for (const CrossingMember& m : crossing.members) count += m.slides ? 1 : 0;
  return count;
}

TEST(Patterns, AreValidAndHaveTheirPublishedNumberOfCrossings) {
  for (int type = 1; type <= 4; ++type) {
    const Weave weave = interlacing_squares(static_cast<SquareType>(type));
    EXPECT_NO_THROW(validate(weave));
    EXPECT_EQ(weave.crossings.size(), 8U + 8U) << "eight corners and eight crossings";
    EXPECT_NEAR((*weave.lattice)(0, 0), 18, 1e-12);
    EXPECT_EQ(count_sliding(weave), type == 1 ? 0 : type == 4 ? 6 : 8);
  }
  const Weave sheet = interlacing_squares_sheet(SquareType::all_slide_x, 5, 5);
  EXPECT_NO_THROW(validate(sheet));
  EXPECT_EQ(sheet.strands.size(), 4U * (25 + 16));
  EXPECT_EQ(sheet.crossings.size(), 4U * 41 + 8U * 16);
  EXPECT_NEAR(sheet.strands[4 * 24 + 1].curve.at(0).position[0], 79.2, 1e-9);
  const Weave circles = interlacing_circles(CircleType::all_slide);
  EXPECT_NO_THROW(validate(circles));
  EXPECT_EQ(circles.crossings.size(), 4U);
  EXPECT_EQ(count_sliding(circles), 4);
  const Weave printed = interlacing_circles_sheet(CircleType::all_fused, 5, 6);
  EXPECT_NO_THROW(validate(printed));
  EXPECT_EQ(printed.crossings.size(), 2U * (4 * 6 + 5 * 5));
  const Weave rings = actuated_rings();
  EXPECT_NO_THROW(validate(rings));
  EXPECT_EQ(rings.crossings.size(), 25U);
  EXPECT_EQ(count_sliding(rings), 6);
  const Weave grid = regular_sheet(20, 20, uniform_block(Connection::slides_y));
  EXPECT_NO_THROW(validate(grid));
  EXPECT_EQ(grid.crossings.size(), 400U);
  EXPECT_EQ(count_sliding(grid), 400);
  EXPECT_EQ(count_sliding(regular_sheet(20, 20, uniform_block(Connection::slides_y), 4.5, 1)), 18 * 18);
}

TEST(Patterns, LimitSquaresToTwoPointOneMillimetresTowardsACornerAndTwiceThatBetweenCrossings) {
  for (const Crossing& crossing : interlacing_squares(SquareType::all_slide_x).crossings) {
    for (const CrossingMember& m : crossing.members) {
      if (!m.slides) continue;
      EXPECT_NEAR(std::min(m.backward, m.forward), 2.1, 1e-9);
      EXPECT_NEAR(std::max(m.backward, m.forward), 4.2, 1e-9);
    }
  }
}

TEST(Patterns, TakeAnotherShareOfTheWayAsALimit) {
  Weave weave = interlacing_squares(SquareType::all_slide_x);
  limit_sliding(weave, 0.35);
  for (const Crossing& crossing : weave.crossings) {
    for (const CrossingMember& m : crossing.members) {
      if (!m.slides) continue;
      EXPECT_NEAR(std::min(m.backward, m.forward), 1.05, 1e-9);
    }
  }
}

TEST(Patterns, RefuseLengthsThatMakeNone) {
  ::supple::testing::expect_error<WeaveError>("weave.invalid_pattern",
                                              [] { interlacing_squares(SquareType::all_fused, 12, 6); });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_pattern",
                                              [] { interlacing_circles(CircleType::all_fused, 5, 11); });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_pattern",
                                              [] { regular_weave(uniform_block(Connection::fused), 0); });
  ::supple::testing::expect_error<WeaveError>("weave.invalid_pattern",
                                              [] { regular_sheet(0, 3, uniform_block(Connection::fused)); });
}

TEST(FindCrossings, MakesOneCrossingOfStrandsThatMeetInOnePoint) {
  const std::vector<Strand> star{line({-1, 0}, {1, 0}), line({0, -1}, {0, 1}), line({-1, -1}, {1, 1})};
  const auto crossings = find_crossings(star);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_EQ(crossings[0].members.size(), 3U);
}

TEST(Validate, NamesEachFaultOfALayout) {
  Weave weave = wavy();
  EXPECT_NO_THROW(validate(weave));
  const auto places_of = [](const Weave& w) {
    return ::supple::testing::places(
        ::supple::testing::expect_error<WeaveError>("weave.invalid_layout", [&] { validate(w); }));
  };
  Weave broken = weave;
  broken.crossings[1].members[0].strand = 9;
  broken.crossings[2].members[1].coordinate = -1;
  EXPECT_EQ(places_of(broken),
            (std::vector<std::string>{"crossings/1/members/0/strand", "crossings/2/members/1/coordinate"}));
  broken = weave;
  broken.crossings[0].members[1].coordinate += 0.1;
  EXPECT_EQ(places_of(broken), std::vector<std::string>{"crossings/0/members/1"});
  broken = weave;
  broken.crossings.push_back(broken.crossings[0]);
  EXPECT_FALSE(places_of(broken).empty());
  broken = weave;
  broken.material.youngs_modulus = 0;
  broken.strands[0].radius = -1;
  EXPECT_EQ(places_of(broken), (std::vector<std::string>{"material/youngs_modulus", "strands/0/radius"}));
}

}  // namespace
}  // namespace supple::weave
