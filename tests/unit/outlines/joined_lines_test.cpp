#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "outline_measures.h"
#include "supple/base/error.h"
#include "support/expect_error.h"

namespace supple::outlines {
namespace {

using supple::testing::expect_error;
using testing::even_odd_area;
using testing::pi;
using testing::warns_of;

std::string line_entity(double x0, double y0, double x1, double y1, const std::string& layer = "cut",
                        const std::string& more = {}) {
  return "0\nLINE\n8\n" + layer + "\n" + more + "10\n" + std::to_string(x0) + "\n20\n" + std::to_string(y0) + "\n11\n" +
         std::to_string(x1) + "\n21\n" + std::to_string(y1) + "\n";
}

/// The sides of a square of 40 mm in two layers.
std::vector<std::string> sides(const std::string& first = "cut", const std::string& second = "cut",
                               const std::string& more = {}) {
  return {line_entity(0, 0, 40, 0, first, more), line_entity(40, 0, 40, 40, second, more),
          line_entity(40, 40, 0, 40, first, more), line_entity(0, 40, 0, 0, second, more)};
}

std::string circle_of_lines(double radius, int count) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const double a = 2 * pi * k / count, b = 2 * pi * (k + 1) / count;
    text += line_entity(20 + radius * std::cos(a), 20 + radius * std::sin(a), 20 + radius * std::cos(b),
                        20 + radius * std::sin(b));
  }
  return text;
}

std::string all(const std::vector<std::string>& entities) {
  std::string text;
  for (const std::string& entity : entities) text += entity;
  return text;
}

Drawing read_model(const std::string& entities, double tolerance = 0.05) {
  DrawingOptions options;
  options.tolerance = tolerance;
  return read_drawing("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities +
                          "0\nENDSEC\n0\nEOF\n",
                      options);
}

TEST(JoinedLines, DoubledOnesCountOnce) {
  std::string doubled;
  for (const std::string& side : sides()) doubled += side + side;
  const Drawing drawing = read_model(doubled);
  ASSERT_EQ(drawing.outlines.size(), 1U);
  EXPECT_NEAR(even_odd_area(drawing), 1600, 1e-9);
  EXPECT_EQ(drawing.open_curves, 0U);
  EXPECT_TRUE(warns_of(drawing, "4 lines lie over another one"));
  EXPECT_EQ(drawing.left_out_count, 4U);
  // A side that is drawn again backwards, and a part of a side, count once, too.
  const Drawing backwards = read_model(all(sides()) + line_entity(40, 0, 0, 0) + line_entity(0, 0, 25, 0));
  ASSERT_EQ(backwards.outlines.size(), 1U);
  EXPECT_NEAR(even_odd_area(backwards), 1600, 1e-9);
}

TEST(JoinedLines, StrayOnesAtACornerAreLeftOut) {
  for (const std::string& stray : {line_entity(40, 0, 40, 30), line_entity(40, 0, 55, -5), line_entity(0, 0, 20, 20),
                                   line_entity(40, 0, 50, 0) + line_entity(50, 0, 50, 9)}) {
    for (const bool before : {true, false}) {
      const Drawing drawing = read_model(before ? stray + all(sides()) : all(sides()) + stray);
      ASSERT_EQ(drawing.outlines.size(), 1U) << stray;
      EXPECT_NEAR(even_odd_area(drawing), 1600, 1e-9);
      EXPECT_EQ(drawing.outlines[0].corners.size(), 4U);
      EXPECT_GE(drawing.open_curves, 1U);
      EXPECT_TRUE(warns_of(drawing, "Open curves were left out"));
    }
  }
}

TEST(JoinedLines, ShorterThanTheToleranceCloseToHoles) {
  const double square = 1600;
  for (const auto& [radius, count] : {std::pair(0.04, 12), std::pair(1.0, 360), std::pair(1.0, 2'000)}) {
    const Drawing drawing = read_model(all(sides()) + circle_of_lines(radius, count));
    SCOPED_TRACE(count);
    ASSERT_EQ(drawing.outlines.size(), 2U);
    const double polygon = count * std::sin(2 * pi / count) / 2 * radius * radius;
    const double within = count > 1'000 ? 2 * pi * radius * 0.05 : 1e-4;
    EXPECT_NEAR(even_odd_area(drawing), square - polygon, within);
    EXPECT_EQ(drawing.open_curves, 0U);
  }
}

TEST(JoinedLines, CloseOverSeveralLayersAndGaps) {
  const Drawing layers = read_model(all(sides("cut", "edge")));
  ASSERT_EQ(layers.outlines.size(), 1U);
  EXPECT_NEAR(even_odd_area(layers), 1600, 1e-9);
  EXPECT_TRUE(warns_of(layers, "several layers"));
  // The same outline on two layers counts once.
  const Drawing twice = read_model(all(sides()) + all(sides("edge", "edge")));
  ASSERT_EQ(twice.outlines.size(), 1U);
  EXPECT_TRUE(warns_of(twice, "1 polygon lies over another one"));
  // The gaps are within the tolerance, and a stray line begins at one of them.
  const Drawing gaps = read_model(line_entity(0.02, 0, 40, 0) + line_entity(40, 0.03, 40, 40) +
                                  line_entity(40, 40, 0, 40.01) + line_entity(0, 40, 0, 0) + line_entity(40, 0, 60, 0));
  ASSERT_EQ(gaps.outlines.size(), 1U);
  EXPECT_NEAR(even_odd_area(gaps), 1600, 2);
}

TEST(JoinedLines, ThatBranchBoundEachAreaBetweenThem) {
  const Drawing divided = read_model(all(sides()).append(line_entity(0, 0, 40, 40)));
  EXPECT_EQ(divided.outlines.size(), 2U);
  EXPECT_NEAR(even_odd_area(divided), 1600, 1e-9);
  EXPECT_TRUE(warns_of(divided, "More than two curves meet at"));
  // These two squares touch in a corner.
  const Drawing touching = read_model(all(sides()) + line_entity(40, 40, 60, 40) + line_entity(60, 40, 60, 60) +
                                      line_entity(60, 60, 40, 60) + line_entity(40, 60, 40, 40));
  EXPECT_EQ(touching.outlines.size(), 2U);
  EXPECT_NEAR(even_odd_area(touching), 2000, 1e-9);
}

TEST(JoinedLines, OfPaperSpaceAreToldWhereNothingElseIs) {
  const Error error = expect_error("outline.nothing_closed", [] { read_model(all(sides("cut", "cut", "67\n1\n"))); });
  EXPECT_NE(std::string(error.what()).find("4 LINE of paper space left out"), std::string::npos) << error.what();
}

TEST(JoinedLines, NamesOfLayersMayHaveAnyCharacter) {
  const Drawing drawing = read_model(all(sides("Au\\U+00DFen \\U+4E2D", "Au\\U+00DFen \\U+4E2D")));
  EXPECT_EQ(drawing.outlines.at(0).names.at(0),
            "Au\xC3\x9F"
            "en \xE4\xB8\xAD");
}

}  // namespace
}  // namespace supple::outlines
