#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "outline_measures.h"
#include "supple/base/error.h"
#include "support/expect_error.h"

namespace supple::outlines {
namespace {

using supple::testing::expect_error;
using supple::testing::places;
using testing::even_odd_area;
using testing::pi;
using testing::warns_of;

const std::string shown_square = "<rect x='10' y='10' width='40' height='40'/>";

std::string sheet(const std::string& content, const std::string& head = {}) {
  return head + "<svg width='60mm' height='60mm' viewBox='0 0 60 60'>" + content + "</svg>";
}

Drawing read_sheet(const std::string& content, const DrawingOptions& options = {}) {
  return read_drawing(sheet(content), options);
}

TEST(ShownShapes, AreThoseThatABrowserShows) {
  // Each drawing has one square of 40 mm that is shown, and something that is not shown.
  const std::string inner = "<rect x='20' y='20' width='20' height='20'";
  const std::string small = inner + "/>";
  for (const std::string& hidden :
       {"<style>.st0{display:none;}</style><g class='st0'>" + small + "</g>",
        "<style><![CDATA[ .a, .st0 { DISPLAY : none } ]]></style>" + inner + " class='b st0'/>",
        "<style>#h{visibility:hidden}</style>" + inner + " id='h'/>",
        "<style>g.x > rect{display:none}</style><g class='x'>" + small + "</g>",
        "<style>.x rect{display:none}</style><g class='x'><g>" + small + "</g></g>",
        "<style>rect[class='k']{display:none}</style>" + inner + " class='k'/>",
        "<style>.k{display:none!important}</style>" + inner + " class='k' style='display:inline'/>",
        "<style>#k{display:none} .k{display:inline}</style>" + inner + " id='k' class='k'/>",
        "<style>@media screen{.k{display:none}} @media print{.k{display:inline}}</style>" + inner + " class='k'/>",
        "<style>/* .k{display:inline} */ .k{display:none /* ; */}</style>" + inner + " class='k'/>",
        inner + " style='fill:none;'/>",
        inner + " fill='none'/>",
        inner + " visibility='hidden'/>",
        "<g visibility='collapse'>" + small + "</g>",
        inner + " opacity='0'/>",
        "<g style='opacity:0.0'>" + small + "</g>",
        inner + " fill='transparent'/>",
        inner + " fill='rgba(0,0,0,0)'/>",
        inner + " fill-opacity='0'/>",
        inner + " fill='none' stroke='#000' stroke-width='0'/>",
        inner + " fill='none' stroke='red' stroke-opacity='0'/>",
        "<g fill='none'>" + small + "</g>",
        "<g style='fill:none;stroke:none'>" + small + "</g>",
        "<switch><foreignObject requiredExtensions='x'/><g>" + shown_square + "</g><g>" + small + "</g></switch>"}) {
    SCOPED_TRACE(hidden);
    const Drawing drawing = read_sheet(hidden + shown_square);
    ASSERT_EQ(drawing.outlines.size(), 1U);
    EXPECT_NEAR(even_odd_area(drawing), 1600, 1e-9);
    if (hidden.find("switch") != std::string::npos) continue;
    ASSERT_EQ(drawing.left_out_count, 1U);
    EXPECT_NE(drawing.left_out[0].element.find("of line 1"), std::string::npos);
    EXPECT_TRUE(warns_of(drawing, "1 hidden element left out"));
  }
}

TEST(ShownShapes, WhatIsShownInSpiteOfItsGroupIsShown) {
  for (const char* shown :
       {"<g visibility='hidden'><rect visibility='visible' width='10' height='10'/></g>",
        "<g fill='none'><rect fill='red' width='10' height='10'/></g>",
        "<style>.k{display:none}</style><rect class='k' style='display:inline' width='10' height='10'/>",
        "<style>rect:hover{display:none}</style><rect width='10' height='10'/>",
        "<g fill='none' stroke='black'><rect width='10' height='10'/></g>",
        "<defs><rect id='r' width='10' height='10'/></defs><use href='#r' style='fill:blue'/>"}) {
    const Drawing drawing = read_sheet(shown);
    ASSERT_EQ(drawing.outlines.size(), 1U) << shown;
    EXPECT_EQ(drawing.left_out_count, 0U);
  }
  // A copy inherits the fill of its <use>.
  expect_error("outline.nothing_closed",
               [] { read_sheet("<defs><rect id='r' width='10' height='10'/></defs><use href='#r' fill='none'/>"); });
}

TEST(ShownShapes, WhatDecidesAndCannotBeKnownIsRefusedOrTold) {
  const auto message = [](const std::string& content) {
    return std::string(expect_error("outline.unreadable", [&] { read_sheet(content + shown_square); }).what());
  };
  EXPECT_NE(message("<rect width='5' height='5' style='fill:var(--ink)'/>").find("var(--ink)"), std::string::npos);
  EXPECT_NE(message("<rect width='5' height='5' style='transform:rotate(3deg)'/>").find("transform"),
            std::string::npos);
  EXPECT_NE(message("<mask id='m'/><rect width='5' height='5' mask='url(#m)'/>").find("mask"), std::string::npos);
  EXPECT_TRUE(warns_of(read_sheet("<style>@import url(x.css);</style>" + shown_square), "@import"));
  EXPECT_TRUE(warns_of(read_sheet("<style>rect:nth-child(2){display:none}</style>" + shown_square), "nth-child"));
}

TEST(ShownShapes, PercentagesAreOfThePage) {
  const Drawing background = read_sheet("<rect width='100%' height='100%' fill='#fff'/>" + shown_square);
  EXPECT_NEAR(even_odd_area(background), 1600, 1e-9);
  EXPECT_EQ(background.left_out.at(0).reason, "it is a white background of the whole page");
  EXPECT_NEAR(even_odd_area(read_sheet("<rect x='25%' y='10%' width='50%' height='25%'/>")), 450, 1e-9);
  EXPECT_NEAR(even_odd_area(read_sheet("<circle cx='50%' cy='50%' r='25%'/>")), pi * 225, 4);
  EXPECT_NEAR(even_odd_area(read_sheet("<style>rect{width:50%;height:10px}</style><rect/>")), 300, 1e-9);
  EXPECT_NEAR(even_odd_area(read_sheet("<rect width='100%' height='100%'/>")), 3600, 1e-9) << "black is no background";
}

TEST(ShownShapes, AreFilledAsTheirRuleSays) {
  const std::string plus = "<rect x='25' y='10' width='10' height='40'/><rect x='10' y='25' width='40' height='10'/>";
  const Drawing united = read_sheet(plus);
  ASSERT_EQ(united.outlines.size(), 1U);
  EXPECT_EQ(united.outlines[0].corners.size(), 12U);
  EXPECT_EQ(united.united, 2U);
  EXPECT_NEAR(even_odd_area(united), 700, 1e-6);
  // In different groups both remain, with a warning.
  const Drawing apart =
      read_sheet("<g><rect x='25' y='10' width='10' height='40'/></g>" + plus.substr(plus.find("<rect", 1)));
  EXPECT_EQ(apart.outlines.size(), 2U);
  EXPECT_TRUE(warns_of(apart, "cross each other"));
  // Regions may cross the part without a warning.
  for (const char* name : {"regions", "Regions"}) {
    const Drawing region =
        read_sheet(std::string("<g id='") + name + "'><rect x='25' y='10' width='10' height='40'/></g>" +
                   plus.substr(plus.find("<rect", 1)));
    EXPECT_EQ(region.outlines.size(), 2U);
    EXPECT_FALSE(warns_of(region, "cross each other")) << name;
  }

  const auto filled = [](const char* data, const char* rule) {
    return even_odd_area(read_sheet(std::string("<path fill-rule='") + rule + "' d='" + data + "'/>"));
  };
  const char* same = "M10 10H50V50H10ZM20 20H40V40H20Z";
  const char* opposite = "M10 10H50V50H10ZM20 20V40H40V20Z";
  EXPECT_NEAR(filled(same, "nonzero"), 1600, 1e-6);
  EXPECT_NEAR(filled(same, "evenodd"), 1200, 1e-6);
  EXPECT_NEAR(filled(opposite, "nonzero"), 1200, 1e-6);
  const char* star = "M30 5L45 50L6 22H54L15 50Z";
  EXPECT_GT(filled(star, "nonzero"), filled(star, "evenodd") + 100);
  EXPECT_NEAR(filled("M10 10H30V50H10ZM20 10H40V50H20Z", "nonzero"), 1200, 1e-6) << "sides over each other";
}

TEST(ShownShapes, OpenOnesThatAreFilledAreClosedAsBrowsersDo) {
  EXPECT_NEAR(even_odd_area(read_sheet("<path d='M10 10L50 10L50 50L10 50'/>")), 1600, 1e-9);
  EXPECT_NEAR(even_odd_area(read_sheet("<polyline points='10,10 50,10 50,50'/>")), 800, 1e-9);
  // The two halves of a square lie in two groups; each is a filled triangle, as in a browser.
  EXPECT_NEAR(even_odd_area(read_sheet("<g><path d='M10 10L50 10L50 50'/></g><g><path d='M50 50L10 50L10 10'/></g>")),
              1600, 1e-6);
  // A line without a fill stays open.
  expect_error("outline.nothing_closed",
               [] { read_sheet("<path fill='none' stroke='#000' d='M10 10L50 10L50 50L10 50'/>"); });
}

TEST(ShownShapes, TheSameCurveTwiceCountsOnce) {
  for (const char* twice : {"<path d='M10 10H50V50H10Z'/><path d='M10 10H30H50V50H10Z'/>",
                            "<path d='M10 10H50V50H10Z'/><path d='M50 50H10V10H50V30Z'/>",
                            "<path d='M10 10H50V50H10Z'/><path d='M10.001 10H50V49.999H10Z'/>"}) {
    const Drawing drawing = read_sheet(twice);
    EXPECT_EQ(drawing.outlines.size(), 1U) << twice;
    EXPECT_TRUE(warns_of(drawing, "1 polygon lies over another one"));
    EXPECT_EQ(drawing.left_out.at(0).reason, "it lies over another outline, which counts once");
  }
}

TEST(ShownShapes, ClipPathsCut) {
  const std::string clip = "<clipPath id='c'><rect x='10' y='10' width='20' height='40'/></clipPath>";
  const auto cut = [&](const std::string& content) { return read_sheet(clip + content); };
  EXPECT_NEAR(even_odd_area(cut("<g clip-path='url(#c)'>" + shown_square + "</g>")), 800, 1e-6);
  EXPECT_EQ(cut("<g clip-path='url(#c)'>" + shown_square + "</g>").clipped, 1U);
  EXPECT_NEAR(even_odd_area(cut("<g style='clip-path: url(\"#c\")'>" + shown_square + "</g>")), 800, 1e-6);
  EXPECT_NEAR(even_odd_area(cut("<style>.k{clip-path:url(#c)}</style><g class='k'>" + shown_square + "</g>")), 800,
              1e-6);
  // A clip path is in the coordinates of what it cuts, and nested clip paths both cut.
  EXPECT_NEAR(even_odd_area(cut("<g transform='scale(.5)' clip-path='url(#c)'>" + shown_square + "</g>")), 200, 1e-6);
  EXPECT_NEAR(even_odd_area(read_sheet(clip +
                                       "<clipPath id='d'><rect y='30' width='60' height='9'/></clipPath>"
                                       "<g clip-path='url(#d)'><g clip-path='url(#c)'>" +
                                       shown_square + "</g></g>")),
              180, 1e-6);
  // A clip path around everything changes no corner.
  const Drawing page = read_sheet("<clipPath id='p'><path d='M0 0H60V60H0Z'/></clipPath><g clip-path='url(#p)'>" +
                                  shown_square + "</g>");
  EXPECT_EQ(page.clipped, 0U);
  EXPECT_EQ(page.outlines.at(0).corners.size(), 4U);
  // A shape that is cut off as a whole is named.
  EXPECT_EQ(cut("<rect x='40' y='10' width='5' height='5' clip-path='url(#c)'/>" + shown_square).left_out.at(0).reason,
            "a clip path hides all of it");
  expect_error("outline.unreadable", [&] {
    read_sheet(
        "<clipPath id='b' clipPathUnits='objectBoundingBox'><rect width='1' height='1'/></clipPath>"
        "<g clip-path='url(#b)'>" +
        shown_square + "</g>");
  });
  expect_error("outline.unreadable", [&] { cut("<g style='clip-path:circle(5px)'>" + shown_square + "</g>"); });
}

TEST(ShownShapes, NestedDrawingsHaveTheirOwnCoordinates) {
  const Drawing drawing = read_sheet(
      "<svg x='10' y='10' width='20' height='40' viewBox='0 0 10 10' "
      "preserveAspectRatio='xMidYMin'><rect width='5' height='50%'/></svg>");
  EXPECT_NEAR(even_odd_area(drawing), 100, 1e-9);
  EXPECT_LT((drawing.upper - Eigen::Vector2d(20, 50)).norm(), 1e-9);
  // Everything beyond the edge of an inner drawing is cut off.
  EXPECT_NEAR(even_odd_area(read_sheet("<svg x='10' y='10' width='20' height='20'>" + shown_square + "</svg>")), 100,
              1e-6);
  EXPECT_NEAR(even_odd_area(read_sheet("<svg width='20' height='20' overflow='visible'>" + shown_square + "</svg>")),
              1600, 1e-6);
}

TEST(ShownShapes, TracedOutlinesAreSimplifiedWithinTheTolerance) {
  std::string points;
  constexpr int corners = 6'000;
  for (int k = 0; k < corners; ++k) {
    const double t = 2 * pi * k / corners;
    points += std::to_string(30 + 25 * std::cos(t)) + "," + std::to_string(30 + 25 * std::sin(t)) + " ";
  }
  for (const double tolerance : {0.05, 0.005}) {
    DrawingOptions options;
    options.tolerance = tolerance;
    const Drawing drawing = read_sheet("<polygon points='" + points + "'/>", options);
    ASSERT_EQ(drawing.outlines.size(), 1U);
    EXPECT_LT(drawing.outlines[0].corners.size(), 500U);
    EXPECT_EQ(drawing.simplified, corners - drawing.outlines[0].corners.size());
    EXPECT_LE(drawing.chord_error, tolerance);
    const double most = 2 * pi * 25 * tolerance;
    EXPECT_NEAR(even_odd_area(drawing), pi * 625, most);
  }
}

TEST(ShownShapes, PixelsOfOldProgramsAreAskedFor) {
  const std::string illustrator =
      "<!-- Generator: Adobe Illustrator 15.0, SVG Export -->"
      "<svg width='72px' height='72px' viewBox='0 0 72 72'><rect width='72' height='36'/></svg>";
  const std::string inkscape =
      "<svg inkscape:version='0.48.4 r9939' width='90' height='90'><rect width='90' height='45'/></svg>";
  for (const auto& [text, resolution] : {std::pair(illustrator, 72.0), std::pair(inkscape, 90.0)}) {
    const Error error = expect_error("outline.resolution_missing", [&text = text] { read_drawing(text); });
    EXPECT_EQ(places(error), std::vector<std::string>{"resolution"});
    DrawingOptions options;
    options.resolution = resolution;
    const Drawing drawing = read_drawing(text, options);
    EXPECT_NEAR(drawing.upper.x(), 25.4, 1e-9);
    EXPECT_TRUE(drawing.unit_is_known);
    options = {};
    options.unit = LengthUnit::mm;
    EXPECT_NEAR(read_drawing(text, options).upper.x(), resolution, 1e-9);
  }
  // Files of other programs are read with 96 pixels per inch, as the standard says, and with a warning.
  const Drawing pixels = read_drawing("<svg width='96px' height='96px'><rect width='96' height='48'/></svg>");
  EXPECT_NEAR(pixels.upper.x(), 25.4, 1e-9);
  EXPECT_FALSE(pixels.unit_is_known);
  EXPECT_TRUE(warns_of(pixels, "1/96 inch"));
  // A size in millimetres is used, whatever the program.
  std::string sized = illustrator;
  for (const char* side : {"width='72px'", "height='72px'"})
    sized.replace(sized.find(side) + std::string(side).size() - 5, 4, "72mm");
  EXPECT_NEAR(read_drawing(sized).upper.x(), 72, 1e-9);
}

TEST(ShownShapes, OtherKindsOfFilesAreNamed) {
  using namespace std::string_literals;
  for (const auto& [text, words] :
       std::vector<std::pair<std::string, std::string>>{{"AC1018\0\0\0"s, "DWG"},
                                                        {"%PDF-1.7\n", "PDF"},
                                                        {"%!PS-Adobe-3.0 EPSF-3.0\n", "PostScript"},
                                                        {"\x1F\xC2\x8B\x08", "svgz"},
                                                        {"AutoCAD Binary DXF\r\n\x1a", "binary DXF"},
                                                        {"\xC2\x89PNG\r\n\x1a\n", "PNG"},
                                                        {"\xC3\xBF\xC3\x98\xC3\xBF\xC3\xA0\0\x10JFIF"s, "JPEG"},
                                                        {"ISO-10303-21;\n", "STEP"},
                                                        {"PK\x03\x04", "ZIP"},
                                                        {"abc\0def"s, "binary"}}) {
    const Error error = expect_error("outline.unreadable", [&text = text] { read_drawing(text); });
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace supple::outlines
