// Drawings that are hard to read: hostile text, limits, curves that almost close, cusps, and coordinates at the limit
// of floating-point numbers. Each gives polygons within the tolerance, or an error that names the limit.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/outlines/drawing.h"
#include "support/expect_error.h"

namespace supple::outlines {
namespace {

using supple::testing::expect_cancelled;
using supple::testing::expect_error;
using supple::testing::places;

constexpr double pi = std::numbers::pi;

std::string page(const std::string& content) {
  return "<svg width='100mm' height='100mm' viewBox='0 0 100 100'>" + content + "</svg>";
}
std::string repeated(const std::string& text, std::size_t times) {
  std::string result;
  for (std::size_t k = 0; k < times; ++k) result += text;
  return result;
}

TEST(HardDrawings, EntitiesAreNeverReplaced) {
  // A "billion laughs" attack, and a file of the machine: references to entities stay as written, and are no numbers.
  const std::string laughs =
      "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;&a;'><!ENTITY f SYSTEM "
      "'file:///etc/passwd'>]>";
  const Drawing drawing = read_drawing(laughs + page("<rect id='&b;&f;' width='10' height='10'/>"));
  EXPECT_EQ(drawing.outlines.at(0).names.at(0), "&b;&f;");
  expect_error("outline.unreadable", [&] { read_drawing(laughs + page("<path d='&b;'/>")); });
}

TEST(HardDrawings, DepthCurvesAndCornersAreBounded) {
  const auto refused = [](const std::string& text, double tolerance = 0.05) {
    DrawingOptions options;
    options.tolerance = tolerance;
    const Error error = expect_error("outline.too_large", [&] { read_drawing(text, options); });
    return places(error).at(0) + ": " + error.what();
  };
  EXPECT_NE(
      refused(page(repeated("<g>", 101) + "<rect width='1' height='1'/>" + repeated("</g>", 101))).find("100 groups"),
      std::string::npos);
  EXPECT_NO_THROW(read_drawing(page(repeated("<g>", 90) + "<rect width='1' height='1'/>" + repeated("</g>", 90))));
  // Elements that are no groups are not entered, however deep they are.
  EXPECT_NO_THROW(
      read_drawing(page(repeated("<x>", 200'000) + repeated("</x>", 200'000) + "<rect width='1' height='1'/>")));
  EXPECT_NE(refused(page(repeated("<rect width='1' height='1'/>", 20'001))).find("20000 curves"), std::string::npos);
  EXPECT_NE(refused(page("<path d='M0 0" + repeated("c0 1 1 1 1 0", 30'000) + "Z'/>")).find("100000 corners"),
            std::string::npos);
  EXPECT_NE(refused(page("<path d='M0 0" + repeated("h0", 100'001) + "Z'/>")).find("100000 pieces"), std::string::npos);
  std::string kinds = "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n10\n0\n20\n0\n40\n5\n";
  for (int k = 0; k < 1'000; ++k) kinds += "0\nKIND" + std::to_string(k) + "\n";
  EXPECT_LE(read_drawing(kinds + "0\nENDSEC\n0\nEOF\n").warnings.size(), 25U);
  EXPECT_EQ(refused(page("<circle cx='50' cy='50' r='1e8' transform='scale(1e-2)'/>"), 1e-4).substr(0, 18),
            "accuracy/tolerance");
}

TEST(HardDrawings, WhatIsDrawnAgainIsBounded) {
  const auto refused = [](const std::string& text) {
    const Error error = expect_error("outline.too_large", [&] { read_drawing(text); });
    return places(error).at(0) + ": " + error.what();
  };
  const std::string solid = "<rect width='1' height='1'/>";
  // These <use> elements refer to themselves, directly and through another one.
  EXPECT_NE(refused(page(solid + "<use id='a' href='#a'/>")).find("100 groups"), std::string::npos);
  EXPECT_NE(refused(page(solid + "<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>")).find("100 groups"),
            std::string::npos);
  // A "billion laughs" attack: each of ten levels has ten uses of the level below; the lowest is empty or a curve.
  const auto laughs = [&](const std::string& joke) {
    std::string levels = "<defs><g id='l0'>" + joke + "</g>";
    for (int k = 1; k <= 10; ++k) {
      levels += "<g id='l" + std::to_string(k) + "'>";
      levels += repeated("<use href='#l" + std::to_string(k - 1) + "'/>", 10) + "</g>";
    }
    return page(solid + levels + "</defs><use href='#l10'/>");
  };
  EXPECT_NE(refused(laughs("")).find("200000 elements"), std::string::npos);
  EXPECT_NE(refused(laughs(solid)).find("20000 curves"), std::string::npos);
  // The file is searched for ids only once, though none is found.
  EXPECT_EQ(read_drawing(page(repeated("<use href='#nothing'/>", 190'000) + solid)).outlines.size(), 1U);
  // The length of a path's text counts, even if it draws nothing, because reading it takes time.
  for (const std::string& path : {repeated("M0 0", 250'000), "M0 0" + repeated("h0", 90'000)}) {
    const std::string used = "<defs><path id='p' d='" + path + "'/></defs>" + repeated("<use href='#p'/>", 20'000);
    EXPECT_NE(refused(page(solid + used)).find("as much text"), std::string::npos);
  }

  const auto section = [](const std::string& name, const std::string& content) {
    return "0\nSECTION\n2\n" + name + "\n" + content + "0\nENDSEC\n";
  };
  const std::string circle = "0\nCIRCLE\n10\n0\n20\n0\n40\n5\n";
  const auto inserted = [&](const std::string& block, const std::string& more = {}) {
    return section("BLOCKS", "0\nBLOCK\n2\nb\n" + block + "0\nENDBLK\n") +
           section("ENTITIES", circle + "0\nINSERT\n2\nb\n" + more) + "0\nEOF\n";
  };
  EXPECT_EQ(read_drawing(inserted(circle, "10\n100\n")).outlines.size(), 2U);
  EXPECT_NE(refused(inserted("0\nINSERT\n2\nb\n")).find("100 blocks"), std::string::npos);
  EXPECT_NE(refused(inserted(circle, "70\n900000000\n71\n900000000\n")).find("20000 curves"), std::string::npos);
  EXPECT_NE(refused(inserted("", "70\n900000000\n71\n900000000\n")).find("2000000 groups"), std::string::npos);
  const std::string comments = "999\n" + repeated("x", 1'000'000) + "\n";
  EXPECT_NE(refused(inserted(circle + comments, "70\n10000\n")).find("2000000 groups"), std::string::npos);
  // A block without an end extends to the end of its section.
  EXPECT_EQ(read_drawing(section("BLOCKS", "0\nBLOCK\n2\nb\n" + circle) + section("ENTITIES", "0\nINSERT\n2\nb\n") +
                         "0\nEOF\n")
                .outlines.size(),
            1U);
}

TEST(HardDrawings, AStopIsFollowedWithinTheText) {
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { read_drawing(page("<rect width='1' height='1'/>"), {}, execution); });
}

TEST(HardDrawings, CuspsLoopsAndHandlesOnTheirEnds) {
  // Cubic curves with a cusp, with a loop, with control points on the ends, and one that folds back on a line.
  for (const char* data : {"M10 10C40 40 10 40 40 10Z", "M10 10C60 40 -10 40 40 10Z", "M10 10C10 10 40 40 40 10Z",
                           "M10 10C10 10 40 10 40 10V30Z", "M10 10C60 10 -20 10 40 10V30Z"}) {
    SCOPED_TRACE(data);
    DrawingOptions options;
    options.tolerance = 1e-3;
    const Drawing drawing = read_drawing(page("<path d='" + std::string(data) + "'/>"), options);
    // A curve that crosses itself bounds two areas.
    ASSERT_EQ(drawing.outlines.size(), std::string(data).find("-10 40 40 10") != std::string::npos ? 2U : 1U);
    EXPECT_LE(drawing.chord_error, 1e-3);
    EXPECT_GT(drawing.chord_error, 0);
  }
}

TEST(HardDrawings, ArcsAtTheirLimits) {
  // These arcs are almost whole circles, have radii that just span the chord, or are very flat ellipses.
  const auto area_of = [](const std::string& data) {
    DrawingOptions options;
    options.tolerance = 1e-3;
    const auto drawing = read_drawing(page("<path d='" + data + "'/>"), options);
    double twice = 0;
    const auto& c = drawing.outlines.at(0).corners;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const auto &p = c[k], &q = c[(k + 1) % c.size()];
      twice += p.x() * q.y() - p.y() * q.x();
    }
    return std::abs(twice / 2);
  };
  EXPECT_NEAR(area_of("M50 50A10 10 0 1 1 50 50.000001Z"), 100 * pi, 0.1);
  EXPECT_NEAR(area_of("M40 50A10 10 0 0 1 60 50Z"), 50 * pi, 0.1);
  EXPECT_NEAR(area_of("M40 50A9.9999999999 9.9999999999 0 1 1 60 50Z"), 50 * pi, 0.1);
  EXPECT_NEAR(area_of("M10 50A40 0.04 0 1 1 90 50A40 0.04 0 1 1 10 50Z"), 1.6 * pi, 0.2);
  // An arc of a radius of 1 km over 100 mm is almost flat.
  const auto flat = read_drawing(page("<path d='M0 50A1e6 1e6 0 0 1 100 50V90H0Z'/>"));
  EXPECT_NEAR(flat.upper.y(), 50, 2e-3);
}

TEST(HardDrawings, EndsThatMeetAtTheToleranceAndBeyond) {
  const auto open_of = [](double gap) {
    DrawingOptions options;
    options.tolerance = 0.05;
    const std::string text = page("<rect width='3' height='3'/><path fill='none' stroke='red' d='M10 10H30V30H10V" +
                                  std::to_string(10 + gap) + "'/>");
    return read_drawing(text, options).open_curves;
  };
  EXPECT_EQ(open_of(0), 0U);
  EXPECT_EQ(open_of(0.04), 0U);
  EXPECT_EQ(open_of(0.06), 1U);
}

TEST(HardDrawings, ManyPiecesInRandomOrderClose) {
  // A circle of 4,000 lines in random order and directions; seed 7.
  constexpr int sides = 4'000;
  std::vector<std::string> lines;
  RandomStream random("pieces of a circle", 7);
  for (int k = 0; k < sides; ++k) {
    const double a = 2 * pi * k / sides, b = 2 * pi * (k + 1) / sides;
    const bool turned = random.uniform() < 0.5;
    const auto x = [](double t) { return std::to_string(50 + 40 * std::cos(t)); };
    const auto y = [](double t) { return std::to_string(50 + 40 * std::sin(t)); };
    lines.push_back("<line x1='" + x(turned ? b : a) + "' y1='" + y(turned ? b : a) + "' x2='" + x(turned ? a : b) +
                    "' y2='" + y(turned ? a : b) + "'/>");
  }
  for (std::size_t k = lines.size() - 1; k > 0; --k)
    std::swap(lines[k], lines[static_cast<std::size_t>(random.uniform() * static_cast<double>(k + 1))]);
  std::string content;
  for (const std::string& line : lines) content += line;
  DrawingOptions options;
  options.tolerance = 1e-3;
  const Drawing drawing = read_drawing(page(content), options);
  ASSERT_EQ(drawing.outlines.size(), 1U);
  EXPECT_EQ(drawing.outlines[0].corners.size() + drawing.simplified, static_cast<std::size_t>(sides));
  EXPECT_EQ(drawing.joined, static_cast<std::size_t>(sides));
  EXPECT_EQ(drawing.open_curves, 0U);
}

TEST(HardDrawings, AnyBytesAreADrawingOrAnError) {
  // Drawings in which bytes are changed, removed and repeated; seed 11.
  const std::string svg = page(
      "<g transform='rotate(3)'><path id='p' d='M1 1c2 3 4 5 6 7S9 9 1 5Q3 4 5 6T1 1A3 4 5 0 1 9 9Z'/><circle "
      "r='4'/></g>");
  const std::string dxf =
      "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\na\n70\n1\n10\n0\n20\n0\n42\n1\n10\n5\n20\n0\n0\nCIRCLE\n10\n1\n20\n2"
      "\n40\n3\n0\nSPLINE\n71\n1\n"
      "40\n0\n40\n0\n40\n1\n40\n1\n10\n0\n20\n0\n10\n4\n20\n4\n0\nENDSEC\n0\nEOF\n";
  RandomStream random("broken drawings", 11);
  const auto below = [&random](std::size_t n) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
  };
  int read = 0;
  for (int k = 0; k < 4'000; ++k) {
    std::string text = k % 2 == 0 ? svg : dxf;
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const std::size_t at = below(text.size());
      switch (below(3)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, below(20));
          break;
        default:
          text.insert(at, text.substr(at, below(30)));
      }
      if (text.empty()) text = "<";
    }
    try {
      const Drawing drawing = read_drawing(text);
      for (const auto& outline : drawing.outlines) {
        EXPECT_GE(outline.corners.size(), 3U);
        for (const auto& corner : outline.corners) ASSERT_TRUE(corner.allFinite()) << text;
      }
      ++read;
    } catch (const Error& error) {
      EXPECT_TRUE(error.code().starts_with("outline.")) << error.code();
    }
  }
  EXPECT_GT(read, 200);
}

}  // namespace
}  // namespace supple::outlines
