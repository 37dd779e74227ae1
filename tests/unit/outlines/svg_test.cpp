#include <gtest/gtest.h>

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
using Corners = std::vector<Eigen::Vector2d>;

/// A page of 100 x 80 mm, whose unit is a millimetre.
std::string page(const std::string& content) {
  return R"svg(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">)svg" +
         content + "</svg>";
}

std::string path(const std::string& data) { return page("<path id=\"p\" d=\"" + data + "\"/>"); }

Drawing read(const std::string& text, double tolerance = 0.01) {
  DrawingOptions options;
  options.tolerance = tolerance;
  return read_drawing(text, options);
}

void expect_corners(const std::string& text, const Corners& expected) {
  const Drawing drawing = read(text);
  ASSERT_EQ(drawing.outlines.size(), 1U);
  const Corners& corners = drawing.outlines[0].corners;
  ASSERT_EQ(corners.size(), expected.size()) << text;
  for (std::size_t k = 0; k < corners.size(); ++k)
    EXPECT_LT((corners[k] - expected[k]).norm(), 1e-9) << text << " at corner " << k;
}

TEST(Svg, LinesOfPathsAreThatOfTheirCommands) {
  // y points upwards from the lower edge of the page.
  const Corners square{{10, 70}, {30, 70}, {30, 50}, {10, 50}};
  expect_corners(path("M10 10 L30 10 L30 30 L10 30 Z"), square);
  expect_corners(path("M10,10 30,10,30,30 10 30z"), square);
  expect_corners(path("m10 10h20v20H10z"), square);
  expect_corners(path("M10 10H30V30h-20V10"), square);
  expect_corners(path("m1e1,1.0e+1 20-0 0+20-20 0z"), square);
  expect_corners(page(R"svg(<polygon points="10,10 30,10 30,30 10,30"/>)svg"), square);
  expect_corners(page(R"svg(<polyline points="10,10 30,10 30,30 10,30 10,10"/>)svg"), square);
  expect_corners(page(R"svg(<rect x="10" y="10" width="20" height="20"/>)svg"), square);
  expect_corners(page(R"svg(<rect x="1cm" y="10mm" width="20" height="56.692913385826771pt"/>)svg"),
                 {{37.795275590551178, 42.204724409448822},
                  {57.795275590551178, 42.204724409448822},
                  {57.795275590551178, -33.385826771653544},
                  {37.795275590551178, -33.385826771653544}});
}

