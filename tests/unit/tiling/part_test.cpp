#include "supple/tiling/part.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "beams.h"
#include "designs.h"
#include "polygon.h"
#include "supple/base/error.h"
#include "supple/tiling/tiling_error.h"
#include "support/closed_stl.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;
using supple::testing::places;
using supple::testing::volume_of_closed_stl;
using testing::preset_structure;

Polygon box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

PartDesign plate(const char* name, double width, double height) {
  PartDesign design;
  design.outline = {box(0, 0, width, height)};
  design.filling.structure = preset_structure(name);
  return design;
}

double area_of(const std::vector<SolidFace>& faces) {
  double sum = 0;
  for (const auto& face : faces) {
    for (const Polygon& polygon : face) sum += area(polygon);
  }
  return sum;
}

bool is_inside(const Part& part, const Eigen::Vector2d& point) {
  int winding = 0;
  for (const auto& face : part.faces) {
    for (const Polygon& polygon : face) winding += winding_number(polygon, point);
  }
  return winding > 0;
}

/// The depth (mm) to which the polygons cross themselves or each other. The depth of two crossing sides is the smallest
/// distance of an end of either side from the other side; the result is the largest depth.
double depth_of_crossings(const SolidFace& face) {
  struct Side {
    Eigen::Vector2d a, b;
    double left, right;
  };
  std::vector<Side> sides;
  for (const Polygon& polygon : face) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      sides.push_back({a, b, std::min(a.x(), b.x()), std::max(a.x(), b.x())});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.left < t.left; });
  double depth = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto& [a, b, left, right] = sides[i];
    for (std::size_t j = i + 1; j < sides.size() && sides[j].left <= right; ++j) {
      const Eigen::Vector2d &c = sides[j].a, &d = sides[j].b;
      if (a == c || a == d || b == c || b == d) continue;
      if (cross(b - a, c - a) * cross(b - a, d - a) >= 0 || cross(d - c, a - c) * cross(d - c, b - c) >= 0) continue;
      depth = std::max(depth, std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d),
                                        distance_to_segment(c, a, b), distance_to_segment(d, a, b)}));
    }
  }
  return depth;
}

class PartsOfEveryFamily : public ::testing::TestWithParam<const char*> {};

