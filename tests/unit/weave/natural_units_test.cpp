#include "natural_units.h"

#include <gtest/gtest.h>

#include "layouts.h"
#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

TEST(NaturalUnits, AreMillimetresAndMegapascalsForThePatternsOfPrintedPla) {
  for (const Weave& weave :
       {regular_weave(uniform_block(Connection::fused)), interlacing_squares(SquareType::all_fused)}) {
    const NaturalWeave natural(weave);
    EXPECT_EQ(natural.units().length, 1);
    EXPECT_EQ(natural.units().modulus, 1);
    EXPECT_EQ(&natural.weave(), &weave) << "nothing is copied";
  }
}

TEST(NaturalUnits, GiveAWeaveTheSameNumbersWhateverItsSizeAndItsModulus) {
  Weave weave = interlacing_squares(SquareType::all_slide_x, 120, 30);
  weave.material.youngs_modulus = 7;
  for (Strand& strand : weave.strands) strand.radius = 2.5;
  const NaturalWeave natural(weave);
  EXPECT_NEAR(natural.units().length, 10, 1e-9);
  EXPECT_NEAR(natural.units().modulus, 0.002, 1e-15);
  EXPECT_NEAR(natural.units().force(), 0.2, 1e-12);
  EXPECT_NEAR(natural.units().energy(), 2, 1e-11);
  const Weave expected = interlacing_squares(SquareType::all_slide_x);
  const Weave& scaled = natural.weave();
  EXPECT_EQ(scaled.material.youngs_modulus, Material{}.youngs_modulus);
  EXPECT_LT((*scaled.lattice - *expected.lattice).norm(), 1e-12);
  for (std::size_t s = 0; s < expected.strands.size(); ++s) {
    EXPECT_NEAR(scaled.strands[s].radius, 0.25, 1e-15);
    EXPECT_NEAR(scaled.strands[s].curve.length(), expected.strands[s].curve.length(), 1e-11);
    for (const double at : {0.0, 1.3, 7.7})
      EXPECT_LT((scaled.strands[s].curve.at(at).position - expected.strands[s].curve.at(at).position).norm(), 1e-11);
  }
  for (std::size_t c = 0; c < expected.crossings.size(); ++c)
    for (std::size_t m = 0; m < expected.crossings[c].members.size(); ++m) {
      const CrossingMember& member = expected.crossings[c].members[m];
      if (member.slides) {
        EXPECT_NEAR(scaled.crossings[c].members[m].forward, member.forward, 1e-12);
      }
    }
}

TEST(NaturalUnits, CountTheRodsOfOpenStrandsAndOfLoops) {
  Weave weave;
  weave.strands.push_back(line({0, 0}, {20, 0}));
  EXPECT_NEAR(natural_units(weave).length, 20 / 4.0, 1e-12) << "nothing crosses it";
  weave.strands.push_back(line({5, 0}, {5, 10}));
  weave.crossings = find_crossings(weave.strands);
  EXPECT_NEAR(natural_units(weave).length, 30 / 3.0 / 4, 1e-12) << "one crosses the other with its end";
}

TEST(NaturalUnits, ScaleCurvesWithAllTheirDerivatives) {
  const StrandCurve curve = circle(3, {1, 2}).curve;
  const StrandCurve scaled = curve.scaled(2.5);
  for (const double s : {0.0, 1.0, 7.5, 18.0}) {
    const auto at = curve.at(s);
    const auto there = scaled.at(2.5 * s);
    EXPECT_LT((there.position - 2.5 * at.position).norm(), 1e-12);
    EXPECT_LT((there.first - at.first).norm(), 1e-12);
    EXPECT_LT((there.second - at.second / 2.5).norm(), 1e-12);
    EXPECT_LT((there.third - at.third / 6.25).norm(), 1e-11);
  }
}

}  // namespace
}  // namespace supple::weave