TEST(Svg, AnElementHasAThousandAttributesAtMost) {
  const auto rectangle = [](int attributes) {
    std::string text = R"svg(<rect id="r")svg";
    for (int k = 5; k < attributes; ++k) text += " a" + std::to_string(k) + "=\"\"";
    return text + R"svg( x="10" y="10" width="20" height="20"/>)svg";
  };
  EXPECT_EQ(read(page(rectangle(1000))).outlines.size(), 1U);
  const std::string use = R"svg(<use href="#r"/>)svg";
  for (const std::string& text : {rectangle(1001), "<defs>" + rectangle(1001) + "</defs>" + use,
                                  "<symbol id=\"s\">" + rectangle(1001) + "</symbol>" + R"svg(<use href="#s"/>)svg"})
    expect_error("outline.too_large", [&] { read(page(text)); });
}

TEST(Svg, SubpathsAreCurvesOfTheirOwn) {
  const Drawing drawing =
      read(page(R"svg(<path id="p" fill="none" stroke="#000" d="M0 0h20v20h-20z m5 5h5v5h-5z l0-3h-3z"/>)svg"));
  ASSERT_EQ(drawing.outlines.size(), 3U);
  EXPECT_NEAR(std::abs(area(drawing.outlines[0])), 400, 1e-9);
  EXPECT_NEAR(std::abs(area(drawing.outlines[1])), 25, 1e-9);
  EXPECT_LT((drawing.outlines[1].corners[0] - Eigen::Vector2d(5, 75)).norm(), 1e-9) << "relative to where Z went back";
  EXPECT_NEAR(std::abs(area(drawing.outlines[2])), 4.5, 1e-9);
  EXPECT_EQ(drawing.outlines[2].names.at(0), "p");
}

TEST(Svg, CurvesStayWithinTheToleranceAndFewerCornersGiveUpNoMore) {
  for (const double tolerance : {1.0, 0.1, 0.01, 0.001}) {
    SCOPED_TRACE(tolerance);
    // A circle is drawn as a circle, as two arcs, and as an ellipse that is rotated.
    const Drawing drawing = read(page(R"svg(<circle cx="50" cy="40" r="20"/>
      <path d="M20 10 A5 5 0 0 1 30 10 A5 5 0 0 1 20 10"/><ellipse rx="7" ry="7" transform="translate(80 60) rotate(30)"/>)svg"),
                                 tolerance);
    ASSERT_EQ(drawing.outlines.size(), 3U);
    EXPECT_LT(off_circle(drawing.outlines[0], {50, 40}, 20), 1e-9);
    EXPECT_LT(off_circle(drawing.outlines[1], {25, 70}, 5), 1e-9);
    EXPECT_LT(off_circle(drawing.outlines[2], {80, 20}, 7), 1e-9);
    EXPECT_LE(drawing.chord_error, tolerance);
    double most = 0;
    const auto& corners = drawing.outlines[0].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d middle = (corners[k] + corners[(k + 1) % corners.size()]) / 2;
      most = std::max(most, 20 - (middle - Eigen::Vector2d(50, 40)).norm());
    }
    EXPECT_LE(most, tolerance);
    EXPECT_GE(most, tolerance / 8) << "no more corners than the tolerance asks for";
  }
}

TEST(Svg, BezierCurvesHaveTheAreaOfTheirFormula) {
  // Integration gives the areas: a cubic curve whose control points are corners of a rectangle encloses three fifths of
  // it, and a quadratic curve two thirds of the triangle of its control points.
  const auto area_of = [](const char* data) { return std::abs(area(read(path(data), 1e-4).outlines.at(0))); };
  EXPECT_NEAR(area_of("M10 10 C10 20 40 20 40 10 Z"), 0.6 * 30 * 10, 1e-2);
  EXPECT_NEAR(area_of("M10 10 Q25 30 40 10 Z"), 2.0 / 3 * (30 * 20 / 2), 1e-2);
  EXPECT_NEAR(area_of("M10 10 q15 20 30 0 z"), 200, 1e-2);
  // A quadratic curve is a cubic curve whose control points lie at two thirds of the sides of its triangle.
  EXPECT_NEAR(area_of("M10 10 C20 23.333333333 30 23.333333333 40 10 Z"), 200, 1e-2);
  // S and T mirror the control point before.
  EXPECT_NEAR(area_of("M10 40 Q20 60 30 40 T50 40 L50 10 L10 10 Z"),
              area_of("M10 40 Q20 60 30 40 Q40 20 50 40 L50 10 L10 10 Z"), 1e-9);
  EXPECT_NEAR(area_of("M10 40 c0 10 20 10 20 0 s20 -10 20 0 V10 H10 Z"),
              area_of("M10 40 C10 50 30 50 30 40 C30 30 50 30 50 40 V10 H10 Z"), 1e-9);
}

TEST(Svg, ArcsFollowTheirFlags) {
  // Two of the four arcs of radius 10 between two points at distance 10 are small, and two are large.
  const double small = 10 * 10 * (pi / 3 - std::sin(pi / 3)) / 2, whole = 100 * pi;
  const auto area_of = [](const char* flags) {
    return area(read(path(std::string("M40 40 A10 10 0 ") + flags + " 50 40 Z"), 1e-4).outlines.at(0));
  };
  EXPECT_NEAR(area_of("0 1"), -small, 0.01) << "sweeps clockwise as it is seen";
  EXPECT_NEAR(area_of("0 0"), small, 0.01);
  EXPECT_NEAR(area_of("1 1"), -(whole - small), 0.02);
  EXPECT_NEAR(area_of("1 0"), whole - small, 0.02);
  EXPECT_NEAR(area_of("01"), -small, 0.01) << "flags need no blanks";
  // Radii that are too small for the chord are enlarged; an arc with a radius of 0 is a straight line.
  EXPECT_NEAR(std::abs(area(read(path("M40 40a1 1 0 0 1 10 0z"), 1e-4).outlines.at(0))), 25 * pi / 2, 0.01);
  EXPECT_EQ(read(path("M40 40A0 5 0 0 1 50 40L50 50Z")).outlines.at(0).corners.size(), 3U);
  // Half of an ellipse whose longer axis is rotated to y.
  EXPECT_NEAR(std::abs(area(read(path("M40 30A10 5 90 0 1 40 50z"), 1e-4).outlines.at(0))), 50 * pi / 2, 0.01);
}

TEST(Svg, RoundedRectanglesHaveTheirCorners) {
  const Drawing drawing =
      read(page(R"svg(<rect id="r" x="10" y="10" width="30" height="20" rx="4" ry="6"/>)svg"), 1e-4);
  EXPECT_NEAR(std::abs(area(drawing.outlines.at(0))), 600 - (4 - pi) * 24, 0.01);
  EXPECT_NEAR((drawing.lower - Eigen::Vector2d(10, 50)).norm(), 0, 1e-9);
  EXPECT_NEAR((drawing.upper - Eigen::Vector2d(40, 70)).norm(), 0, 1e-9);
  // A single radius applies to both axes, and neither radius exceeds half a side.
  EXPECT_NEAR(std::abs(area(read(page(R"svg(<rect width="30" height="20" ry="3"/>)svg"), 1e-4).outlines.at(0))),
              600 - (4 - pi) * 9, 0.01);
  EXPECT_NEAR(std::abs(area(read(page(R"svg(<rect width="20" height="20" rx="99"/>)svg"), 1e-4).outlines.at(0))),
              100 * pi, 0.01);
}

TEST(Svg, TransformsAreAppliedFromInside) {
  expect_corners(page(R"svg(<g transform="translate(10,20)"><g transform="scale(2)">
    <polygon points="0,0 10,0 10,5"/></g></g>)svg"),
                 {{10, 60}, {30, 60}, {30, 50}});
  expect_corners(page(R"svg(<polygon transform="rotate(90 10 10)" points="10,10 20,10 20,15"/>)svg"),
                 {{10, 70}, {10, 60}, {5, 60}});
  expect_corners(page(R"svg(<polygon transform="matrix(1 0 0.5 1 3 4) , skewX(0)" points="0,0 10,0 10,10"/>)svg"),
                 {{3, 76}, {13, 76}, {18, 66}});
  expect_corners(page(R"svg(<polygon transform="skewY(45)" points="0,0 10,0 10,10"/>)svg"),
                 {{0, 80}, {10, 70}, {10, 60}});
  const Drawing drawing = read(page(R"svg(<circle r="10" transform="translate(50 40) scale(2 1)"/>)svg"), 1e-4);
  EXPECT_NEAR(std::abs(area(drawing.outlines.at(0))), 200 * pi, 0.05);
}

TEST(Svg, SizesAreThoseOfThePage) {
  const auto width_of = [](const std::string& root, LengthUnit unit = LengthUnit::automatic) {
    DrawingOptions options;
    options.unit = unit;
    return read_drawing("<svg " + root + "><rect x='96' y='96' width='96' height='48'/></svg>", options);
  };
  const auto width = [&](const std::string& root) {
    const auto d = width_of(root);
    return d.upper.x() - d.lower.x();
  };
  EXPECT_NEAR(width(""), 25.4, 1e-9) << "96 pixels are an inch";
  EXPECT_NEAR(width("width='192px' height='192'"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='10cm' height='10cm' viewBox='0 0 200 200'"), 48, 1e-9);
  EXPECT_NEAR(width("width='2in' height='2in' viewBox='0 0 192 192'"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='144pt' viewBox='0 0 192 192'"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='100%' height='100%' viewBox='0 0 192 192'"), 25.4, 1e-9);
  // A view box of another aspect ratio is centred on the page.
  const Drawing wide = width_of("width='400mm' height='192mm' viewBox='0 0 192 192'");
  EXPECT_NEAR(wide.lower.x(), 104 + 96, 1e-9);
  EXPECT_NEAR(wide.lower.y(), 48, 1e-9);
  const Drawing stretched = width_of("width='384mm' height='192mm' viewBox='0 0 192 192' preserveAspectRatio='none'");
  EXPECT_NEAR(stretched.upper.x() - stretched.lower.x(), 192, 1e-9);
  EXPECT_NEAR(stretched.upper.y() - stretched.lower.y(), 48, 1e-9);
  EXPECT_TRUE(wide.unit_is_known);
  EXPECT_FALSE(width_of("").unit_is_known);
  EXPECT_TRUE(warns_of(width_of("viewBox='0 0 192 192'"), "1/96 inch"));
  const Drawing millimetres = width_of("viewBox='0 0 192 192'", LengthUnit::mm);
  EXPECT_NEAR(millimetres.upper.x() - millimetres.lower.x(), 96, 1e-9);
  EXPECT_TRUE(millimetres.warnings.empty());
  // Without a page the lower left corner of the drawing is the origin.
  EXPECT_EQ(width_of("").lower, Eigen::Vector2d(0, 0));
}

TEST(Svg, IsScaledToAWidthAtTheToleranceThatIsAskedFor) {
  for (const double width : {0.5, 30.0, 1500.0}) {
    DrawingOptions options;
    options.tolerance = 0.02;
    options.width = width;
    const Drawing drawing =
        read_drawing(page(R"svg(<circle cx="30" cy="30" r="10"/><path d="M50 50 C50 60 70 60 70 50 Z"/>)svg"), options);
    EXPECT_NEAR(drawing.upper.x() - drawing.lower.x(), width, 1e-9 * width);
    EXPECT_LE(drawing.chord_error, 0.02);
    EXPECT_GE(drawing.chord_error, width < 1 ? 0 : 0.002);
    EXPECT_NEAR(drawing.unit, width / 50, 0.05 * width / 50);
  }
}

TEST(Svg, PolygonsAreFoundByIdsLabelsAndGroups) {
  const Drawing drawing = read(page(R"svg(<g id="layer1" inkscape:label="Regions"><g id="inner">
    <rect id="heel" inkscape:label="Heel" width="10" height="10"/></g></g><rect x="20" width="5" height="5"/>)svg"));
  ASSERT_EQ(drawing.outlines.size(), 2U);
  EXPECT_EQ(drawing.outlines[0].names, (std::vector<std::string>{"heel", "Heel", "inner", "layer1", "Regions"}));
  EXPECT_TRUE(drawing.outlines[1].names.empty());
}

TEST(Svg, OpenCurvesOfOneGroupAreJoinedAndOthersTold) {
  // Sides in any order and direction close; one in another group, and one with a gap, do not.
  const Drawing drawing = read(page(R"svg(<g><path d="M10 10H30"/><line x1="30" y1="30" x2="30" y2="10.004"/>
    <polyline points="10,10 10,30 30,30"/></g><rect x="50" width="5" height="5"/>
    <g fill="none" stroke="#000"><line x1="40" y1="40" x2="60" y2="40"/></g>
    <g fill="none" stroke="#000"><path id="open" d="M60 40V60L40 40.1"/></g>)svg"));
  ASSERT_EQ(drawing.outlines.size(), 2U);
  EXPECT_NEAR(std::abs(area(drawing.outlines[0])), 400, 0.1);
  EXPECT_EQ(drawing.curves, 6U);
  EXPECT_EQ(drawing.joined, 3U);
  EXPECT_EQ(drawing.open_curves, 2U);
  EXPECT_TRUE(warns_of(drawing, "<path> \"open\" of line 4 ends"));
}

TEST(Svg, WhatIsUsedIsDrawnAgain) {
  const std::string defined = R"svg(<defs><g id="pair"><rect id="r" width="10" height="5"/>
    <use href="#dot" x="5"/></g><circle id="dot" cy="8" r="2"/></defs>)svg";
  expect_corners(page(defined + R"svg(<use xlink:href="#r" x="20" y="1cm"/>)svg"), {{20, 80 - 37.795275590551178},
                                                                                    {30, 80 - 37.795275590551178},
                                                                                    {30, 75 - 37.795275590551178},
                                                                                    {20, 75 - 37.795275590551178}});
  // A <use> draws as if its target were written there, in a group that is moved.
  const Drawing used = read(page(defined + R"svg(<use id="left" href="#pair" transform="rotate(30)" x="40" y="-10"/>
    <g id="right"><use id="small" href="#pair" transform="translate(70 40) scale(.5)"/></g>)svg"));
  const Drawing written = read(page(R"svg(<g transform="rotate(30) translate(40 -10)"><rect width="10" height="5"/>
    <circle cx="5" cy="8" r="2"/></g><g transform="translate(70 40) scale(.5)"><rect width="10" height="5"/>
    <circle cx="5" cy="8" r="2"/></g>)svg"));
  ASSERT_EQ(used.outlines.size(), 4U);
  ASSERT_EQ(written.outlines.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_EQ(used.outlines[k].corners.size(), written.outlines[k].corners.size());
    for (std::size_t i = 0; i < used.outlines[k].corners.size(); ++i)
      EXPECT_LT((used.outlines[k].corners[i] - written.outlines[k].corners[i]).norm(), 1e-9);
  }
  EXPECT_EQ(used.outlines[0].names, (std::vector<std::string>{"r", "pair", "left"}));
  EXPECT_EQ(used.outlines[3].names, (std::vector<std::string>{"dot", "pair", "small", "right"}));
}

TEST(Svg, SymbolsFillTheSpaceOfTheirUse) {
  const std::string symbol = R"svg(<symbol id="s" viewBox="1 0 2 1"><rect x="1" width="2" height="1"/></symbol>)svg";
  // Without a size of the <use>, the page's size counts. In a space of another aspect ratio, the symbol is centred.
  expect_corners(page(symbol + R"svg(<use href="#s"/>)svg"), {{0, 65}, {100, 65}, {100, 15}, {0, 15}});
  expect_corners(page(symbol + R"svg(<use href="#s" x="10" y="20" width="40" height="30"/>)svg"),
                 {{10, 55}, {50, 55}, {50, 35}, {10, 35}});
  expect_corners(page(R"svg(<symbol id="s" viewBox="1 0 2 1" preserveAspectRatio="none" width="8">
    <rect x="1" width="2" height="1"/></symbol><use href="#s" height="30"/>)svg"),
                 {{0, 80}, {8, 80}, {8, 50}, {0, 50}});
  expect_corners(page(R"svg(<symbol id="s"><rect width="2" height="1"/></symbol><use href="#s" width="40"/>)svg"),
                 {{0, 80}, {2, 80}, {2, 79}, {0, 79}});
}

TEST(Svg, LinesOfSeveralUsesAreJoinedWhereTheyClose) {
  const Drawing drawing = read(page(R"svg(<defs><g id="angle"><path d="M0 0H10"/><path d="M0 0V10"/></g></defs>
    <g><use href="#angle"/><use href="#angle" transform="translate(10 10) rotate(180)"/></g><rect x="50" width="5" height="5"/>)svg"));
  ASSERT_EQ(drawing.outlines.size(), 2U);
  EXPECT_EQ(drawing.open_curves, 0U);
  EXPECT_NEAR(std::abs(area(drawing.outlines[0])), 100, 1e-9);
  EXPECT_TRUE(warns_of(drawing, "Curves of several layers or groups close together"));
}

TEST(Svg, WhatIsNoOutlineIsLeftOutAndTold) {
  const Drawing drawing = read(page(R"svg(<defs><rect width="1" height="1"/></defs><clipPath><circle r="3"/></clipPath>
    <rect width="10" height="10"/><rect width="10" height="10"/><rect width="9" height="9" style="fill:red; display : none"/>
    <g display="none"><rect width="8" height="8"/></g><text id="t">words</text><use href="#x"/><use href="other.svg#r"/><use href="#t"/>
    <path d="M0 0 L5 0 Z"/><script>alert(1)</script><sodipodi:namedview/>)svg"));
  EXPECT_EQ(drawing.outlines.size(), 1U);
  EXPECT_TRUE(warns_of(drawing, "1 polygon lies over another one"));
  EXPECT_TRUE(warns_of(drawing, "2 hidden elements left out"));
  EXPECT_TRUE(warns_of(drawing, "2 <use> of nothing in the file left out"));
  EXPECT_TRUE(warns_of(drawing, "1 <use> of <text> left out"));
  EXPECT_TRUE(warns_of(drawing, "1 <text> left out"));
  EXPECT_TRUE(warns_of(drawing, "1 closed curve without area"));
}

TEST(Svg, NamesTheElementThatCannotBeRead) {
  const auto message = [](const std::string& content, const char* code = "outline.unreadable") {
    return std::string(expect_error(code, [&] { read(content); }).what());
  };
  const auto expect_words = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  expect_words(message(page("\n<path id=\"heel\" d=\"M0 0 L5 x\"/>")),
               "<path> \"heel\" of line 2: \"x\" at character 9 must be a number");
  expect_words(message(path("L5 5")), "must begin with M");
  expect_words(message(path("M0 0 K5 5")), "is no command");
  expect_words(message(path("M0 0 A5 5 0 2 0 5 5")), "must be a flag");
  expect_words(message(path("M0 0 L nan 5")), "must be a number");
  expect_words(message(path("M0 0 L 1e400 5")), "must be a number");
  expect_words(message(path("M0 0 L 1e12 5 L 5 5Z")), "beyond 10000 m");
  expect_words(message(page("<circle r='5em'/>")), "in none of the units");
  expect_words(message("<svg><circle r='5%'/></svg>"), "r is a percentage, but the page has no size");
  expect_words(message(page("<rect width='-5' height='5'/>")), "negative");
  expect_words(message(page("<polygon points='1,2,3'/>")), "odd number");
  expect_words(message(page("<g transform='turn(3)'/>")), "\"turn\" is no function");
  expect_words(message(page("<g transform='rotate(3 4)'/>")), "\"rotate\" has 2 numbers");
  expect_words(message("<svg viewBox='0 0 0 5'/>"), "viewBox");
  expect_words(message("<svg width='-5'/>"), "width must be positive");
  expect_words(message("<html/>"), "is no <svg>");
  expect_words(message("<svg><rect</svg>"), "line 1");
  expect_words(message(page("<line x2='5'/>"), "outline.nothing_closed"), "ends 5 mm from where it begins");
  expect_words(message(page("<use/>"), "outline.nothing_closed"), "<use> of nothing in the file left out");
  const std::string symbol = "<symbol id='s' viewBox='0 0 2 1'><rect width='2' height='1'/></symbol>";
  expect_words(message(page(symbol + "<use href='#s' width='0'/>")), "width must be positive");
  expect_words(message("<svg>" + symbol + "<use href='#s'/></svg>"),
               "<symbol> \"s\" of line 1: its view box has no space");
}

}  // namespace
}  // namespace supple::outlines
