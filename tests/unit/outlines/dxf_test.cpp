#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

#include "outline_measures.h"
#include "supple/base/error.h"
#include "support/expect_error.h"

namespace supple::outlines {
namespace {

using supple::testing::expect_error;
using testing::area;
using testing::off_circle;
using testing::pi;
using testing::warns_of;

using Groups = std::initializer_list<std::pair<int, const char*>>;

std::string pairs(Groups groups) {
  std::string text;
  for (const auto& [code, value] : groups) text += std::to_string(code) + "\n" + value + "\n";
  return text;
}

/// A drawing whose unit is a millimetre.
std::string drawing_of(const std::string& entities, const char* unit = "4", const std::string& tables = {}) {
  return pairs({{999, "a comment"}, {0, "SECTION"}, {2, "HEADER"}, {9, "$INSUNITS"}, {70, unit}, {0, "ENDSEC"}}) +
         tables + pairs({{0, "SECTION"}, {2, "ENTITIES"}}) + entities + pairs({{0, "ENDSEC"}, {0, "EOF"}});
}

Drawing read_entities(const std::string& entities, double tolerance = 0.001) {
  DrawingOptions options;
  options.tolerance = tolerance;
  return read_drawing(drawing_of(entities), options);
}

const std::string square = pairs({{0, "LWPOLYLINE"},
                                  {8, "cut"},
                                  {90, "4"},
                                  {70, "1"},
                                  {10, "0"},
                                  {20, "0"},
                                  {10, "10"},
                                  {20, "0"},
                                  {10, "10"},
                                  {20, "10"},
                                  {10, "0"},
                                  {20, "10"}});

TEST(Dxf, PolylinesHaveTheirBulges) {
  const Drawing drawing = read_entities(square);
  ASSERT_EQ(drawing.outlines.size(), 1U);
  EXPECT_EQ(drawing.format, DrawingFormat::dxf);
  EXPECT_EQ(drawing.outlines[0].corners.size(), 4U);
  EXPECT_NEAR(area(drawing.outlines[0]), 100, 1e-12);
  EXPECT_EQ(drawing.outlines[0].names, std::vector<std::string>{"cut"});
  // A bulge of 1 is a half circle, which is counterclockwise and lies to the right of its side.
  const auto with_bulge = [](const char* bulge) {
    return area(read_entities(pairs({{0, "LWPOLYLINE"},
                                     {70, "1"},
                                     {10, "0"},
                                     {20, "0"},
                                     {42, bulge},
                                     {10, "10"},
                                     {20, "0"},
                                     {10, "10"},
                                     {20, "10"},
                                     {10, "0"},
                                     {20, "10"}}))
                    .outlines.at(0));
  };
  EXPECT_NEAR(with_bulge("1"), 100 + 25 * pi / 2, 0.02);
  EXPECT_NEAR(with_bulge("-1"), 100 - 25 * pi / 2, 0.02);
  EXPECT_NEAR(with_bulge("0.41421356237309503"), 100 + 50 * (pi / 2 - 1) / 2, 0.02) << "a quarter of a circle";
  // Two half circles are a circle.
  const Drawing circle = read_entities(
      pairs({{0, "LWPOLYLINE"}, {70, "1"}, {10, "5"}, {20, "3"}, {42, "1"}, {10, "9"}, {20, "3"}, {42, "1"}}));
  EXPECT_LT(off_circle(circle.outlines.at(0), {7, 3}, 2), 1e-9);
}

TEST(Dxf, OldPolylinesHaveVerticesOfTheirOwn) {
  const Drawing drawing = read_entities(pairs({{0, "POLYLINE"},
                                               {8, "old"},
                                               {66, "1"},
                                               {70, "1"},
                                               {0, "VERTEX"},
                                               {10, "0"},
                                               {20, "0"},
                                               {0, "VERTEX"},
                                               {10, "8"},
                                               {20, "0"},
                                               {42, "1"},
                                               {0, "VERTEX"},
                                               {10, "8"},
                                               {20, "6"},
                                               {0, "SEQEND"}}) +
                                        square);
  ASSERT_EQ(drawing.outlines.size(), 2U);
  EXPECT_NEAR(area(drawing.outlines[0]), 24 + 9 * pi / 2, 0.02);
  EXPECT_EQ(drawing.outlines[0].names, std::vector<std::string>{"old"});
}

TEST(Dxf, LinesAndArcsOfOneLayerCloseInAnyOrder) {
  // A slot: two lines and two half circles, one of which runs against the others.
  const std::string slot =
      pairs({{0, "LINE"}, {8, "slot"}, {10, "0"},  {20, "0"},   {11, "20"}, {21, "0"},   {0, "ARC"},
             {8, "slot"}, {10, "0"},   {20, "5"},  {40, "5"},   {50, "90"}, {51, "270"}, {0, "LINE"},
             {8, "slot"}, {10, "20"},  {20, "10"}, {11, "0"},   {21, "10"}, {0, "ARC"},  {8, "slot"},
             {10, "20"},  {20, "5"},   {40, "5"},  {50, "270"}, {51, "90"}});
  const Drawing drawing = read_entities(slot);
  ASSERT_EQ(drawing.outlines.size(), 1U);
  EXPECT_NEAR(std::abs(area(drawing.outlines[0])), 200 + 25 * pi, 0.05);
  EXPECT_EQ(drawing.joined, 4U);
  // On two layers they close as well, with a warning.
  std::string apart = slot;
  apart.replace(apart.find("slot"), 4, "dash");
  const Drawing layers = read_entities(apart);
  ASSERT_EQ(layers.outlines.size(), 1U);
  EXPECT_NEAR(std::abs(area(layers.outlines[0])), 200 + 25 * pi, 0.05);
  EXPECT_TRUE(warns_of(layers, "several layers"));
  // Without one of them they stay open.
  const std::string open = slot.substr(slot.find("0\nARC"));
  const auto error = expect_error("outline.nothing_closed", [&] { read_entities(open); });
  EXPECT_NE(std::string(error.what()).find("(layer \"slot\") ends"), std::string::npos) << error.what();
}

TEST(Dxf, CirclesEllipsesAndTheirParts) {
  const Drawing circle = read_entities(pairs({{0, "CIRCLE"}, {10, "3"}, {20, "4"}, {40, "2"}}));
  EXPECT_LT(off_circle(circle.outlines.at(0), {3, 4}, 2), 1e-9);
  const Groups ellipse = {{0, "ELLIPSE"}, {10, "0"},   {20, "0"}, {11, "0"},
                          {21, "6"},      {40, "0.5"}, {41, "0"}, {42, "6.283185307179586"}};
  EXPECT_NEAR(area(read_entities(pairs(ellipse)).outlines.at(0)), 18 * pi, 0.05);
  // Half an ellipse lies to the left of its longer axis. If its normal points down, it lies to the right.
  const auto half = [](const char* normal) {
    return read_entities(pairs({{0, "ELLIPSE"},
                                {10, "0"},
                                {20, "0"},
                                {11, "6"},
                                {21, "0"},
                                {40, "0.5"},
                                {41, "0"},
                                {42, "3.141592653589793"},
                                {230, normal},
                                {0, "LINE"},
                                {10, "-6"},
                                {20, "0"},
                                {11, "6"},
                                {21, "0"}}));
  };
  EXPECT_NEAR(half("1").upper.y() - half("1").lower.y(), 3, 1e-3);
  EXPECT_GT(area(half("1").outlines.at(0)), 0);
  EXPECT_LT(area(half("-1").outlines.at(0)), 0);
}

TEST(Dxf, SplinesAreRationalCurves) {
  // A full circle as nine control points of degree 2.
  const double w = std::sqrt(0.5);
  const double points[9][2] = {{5, 0}, {5, 5}, {0, 5}, {-5, 5}, {-5, 0}, {-5, -5}, {0, -5}, {5, -5}, {5, 0}};
  std::string spline = pairs({{0, "SPLINE"}, {8, "ring"}, {70, "1"}, {71, "2"}, {72, "12"}, {73, "9"}});
  for (const char* knot : {"0", "0", "0", "1", "1", "2", "2", "3", "3", "4", "4", "4"}) spline += pairs({{40, knot}});
  for (int k = 0; k < 9; ++k) spline += pairs({{41, std::to_string(k % 2 == 0 ? 1 : w).c_str()}});
  for (const auto& p : points)
    spline += pairs({{10, std::to_string(p[0]).c_str()}, {20, std::to_string(p[1]).c_str()}});
  for (const double tolerance : {0.1, 0.001}) {
    const Drawing drawing = read_entities(spline, tolerance);
    ASSERT_EQ(drawing.outlines.size(), 1U);
    EXPECT_LT(off_circle(drawing.outlines[0], {0, 0}, 5), 1e-4) << "weights were written with six digits";
    EXPECT_NEAR(area(drawing.outlines[0]), 25 * pi, 35 * tolerance);
    EXPECT_LE(drawing.chord_error, tolerance);
  }
  EXPECT_GT(read_entities(spline, 0.0001).outlines.at(0).corners.size(),
            2 * read_entities(spline, 0.01).outlines.at(0).corners.size());
}

TEST(Dxf, UnitsAreThoseOfTheFileOrTheRequest) {
  const auto width = [](const char* unit, LengthUnit asked = LengthUnit::automatic) {
    DrawingOptions options;
    options.unit = asked;
    return read_drawing(drawing_of(square, unit), options);
  };
  EXPECT_NEAR(width("4").upper.x(), 10, 1e-12);
  EXPECT_NEAR(width("1").upper.x(), 254, 1e-12);
  EXPECT_NEAR(width("5").upper.x(), 100, 1e-12);
  EXPECT_NEAR(width("1", LengthUnit::cm).upper.x(), 100, 1e-12);
  EXPECT_NEAR(width("0").upper.x(), 10, 1e-12);
  EXPECT_FALSE(width("0").unit_is_known);
  EXPECT_TRUE(warns_of(width("0"), "taken as 1 mm"));
  EXPECT_TRUE(width("0", LengthUnit::in).unit_is_known);
}

TEST(Dxf, HiddenLayersSheetsAndAnnotationsAreLeftOut) {
  const std::string tables = pairs({{0, "SECTION"},
                                    {2, "TABLES"},
                                    {0, "LAYER"},
                                    {2, "off"},
                                    {70, "0"},
                                    {62, "-7"},
                                    {0, "LAYER"},
                                    {2, "frozen"},
                                    {70, "1"},
                                    {62, "7"},
                                    {0, "LAYER"},
                                    {2, "shown"},
                                    {70, "0"},
                                    {62, "7"},
                                    {0, "ENDSEC"}});
  const auto circle = [](const char* layer, int more, const char* value) {
    return pairs({{0, "CIRCLE"}, {8, layer}, {10, "0"}, {20, "0"}, {40, "2"}, {more, value}});
  };
  const std::string entities = circle("off", 39, "0") + circle("frozen", 39, "0") + circle("shown", 60, "1") +
                               circle("shown", 67, "1") + square +
                               pairs({{0, "TEXT"}, {1, "words"}, {0, "INSERT"}, {2, "bolt"}, {0, "SPLINE"}, {74, "3"}});
  const Drawing drawing = read_drawing(drawing_of(entities, "4", tables));
  EXPECT_EQ(drawing.outlines.size(), 1U);
  EXPECT_TRUE(warns_of(drawing, "3 hidden elements"));
  EXPECT_TRUE(warns_of(drawing, "1 INSERT of no block of the file left out"));
  EXPECT_TRUE(warns_of(drawing, "1 SPLINE without control points"));
  EXPECT_FALSE(warns_of(drawing, "TEXT"));
  EXPECT_TRUE(warns_of(drawing, "1 CIRCLE of paper space left out"));
  EXPECT_EQ(drawing.left_out_count, 6U);
  EXPECT_EQ(drawing.left_out[0].reason, "its layer is off or frozen");
}

/// A section of blocks: "dot", a circle of radius 1 at (3, 2) with the base (1, 2), and "pair", two dots, the second of
/// which lies 10 to the right of the first.
std::string blocks() {
  return pairs({{0, "SECTION"}, {2, "BLOCKS"}, {0, "BLOCK"},  {2, "pair"},   {0, "INSERT"}, {2, "dot"},
                {0, "INSERT"},  {2, "dot"},    {10, "10"},    {0, "ENDBLK"}, {0, "BLOCK"},  {2, "dot"},
                {10, "1"},      {20, "2"},     {0, "CIRCLE"}, {8, "0"},      {10, "3"},     {20, "2"},
                {40, "1"},      {0, "ENDBLK"}, {0, "ENDSEC"}});
}

Drawing read_inserts(const std::string& inserts, const char* unit = "4") {
  DrawingOptions options;
  options.tolerance = 1e-4;
  // With the square, the bounding box begins at the origin, so that the drawing is not moved.
  return read_drawing(drawing_of(square + inserts, unit, blocks()), options);
}

/// The centre of an outline's bounding box, and half of its size.
std::pair<Eigen::Vector2d, Eigen::Vector2d> box_of(const Outline& outline) {
  Eigen::Vector2d lower = outline.corners[0], upper = lower;
  for (const Eigen::Vector2d& p : outline.corners) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return {(lower + upper) / 2, (upper - lower) / 2};
}

TEST(Dxf, BlocksAreDrawnWhereTheyAreInserted) {
  const Drawing drawing = read_inserts(
      pairs({{0, "INSERT"}, {8, "cut"}, {2, "dot"}, {10, "10"}, {20, "20"}, {41, "2"}, {42, "3"}, {50, "90"}}));
  ASSERT_EQ(drawing.outlines.size(), 2U);
  // The centre lies 2 to the right of the base: 4 after scaling, and upwards after a quarter of a turn.
  const auto [middle, half] = box_of(drawing.outlines[1]);
  EXPECT_LT((middle - Eigen::Vector2d(10, 24)).norm(), 1e-3);
  EXPECT_LT((half - Eigen::Vector2d(3, 2)).norm(), 1e-3);
  EXPECT_NEAR(area(drawing.outlines[1]), 6 * pi, 1e-2);
  EXPECT_EQ(drawing.outlines[1].names, (std::vector<std::string>{"cut", "dot"}));
  EXPECT_NEAR(read_inserts(pairs({{0, "INSERT"}, {2, "dot"}}), "5").upper.x(), 100, 1e-9) << "in centimetres";
}

TEST(Dxf, BlocksWithinBlocksInRowsAndColumns) {
  const Drawing drawing = read_inserts(pairs({{0, "INSERT"},
                                              {8, "cut"},
                                              {2, "pair"},
                                              {10, "50"},
                                              {20, "20"},
                                              {41, "-1"},
                                              {70, "3"},
                                              {71, "2"},
                                              {44, "100"},
                                              {45, "40"}}));
  ASSERT_EQ(drawing.outlines.size(), 13U);
  std::size_t next = 1;
  for (const double y : {20, 60}) {
    for (const double x : {50, 150, 250}) {
      for (const double along : {2, 12}) {  // mirrored, so that the circles lie to the left
        const auto [middle, half] = box_of(drawing.outlines[next]);
        EXPECT_LT((middle - Eigen::Vector2d(x - along, y)).norm(), 1e-3) << next;
        EXPECT_LT((half - Eigen::Vector2d(1, 1)).norm(), 1e-3);
        EXPECT_LT(area(drawing.outlines[next]), 0) << "a mirrored circle runs the other way";
        EXPECT_EQ(drawing.outlines[next].names, (std::vector<std::string>{"cut", "dot", "pair"}));
        ++next;
      }
    }
  }
}

TEST(Dxf, InsertsSeenFromBehindAndWhatIsNoBlock) {
  const Drawing drawing = read_inserts(pairs({{0, "INSERT"},
                                              {2, "dot"},
                                              {10, "-40"},
                                              {20, "20"},
                                              {230, "-1"},
                                              {0, "INSERT"},
                                              {2, "dot"},
                                              {210, "0.6"},
                                              {230, "0.8"},
                                              {0, "INSERT"},
                                              {2, "*D1"}}));
  ASSERT_EQ(drawing.outlines.size(), 2U);
  EXPECT_LT((box_of(drawing.outlines[1]).first - Eigen::Vector2d(38, 20)).norm(), 1e-3);
  EXPECT_TRUE(warns_of(drawing, "1 tilted INSERT"));
  EXPECT_TRUE(warns_of(drawing, "1 INSERT of no block of the file"));
}

TEST(Dxf, WhatIsOnTheLayerOfAnInsertIsHiddenWithIt) {
  const std::string tables =
      pairs({{0, "SECTION"}, {2, "TABLES"}, {0, "LAYER"}, {2, "off"}, {62, "-7"}, {0, "ENDSEC"}}) + blocks();
  const auto outlines = [&](const char* layer) {
    const Drawing drawing =
        read_drawing(drawing_of(square + pairs({{0, "INSERT"}, {8, layer}, {2, "dot"}}), "4", tables));
    return drawing.outlines.size();
  };
  EXPECT_EQ(outlines("off"), 1U);
  EXPECT_EQ(outlines("on"), 2U);
}

TEST(Dxf, CurvesSeenFromBehindAreMirroredAndTiltedOnesTold) {
  const auto with_normal = [](const char* x, const char* z) {
    return read_entities(pairs({{0, "LWPOLYLINE"},
                                {210, x},
                                {220, "0"},
                                {230, z},
                                {70, "1"},
                                {10, "0"},
                                {20, "0"},
                                {10, "10"},
                                {20, "0"},
                                {10, "0"},
                                {20, "5"}}) +
                         square);
  };
  EXPECT_GT(area(with_normal("0", "1").outlines.at(0)), 0);
  const Drawing mirrored = with_normal("0", "-1");
  EXPECT_LT(area(mirrored.outlines.at(0)), 0);
  EXPECT_NEAR(mirrored.lower.x(), -10, 1e-12) << "it lies on the other side of the y axis";
  EXPECT_TRUE(warns_of(with_normal("0.6", "0.8"), "1 tilted LWPOLYLINE"));
}

TEST(Dxf, DrawingsFarAwayAreMoved) {
  const Drawing drawing = read_entities(pairs({{0, "CIRCLE"}, {10, "500000"}, {20, "-4000000"}, {40, "20"}}));
  EXPECT_EQ(drawing.lower, Eigen::Vector2d(0, 0));
  EXPECT_NEAR(drawing.upper.x(), 40, 0.01);
  EXPECT_TRUE(warns_of(drawing, "farther than 2000 mm"));
}

TEST(Dxf, NamesTheLineThatCannotBeRead) {
  const auto message = [](const std::string& text) {
    return std::string(expect_error("outline.unreadable", [&] { read_drawing(text); }).what());
  };
  const auto expect_words = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  expect_words(message("solid words"), "line 1: \"solid words\" is no group code");
  expect_words(message(pairs({{0, "SECTION"}, {2, "HEADER"}, {0, "ENDSEC"}, {0, "EOF"}})), "no section ENTITIES");
  expect_words(message("AutoCAD Binary DXF\r\n\x1a"), "binary DXF");
  expect_words(message(drawing_of(pairs({{0, "CIRCLE"}, {10, "1,5"}, {20, "0"}, {40, "2"}}))),
               "line 20: \"1,5\" is no number");
  expect_words(message(drawing_of(pairs({{0, "CIRCLE"}, {10, "1"}, {20, "0"}}))),
               "the CIRCLE of line 18 has no group 40");
  expect_words(message(drawing_of(pairs({{0, "CIRCLE"}, {10, "1"}, {20, "0"}, {40, "-2"}}))),
               "radius must be positive");
  expect_words(message(drawing_of(pairs({{0, "ELLIPSE"}, {10, "1"}, {20, "0"}, {11, "0"}, {21, "0"}, {40, "1"}}))),
               "axes must be positive");
  expect_words(message(drawing_of(pairs({{0, "SPLINE"}, {71, "3"}, {40, "0"}, {10, "0"}, {20, "0"}}))),
               "a spline of degree d");
  expect_words(message(drawing_of(pairs({{0, "LINE"}, {10, "1e300"}, {20, "0"}, {11, "0"}, {21, "0"}}))),
               "beyond 10000 m");
  expect_words(message("0\nSECTION\n2"), "ends after a group code");
}

TEST(Dxf, LineEndsAndBlanksDoNotMatter) {
  std::string text = drawing_of(square);
  std::string windows;
  for (const char c : text) windows += c == '\n' ? " \r\n" : std::string(1, c);
  EXPECT_EQ(read_drawing("\xEF\xBB\xBF" + windows + "\r\n\r\n").outlines.at(0).corners,
            read_drawing(text).outlines.at(0).corners);
}

}  // namespace
}  // namespace supple::outlines
