// Parts that are hard to cut out: outlines that run along beams, through joints or almost touch themselves, tiles that
// cross themselves, extreme sizes. Each part is one piece and a closed surface, whose area is at most that of its
// outline.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "supple/tiling/part.h"
#include "support/closed_stl.h"
#include "support/preset_structure.h"

namespace supple::tiling {
namespace {

using supple::testing::preset_structure;
using supple::testing::volume_of_closed_stl;

constexpr double pi = std::numbers::pi;

Polygon box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

PartDesign plate(const Structure& structure, Polygon outline) {
  PartDesign design;
  design.outline = {std::move(outline)};
  design.filling.structure = structure;
  return design;
}

/// Makes a part, and expects one closed piece within the outline, with the same volume in its files.
Part expect_sound(const PartDesign& design, const std::string& what) {
  SCOPED_TRACE(what);
  Part part = make_part(design);
  EXPECT_EQ(part.faces.size(), 1U);
  EXPECT_GT(part.solid_area, 0);
  EXPECT_LE(part.solid_area + part.crumb_area, part.outline_area * (1 + 1e-9));
  const double volume = volume_of_closed_stl(part_stl(part));
  // Corners in STL files are in single precision.
  EXPECT_NEAR(volume, part.thickness * part.solid_area, 2e-3 * part.thickness * part.solid_area);
  return part;
}

TEST(HardParts, OutlinesAlongTheLattice) {
  // Sides of the outline lie on lattice lines through the middle, where beams and joints are.
  for (const char* id : {"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"}) {
    const Structure structure = preset_structure(id);
    const double scale = printed_beam_width / structure.beam_width;
    const Eigen::Vector2d a = 3 * scale * structure.tiling.lattice.col(0),
                          b = 3 * scale * structure.tiling.lattice.col(1);
    expect_sound(plate(structure, {-a - b, a - b, a + b, b - a}), id);
  }
}

TEST(HardParts, OrientationsNextToOnesThatFit) {
  // After a rotation by 1e-9 rad, beams lie almost on the outline.
  const Structure structure = preset_structure("IH21");
  for (const double turn : {0.0, 1e-9, -1e-9, 1e-6, pi / 6, pi / 3 + 1e-9, pi / 2 - 1e-12, 1e6}) {
    PartDesign design = plate(structure, box(0, 0, 14, 11));
    design.frame = 0.4;
    design.filling.orientation = turn;
    expect_sound(design, std::to_string(turn));
  }
}

TEST(HardParts, TilesThatCrossThemselves) {
  Structure structure = make_structure(family("IH01"), std::vector<double>{0.097405, 0.406142, 0.05, 0.762537});
  PartDesign design = plate(structure, box(0, 0, 25, 18));
  design.frame = 0.5;
  expect_sound(design, "clipped");
  design.rim = Rim::whole;
  design.frame = 0;
  expect_sound(design, "whole tiles");
}

TEST(HardParts, EveryCornerOfEveryFamily) {
  for (const char* id : {"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"}) {
    const auto& parameters = family(id).parameters;
    const std::size_t corners = std::size_t{1} << parameters.size();
    for (std::size_t corner = 0; corner < corners; ++corner) {
      std::vector<double> values;
      for (std::size_t k = 0; k < parameters.size(); ++k)
        values.push_back((corner >> k) % 2 == 0 ? parameters[k].lower : parameters[k].upper);
      if (!can_be_built(family(id), values)) continue;
      PartDesign design = plate(make_structure(family(id), values), box(0, 0, 16, 13));
      design.frame = 0.5;
      expect_sound(design, std::string(id) + ", corner " + std::to_string(corner));
    }
  }
}

TEST(HardParts, SpikesAndNotchesOfTheOutline) {
  const Structure structure = preset_structure("IH67");
  // A spike of a hundredth of a millimetre is no wall, and a notch of this width separates nothing.
  const double thin = 0.01;
  const Polygon spike = {{0, 0}, {12, 0}, {12, 5}, {30, 5 + thin / 2}, {12, 5 + thin}, {12, 10}, {0, 10}};
  const Part without = expect_sound(plate(structure, spike), "spike");
  EXPECT_LE(without.upper.x(), 12.5);
  const Polygon notch = {{0, 0}, {12, 0}, {12, 5}, {1, 5 + thin / 2}, {12, 5 + thin}, {12, 10}, {0, 10}};
  PartDesign notched = plate(structure, notch);
  notched.frame = 0.5;
  expect_sound(notched, "notch");
}

TEST(HardParts, OutlinesOfManyAlmostCollinearCorners) {
  const Structure structure = preset_structure("IH22");
  Polygon circle;
  constexpr int corners = 4000;
  for (int i = 0; i < corners; ++i)
    circle.emplace_back(9 * std::cos(2 * pi * i / corners), 9 * std::sin(2 * pi * i / corners));
  PartDesign design = plate(structure, circle);
  design.frame = 0.4;
  const Part part = expect_sound(design, "circle");
  EXPECT_NEAR(part.outline_area, pi * 81, 1e-3);
}

TEST(HardParts, RegionsThatShareSidesWithTheOutlineAndEachOther) {
  PartDesign design = plate(preset_structure("IH21"), box(0, 0, 24, 12));
  design.regions = {{box(0, 0, 8, 12), {preset_structure("IH67")}}, {box(8, 0, 16, 12), {preset_structure("IH22")}}};
  design.seam = 0.6;
  design.frame = 0.6;
  expect_sound(design, "side by side");
  // These regions extend beyond the outline and over each other, and one covers another completely.
  design.regions = {{box(4, 4, 6, 6), {preset_structure("IH50")}},
                    {box(-5, -5, 12, 30), {preset_structure("IH67")}},
                    {box(12, -1, 40, 13), {preset_structure("IH29")}}};
  expect_sound(design, "over each other");
}

TEST(HardParts, PlatesThatTouchInOneCorner) {
  // Two squares of an outline meet in one point only, so that one of them is not connected.
  PartDesign design = plate(preset_structure("IH67"), box(0, 0, 8, 8));
  design.outline.push_back(box(8, 8, 16, 16));
  design.frame = 0.5;
  const Part part = expect_sound(design, "corner to corner");
  EXPECT_GE(part.crumbs, 1U);
  EXPECT_NEAR(part.crumb_area, part.solid_area, 0.2 * part.solid_area);
}

TEST(HardParts, TheSmallestAndTheLargest) {
  const Structure structure = preset_structure("IH67");
  // The frame holds about a quarter of a cell.
  PartDesign small = plate(structure, box(0, 0, 1.2, 1));
  small.frame = 0.3;
  expect_sound(small, "1.2 mm");
  // This outline has a side of 4 m, as the limits of coordinates allow.
  PartDesign large = plate(structure, box(-2000, -2000, 2000, 2000));
  large.filling.beam_width = 60;
  large.smallest_wall = 40;
  large.frame = 80;
  large.thickness = 1000;
  expect_sound(large, "4 m");
}

TEST(HardParts, EndsThatTheFillingBarelyHoldsOrDoesNotHold) {
  // The narrower a coupon, the less often its tiles connect both grips. A part has its full length if and only if it
  // reports no lost grip.
  std::size_t whole = 0, broken = 0;
  for (const char* id : {"IH01", "IH21", "IH50"}) {
    for (const double width : {1.0, 2.0, 3.0, 5.0, 8.0, 12.0}) {
      const PartShape shape = tensile_coupon(width, 20, 5);
      PartDesign design = plate(preset_structure(id), shape.outline[0]);
      design.solids = shape.solids;
      design.filling.beam_width = 0.8;
      design.smallest_wall = 0.5;
      const Part part = expect_sound(design, std::string(id) + ", " + std::to_string(width) + " mm");
      const bool lower = part.lower.y()<1, upper = part.upper.y()> 29;
      EXPECT_EQ(part.lost_solids.size(), static_cast<std::size_t>(!lower) + static_cast<std::size_t>(!upper));
      for (const std::size_t solid : part.lost_solids) EXPECT_FALSE(solid == 0 ? lower : upper);
      ++(part.lost_solids.empty() ? whole : broken);
    }
  }
  EXPECT_GT(whole, 2U);
  EXPECT_GT(broken, 2U);
}

TEST(HardParts, FarFromTheOrigin) {
  const Structure structure = preset_structure("IH28");
  PartDesign design = plate(structure, box(0, 0, 15, 12));
  design.frame = 0.5;
  const double there = make_part(design).solid_area;
  design.outline = {box(1900, -1950, 1915, -1938)};
  EXPECT_NEAR(expect_sound(design, "far").solid_area, there, 1e-4 * there);
}

}  // namespace
}  // namespace supple::tiling