TEST_P(PartsOfEveryFamily, AreOnePieceOfTheSizeAskedFor) {
  PartDesign design = plate(GetParam(), 20, 12);
  design.frame = 0.6;
  design.thickness = 2;
  const Part part = make_part(design);
  ASSERT_EQ(part.faces.size(), 1U);
  EXPECT_NEAR((part.lower - Eigen::Vector2d(0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((part.upper - Eigen::Vector2d(20, 12)).norm(), 0, 1e-9);
  EXPECT_NEAR(part.outline_area, 240, 1e-6);
  EXPECT_NEAR(area_of(part.faces), part.solid_area, 1e-9);
  EXPECT_NEAR(volume_of_closed_stl(part_stl(part)), 2 * part.solid_area, 1e-3 * part.solid_area);
  EXPECT_EQ(size_words(part), "20 x 12 x 2 mm");
  // Inside the frame the density is that of the structure, except for cells that are cut.
  const auto& structure = design.filling.structure;
  const double inner = 18.8 * 10.8;
  const double density = (part.solid_area - (240 - inner)) / inner;
  EXPECT_NEAR(density, structure.solid_area / structure.cell_area, 0.12);
}

INSTANTIATE_TEST_SUITE_P(Tilings, PartsOfEveryFamily,
                         ::testing::Values("IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"));

TEST(Part, HoldsTheStructureWhereItHasNoFrame) {
  const PartDesign design = plate("IH21", 30, 30);
  const Part part = make_part(design);
  const auto& structure = design.filling.structure;
  EXPECT_NEAR(part.solid_area / 900, structure.solid_area / structure.cell_area, 0.02);
  EXPECT_LE(part.trimmed_area, 0.5);
  volume_of_closed_stl(part_stl(part));
}

TEST(Part, ScalesWithTheWidthOfItsBeams) {
  PartDesign small = plate("IH67", 10, 8), large = plate("IH67", 30, 24);
  large.filling.beam_width = 0.9;
  large.smallest_wall = 0.6;
  EXPECT_NEAR(make_part(large).solid_area, 9 * make_part(small).solid_area, 1e-3 * make_part(large).solid_area);
}

TEST(Part, TurnsItsTiling) {
  PartDesign design = plate("IH22", 16, 16);
  design.filling.orientation = std::acos(-1.0);
  const Part turned = make_part(design);
  design.filling.orientation = 0;
  const Part straight = make_part(design);
  // A rotation by 180 degrees about the middle maps the square onto itself.
  EXPECT_NEAR(turned.solid_area, straight.solid_area, 1e-6);
  for (const auto& polygon : turned.faces[0]) {
    const Eigen::Vector2d middle = (polygon[0] + polygon[1]) / 2;
    const Eigen::Vector2d normal =
        Eigen::Vector2d(polygon[0].y() - polygon[1].y(), polygon[1].x() - polygon[0].x()).normalized();
    if ((polygon[1] - polygon[0]).norm() < 0.05) continue;
    EXPECT_TRUE(is_inside(straight, Eigen::Vector2d(16, 16) - (middle + 1e-4 * normal)));
  }
  design.filling.orientation = 0.7;
  EXPECT_GT(std::abs(make_part(design).solid_area - straight.solid_area), 1e-3);
}

TEST(Part, KeepsWholeTilesWhereAsked) {
  PartDesign design = plate("IH21", 20, 20);
  design.rim = Rim::whole;
  const Part part = make_part(design);
  EXPECT_GE(part.lower.minCoeff(), -1e-9);
  EXPECT_LE(part.upper.maxCoeff(), 20 + 1e-9);
  EXPECT_LT((part.upper - part.lower).maxCoeff(), 20 - 1e-3) << "no tile ends where the outline runs";
  // No beam is cut: the corners of the solid are those of beams, and none lies on the outline.
  for (const auto& p : part.faces[0][0]) EXPECT_GT(std::min({p.x(), p.y(), 20 - p.x(), 20 - p.y()}), 1e-6);
  volume_of_closed_stl(part_stl(part));
}

TEST(Part, HasSolidGripsAndPlates) {
  PartDesign design = plate("IH50", 1, 1);
  const PartShape shape = tensile_coupon(12, 24, 8);
  design.outline = shape.outline;
  design.solids = shape.solids;
  const Part part = make_part(design);
  for (const double y : {0.5, 4.0, 7.9, 32.1, 39.5}) {
    for (const double x : {0.3, 6.0, 11.7}) EXPECT_TRUE(is_inside(part, {x, y}));
  }
  EXPECT_GT(part.solid_area, 192);
  EXPECT_LT(part.solid_area, 400);
}

TEST(Part, TellsWhichOfItsSolidsItHasLost) {
  // With beams of 0.8 mm, tiles are as wide as this coupon. With beams of 0.3 mm, both grips are connected.
  PartDesign design = plate("IH21", 1, 1);
  const PartShape shape = tensile_coupon(10, 60, 8);
  design.outline = shape.outline;
  design.solids = shape.solids;
  EXPECT_TRUE(make_part(design).lost_solids.empty());
  design.filling.beam_width = 0.8;
  design.smallest_wall = 0.5;
  const Part broken = make_part(design);
  ASSERT_EQ(broken.lost_solids.size(), 1U);
  EXPECT_GT(broken.crumbs, 0U);
  const double middle = broken.lost_solids[0] == 0 ? 4 : 72;
  EXPECT_FALSE(is_inside(broken, {5, middle}));
  EXPECT_TRUE(is_inside(broken, {5, 76 - middle}));
  design.frame = 1;
  EXPECT_TRUE(make_part(design).lost_solids.empty()) << "a frame holds it together";
  // A solid outside the outline does not belong to the part, and cannot be lost.
  design.frame = 0;
  design.filling.beam_width = 0.3;
  design.smallest_wall = 0.2;
  design.solids.push_back(box(20, 0, 30, 10));
  EXPECT_TRUE(make_part(design).lost_solids.empty());
}

TEST(Part, ShapesHaveTheSizesAskedFor) {
  const PartShape coupon = tensile_coupon(10, 60, 15), block = compression_block(30, 20, 2);
  EXPECT_EQ(coupon.outline[0][2], Eigen::Vector2d(10, 90)) << "the gauge length lies between the grips";
  EXPECT_EQ(coupon.solids.size(), 2U);
  EXPECT_NEAR(area(coupon.solids[0]) + area(coupon.solids[1]), 300, 1e-12);
  EXPECT_EQ(block.outline[0][2], Eigen::Vector2d(30, 24)) << "the structure's height lies between the plates";
  EXPECT_NEAR(area(block.solids[0]) + area(block.solids[1]), 120, 1e-12);
  EXPECT_TRUE(compression_block(30, 20, 0).solids.empty());
}

TEST(Part, FillsRegionsEachWithItsOwnAndClosesTheSeams) {
  PartDesign design = plate("IH21", 30, 20);
  design.regions.push_back({box(-5, -5, 10, 25), {preset_structure("IH50"), 0.3, 0}});
  design.regions.push_back({box(8, -5, 18, 25), {preset_structure("IH29"), 0.4, 0.3}});
  design.seam = 0.5;
  design.frame = 0.5;
  const Part part = make_part(design);
  ASSERT_EQ(part.faces.size(), 1U);
  EXPECT_EQ(part.crumbs, 0U);
  for (const double x : {8.0, 18.0}) {
    for (double y = 0.1; y < 20; y += 0.7) {
      EXPECT_TRUE(is_inside(part, {x - 0.2, y}) && is_inside(part, {x + 0.2, y})) << "the seam at " << x << ", " << y;
    }
  }
  volume_of_closed_stl(part_stl(part));
}

TEST(Part, HasTheHolesOfItsOutline) {
  PartDesign design = plate("IH67", 24, 24);
  design.outline.push_back(box(8, 8, 16, 16));
  design.frame = 1;
  const Part part = make_part(design);
  EXPECT_NEAR(part.outline_area, 576 - 64, 1e-6);
  EXPECT_FALSE(is_inside(part, {12, 12}));
  EXPECT_TRUE(is_inside(part, {12, 7.5})) << "the frame runs around the hole";
}

TEST(Part, LeavesOutNarrowWallsAndCrumbs) {
  // The outline cuts the beams to slivers of a tenth of a millimetre.
  PartDesign design = plate("IH22", 17.3, 13.1);
  design.smallest_wall = 0.3;
  const Part part = make_part(design);
  EXPECT_GT(part.trimmed_area, 0);
  // Without a smallest wall, nothing is trimmed.
  design.smallest_wall = 0;
  const Part raw = make_part(design);
  EXPECT_EQ(raw.trimmed_area, 0);
  EXPECT_GE(raw.solid_area + raw.crumb_area, part.solid_area + part.crumb_area);
}

/// Depth of crossings, mm, that is allowed, since corners within 1e-7 mm of the line through their neighbours are
/// dropped.
constexpr double deepest_crossing = 2e-7;

TEST(Part, HasNoOutlineThatCrossesItselfWhereShortSidesBecamePoints) {
  // This part once had an outline that crossed itself by 3 um, which could not be meshed.
  PartDesign found;
  found.outline = {{{12.662092816130562, 2.0320829813959547},
                    {-2.9438794421038263, 8.259937856403983},
                    {-6.470497074632795, 8.98214167413578},
                    {-10.968061483270503, -8.424495401873184},
                    {-14.260764522290087, -12.33947318851749}}};
  const Family& ih67 = family("IH67");
  const auto at = [&ih67](std::size_t k, double share) {
    const auto& [lower, upper, preset] = ih67.parameters[k];
    return lower + (upper - lower) * share;
  };
  found.filling = {make_structure(ih67, std::vector<double>{at(0, 0.21188769302463983), at(1, 0.919558030456365)}),
                   0.7188697084666945, 2.075383161753832};
  found.smallest_wall = 0.2539707556467072;
  const Part part = make_part(found);
  EXPECT_LE(depth_of_crossings(part.faces[0]), deepest_crossing);
  EXPECT_NEAR(volume_of_closed_stl(part_stl(part)), part.solid_area, 1e-3 * part.solid_area);

  // Variants of the part have their short sides displaced by some micrometres.
  RandomStream random("neighbours of a part", 1);
  for (int k = 0; k < 100; ++k) {
    PartDesign design = found;
    const double reach = std::pow(10, random.uniform(-5, -2));
    for (Eigen::Vector2d& p : design.outline[0])
      p += reach * Eigen::Vector2d(random.uniform(-1, 1), random.uniform(-1, 1));
    ASSERT_LE(depth_of_crossings(make_part(design).faces[0]), deepest_crossing) << "neighbour " << k;
  }
}

TEST(Part, HasFacesThatDoNotCrossHoweverManyOfTheirSidesBecomePoints) {
  // Rings with random teeth have sides about as long as those that become points.
  RandomStream random("rings of short sides", 1);
  for (int k = 0; k < 200; ++k) {
    std::vector<Polygon> rings(3);
    for (Polygon& ring : rings) {
      const Eigen::Vector2d middle(random.uniform(), random.uniform());
      const int corners = 40 + random.below(100);
      for (int corner = 0; corner < corners; ++corner) {
        const double angle = 2 * std::numbers::pi * corner / corners;
        ring.emplace_back(middle + random.uniform(0.4, 0.7) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      }
    }
    const double shortest = std::pow(10, random.uniform(-3, -0.7));
    const std::vector<Face> faces = faces_of_union(rings, shortest);
    ASSERT_FALSE(faces.empty());
    std::vector<Polygon> all;
    for (const Face& face : faces) all.insert(all.end(), face.begin(), face.end());
    ASSERT_LE(depth_of_crossings(all), deepest_crossing) << "rings " << k;
    for (const Polygon& polygon : all) {
      for (std::size_t i = 0; i < polygon.size(); ++i)
        ASSERT_GE((polygon[(i + 1) % polygon.size()] - polygon[i]).norm(), shortest * (1 - 1e-6)) << "rings " << k;
    }
  }
}

TEST(Part, IsWrittenInEveryFormatWithItsSize) {
  PartDesign design = plate("IH21", 15, 10);
  design.thickness = 1.5;
  const Part part = make_part(design);
  const std::string words = "15 x 10 x 1.5 mm";
  const std::string svg = part_svg(part), dxf = part_dxf(part), stl = part_stl(part), package = part_3mf(part);
  EXPECT_NE(svg.find("<title>Supple part, " + words + "</title>"), std::string::npos);
  EXPECT_NE(svg.find("width=\"15mm\" height=\"10mm\""), std::string::npos);
  EXPECT_NE(dxf.find("Supple part, " + words), std::string::npos);
  EXPECT_EQ(stl.substr(0, 29), "Supple part, 15 x 10 x 1.5 mm");
  EXPECT_EQ(package.substr(0, 2), "PK");
  EXPECT_NE(package.find("3D/3dmodel.model"), std::string::npos);
  EXPECT_EQ(part_3mf(part), package) << "the same bytes again";
}

/// Three regions side by side in a frame, the second of which begins `gap` mm beside the first.
PartDesign three_regions(double gap) {
  PartDesign design = plate("IH21", 1, 1);
  design.outline.clear();
  design.outline_of_regions = true;
  design.divides_solid = true;
  design.seam = 0.3;
  design.frame = 0.6;
  const Filling filling = design.filling, other{preset_structure("IH29"), 0.3};
  design.regions = {{box(0, 0, 10, 10), filling, "heel"},
                    {box(10 + gap, 0, 20, 10), other, "arch"},
                    {box(20, 2, 28, 9), filling, ""}};
  return design;
}

TEST(Part, WhoseOutlineIsItsRegionsIsTheirUnion) {
  for (const double gap : {0.0, 1e-8, 0.03, -2.0}) {
    const Part part = make_part(three_regions(gap));
    ASSERT_EQ(part.faces.size(), 1U);
    EXPECT_NEAR(part.outline_area, 256, 1e-3) << "gaps are closed: " << gap;
    EXPECT_NEAR((part.upper - Eigen::Vector2d(28, 10)).norm(), 0, 1e-5);
    EXPECT_LT(part.crumb_area, 0.1 * part.solid_area);
    ASSERT_EQ(part.regions.size(), 3U) << "nothing is the rest";
    EXPECT_EQ(part.regions[2].name, "Region 3");
  }
}

TEST(Part, WhoseRegionsAreSeveralPiecesNamesThem) {
  PartDesign design = three_regions(1);
  const Error error = expect_error<PartError>("tiling.part", [&] { make_part(design); });
  EXPECT_NE(std::string(error.what()).find("2 pieces instead of one"), std::string::npos) << error.what();
  EXPECT_NE(std::string(error.what()).find("heel"), std::string::npos) << error.what();
  EXPECT_NE(std::string(error.what()).find("arch, Region 3"), std::string::npos) << error.what();
  EXPECT_EQ(places(error), std::vector<std::string>{"regions/0/outline"});
}

TEST(Part, IsDividedAmongItsRegions) {
  PartDesign design = plate("IH21", 30, 20);
  design.seam = 0.4;
  design.frame = 0.8;
  const Filling other{preset_structure("IH29"), 0.3};
  // The second region lies over the first one, and the rest surrounds both.
  design.regions = {{box(2, 2, 15, 18), other, "a & b"}, {box(10, 5, 25, 15), design.filling, "c"}};
  const Part undivided = make_part(design);
  EXPECT_TRUE(undivided.regions.empty()) << "only if the design asks for it";
  design.divides_solid = true;
  const Part part = make_part(design);
  EXPECT_EQ(part.faces, undivided.faces) << "the whole solid stays the same";
  EXPECT_EQ(part_stl(part), part_stl(undivided));
  ASSERT_EQ(part.regions.size(), 3U);
  EXPECT_EQ(part.regions[0].name, "a & b");
  EXPECT_EQ(part.regions[2].name, "Rest");
  double sum = 0;
  for (const RegionSolid& region : part.regions) sum += area_of(region.faces);
  EXPECT_NEAR(sum, part.solid_area, 1e-3 * part.solid_area);
  const double heel = area_of(part.regions[0].faces);
  EXPECT_LT(heel, 13 * 16 - 5 * 10) << "the solid within what the second region leaves of the first";
  EXPECT_TRUE(make_part(plate("IH21", 10, 10)).regions.empty());
}

TEST(Part, NamesWhatIsWrongWithIt) {
  const auto refused = [](auto change) {
    PartDesign design = plate("IH21", 10, 10);
    change(design);
    const Error error = expect_error<PartError>("tiling.part", [&] { make_part(design); });
    return places(error);
  };
  using Places = std::set<std::string>;
  const auto found = [](const auto& list) { return Places(list.begin(), list.end()); };
  EXPECT_EQ(found(refused([](PartDesign& d) { d.outline.clear(); })), Places{"outline"});
  EXPECT_EQ(found(refused([](PartDesign& d) {
              d.outline[0] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
            })),
            Places{"outline/0"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.outline[0].resize(2); })), Places{"outline/0"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.outline[0][1].x() = 3000; })), Places{"outline/0"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.outline[0].resize(5001, Eigen::Vector2d(1, 1)); })), Places{"outline"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.frame = -1; })), Places{"frame"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.smallest_wall = 0.4; })), Places{"smallest_wall"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.thickness = 0; })), Places{"thickness"});
  EXPECT_EQ(found(refused([](PartDesign& d) { d.outline[0] = box(0, 0, 1500, 1500); })), Places{"beam_width"});
  EXPECT_EQ(found(refused([](PartDesign& d) {
              d.regions.push_back({{{0, 0}, {1, 0}}, d.filling});
              d.regions.back().filling.beam_width = 0;
            })),
            (Places{"regions/0/outline", "regions/0/beam_width", "smallest_wall"}));
  EXPECT_EQ(found(refused([](PartDesign& d) {
              d.outline[0] = box(0, 0, 1, 1);
              d.rim = Rim::whole;
            })),
            Places{"outline"});
}

}  // namespace
}  // namespace supple::tiling
