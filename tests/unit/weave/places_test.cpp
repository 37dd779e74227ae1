#include "supple/weave/places.h"

#include <gtest/gtest.h>

#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

/// A strand along x from 0 to 10 that slides at x = 4 through a strand along y, whose lower end lies on it.
Weave tee() {
  Weave weave;
  weave.strands.push_back({StrandCurve({{0, 0}, {10, 0}}, Ends::open), 0.2});
  weave.strands.push_back({StrandCurve({{4, 0}, {4, 6}}, Ends::open), 0.2});
  Crossing crossing;
  crossing.members.resize(2);
  crossing.members[0].strand = 0;
  crossing.members[0].coordinate = 4;
  crossing.members[0].slides = true;
  crossing.members[1].strand = 1;
  weave.crossings = {crossing};
  return weave;
}

TEST(Places, OfACrossingAreOnAStrandThatDoesNotSlide) {
  Weave weave = tee();
  EXPECT_EQ(place_of(weave.crossings[0]).strand, 1);
  EXPECT_EQ(place_of(weave.crossings[0]).coordinate, 0);
  weave.crossings[0].members[1].slides = true;
  EXPECT_EQ(place_of(weave.crossings[0]).strand, 0);
  EXPECT_EQ(place_of(weave.crossings[0]).coordinate, 4);
}

TEST(Places, InABoxAreCrossingsThenEndsThatAreNone) {
  const Weave weave = tee();
  const auto all = places_in(weave, {-1, -1}, {11, 7});
  ASSERT_EQ(all.size(), 4U) << "the end on the crossing is not a second place";
  EXPECT_EQ(all[0].strand, 1);
  EXPECT_EQ(all[0].coordinate, 0);
  EXPECT_EQ(all[1].strand, 0);
  EXPECT_EQ(all[1].coordinate, 0);
  EXPECT_EQ(all[2].coordinate, 10);
  EXPECT_EQ(all[3].strand, 1);
  EXPECT_NEAR(all[3].coordinate, 6, 1e-12);
  EXPECT_EQ(places_in(weave, {9.5, -1}, {11, 7}).size(), 1U);
  EXPECT_EQ(places_in(weave, {4, 0}, {4, 0}).size(), 1U) << "borders of the box belong to it";
  EXPECT_TRUE(places_in(weave, {1, -1}, {3, 7}).empty());
}

TEST(Places, InABoxAreNoneOfLoopsButTheirCrossings) {
  const Weave circles = interlacing_circles_sheet(CircleType::all_fused, 3, 3);
  EXPECT_EQ(places_in(circles, {-1e3, -1e3}, {1e3, 1e3}).size(), circles.crossings.size()) << "loops have no end";
}

}  // namespace
}  // namespace supple::weave
