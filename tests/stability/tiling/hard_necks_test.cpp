// Parts whose beams are cut so that some of them are connected by very narrow necks. Here necks are measured by
// distances of the points of a grid, without the outline's corners.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "solid_raster.h"
#include "supple/base/random.h"
#include "supple/tiling/part.h"
#include "support/closed_stl.h"
#include "support/preset_structure.h"

namespace supple::tiling {
namespace {

using supple::testing::preset_structure;
using supple::testing::SolidRaster;
using supple::testing::volume_of_closed_stl;

constexpr double half_turn = std::numbers::pi;

PartDesign coupon(const Structure& structure, double width, double length, double grip, double beam_width,
                  double orientation) {
  PartDesign design;
  const PartShape shape = tensile_coupon(width, length, grip);
  design.outline = shape.outline;
  design.solids = shape.solids;
  design.filling = {structure, beam_width, orientation};
  design.smallest_wall = 2 * beam_width / 3;
  return design;
}

/// Expects that erosion by almost half the wall separates the solid nowhere, and neither does erosion by almost half
/// the narrowest place. Returns whether slightly more erosion separates it, which fails only if the solid is hardly
/// wider beside the narrowest place.
bool expect_no_neck(const Part& part, double wall) {
  EXPECT_EQ(part.faces.size(), 1U);
  const SolidRaster raster(part.faces[0], wall / 24);
  const SolidRaster::Topology whole{1, static_cast<int>(part.faces[0].size())};
  EXPECT_EQ(raster.eroded(0.88 * wall, 0.93 * wall), whole) << "the solid hangs by a neck narrower than the wall";
  // There is no narrow place if all beams get wider towards one point.
  if (!part.smallest_neck) return true;
  EXPECT_GE(*part.smallest_neck, 0.97 * wall);
  EXPECT_EQ(raster.eroded(*part.smallest_neck - 0.1 * wall, *part.smallest_neck - 0.07 * wall), whole);
  return raster.eroded(*part.smallest_neck + 0.1 * wall, *part.smallest_neck + 0.12 * wall) != whole;
}

TEST(HardNecks, GripsThatHangByMicrometres) {
  const Family& family = tiling::family("IH29");
  const Structure structure = make_structure(family, std::vector<double>{0.732});
  const Part part = make_part(coupon(structure, 18.9, 23.7, 4, 0.4, -1.5));
  EXPECT_GE(part.widened_necks, 2U);
  EXPECT_TRUE(part.lost_solids.empty());
  EXPECT_NEAR((part.upper - part.lower - Eigen::Vector2d(18.9, 31.7)).norm(), 0, 1e-6);
  EXPECT_TRUE(expect_no_neck(part, 0.4 * 2 / 3));
  volume_of_closed_stl(part_stl(part));
}

/// A random structure from the middle four fifths of a family's box.
Structure random_structure(RandomStream& random) {
  const std::vector<std::string> ids = {"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"};
  const Family& family = tiling::family(ids[static_cast<std::size_t>(random.below(static_cast<int>(ids.size())))]);
  std::vector<double> values;
  do {
    values.clear();
    for (const Parameter& parameter : family.parameters)
      values.push_back(parameter.lower + random.uniform(0.1, 0.9) * (parameter.upper - parameter.lower));
  } while (!can_be_built(family, values));
  return make_structure(family, values);
}

TEST(HardNecks, RandomPartsHaveNone) {
  // These variables are for longer runs: the number of parts, and the seed of the first one.
  const char* const count = std::getenv("SUPPLE_NECK_COUNT");
  const char* const first = std::getenv("SUPPLE_NECK_SEED");
  const int seed = first ? std::atoi(first) : 1, parts = count ? std::atoi(count) : 40;
  std::size_t widened = 0, cut = 0;
  int sharp = 0;
  for (int k = seed; k < seed + parts; ++k) {
    SCOPED_TRACE("seed " + std::to_string(k));
    RandomStream random("necks", static_cast<std::uint64_t>(k));
    const Structure structure = random_structure(random);
    const double beam_width = random.uniform(0.25, 0.6);
    PartDesign design = coupon(structure, beam_width * random.uniform(18, 40), beam_width * random.uniform(15, 40),
                               random.uniform(0.5, 3), beam_width, random.uniform(-half_turn, half_turn));
    if (random.uniform() < 0.3) {
      // This outline is slanted, and has a hole but no grips.
      const Eigen::Vector2d size = design.outline[0][2];
      design.outline = {{{0, 0}, {size.x(), 0.1 * size.y()}, size, {-0.2 * size.x(), 0.8 * size.y()}},
                        {0.4 * size, {0.6 * size.x(), 0.4 * size.y()}, 0.6 * size, {0.4 * size.x(), 0.6 * size.y()}}};
      design.solids.clear();
    }
    if (random.uniform() < 0.3) design.frame = beam_width * random.uniform(0.8, 2);
    if (random.uniform() < 0.3) design.smallest_wall = beam_width * random.uniform(0.4, 1);
    const Part part = make_part(design);
    widened += part.widened_necks;
    cut += part.cut_necks;
    sharp += expect_no_neck(part, design.smallest_wall) ? 1 : 0;
    EXPECT_LE(part.solid_area + part.crumb_area, part.outline_area * (1 + 1e-9));
    const double volume = volume_of_closed_stl(part_stl(part));
    EXPECT_NEAR(volume, part.solid_area, 2e-3 * part.solid_area);
  }
  std::printf("%d parts: %zu necks widened, %zu cut; %d narrowest places confirmed\n", parts, widened, cut, sharp);
  EXPECT_GE(sharp, 0.95 * parts) << "the narrowest place is one";
  if (parts >= 40) {
    EXPECT_GT(widened, 0U) << "some random parts have necks, or this test tests nothing";
  }
}

}  // namespace
}  // namespace supple::tiling
