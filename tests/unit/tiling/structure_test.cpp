#include "supple/tiling/structure.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "designs.h"
#include "polygon.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;
using testing::preset_structure;
using testing::random_parameters;

double distance_to_outline(const Polygon& polygon, const Eigen::Vector2d& p) {
  double least = INFINITY;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d a = polygon[k], u = polygon[(k + 1) % polygon.size()] - a;
    const double t = std::min(1.0, std::max(0.0, (p - a).dot(u) / u.squaredNorm()));
    least = std::min(least, (p - a - t * u).norm());
  }
  return least;
}

/// The number of holes in the first copy of a tile.
std::size_t holes_in(const Structure& structure, int tile) {
  const auto& placements = structure.tiling.placements;
  for (std::size_t k = 0; k < placements.size(); ++k) {
    if (placements[k].tile == tile) return structure.holes[k].size();
  }
  return 0;
}

TEST(Structure, BeamsHaveThePrintedWidthBetweenTheHolesOnTheirTwoSides) {
  for (const Family& family : families()) {
    const Structure structure = make_structure(family, presets(family));
    const Tiling& tiling = structure.tiling;
    for (const Placement& placement : tiling.placements) {
      const Polygon tile = placed(tiling.tiles[placement.tile], placement);
      for (std::size_t k = 0; k < tile.size(); ++k) {
        const Eigen::Vector2d middle = (tile[k] + tile[(k + 1) % tile.size()]) / 2;
        // The two nearest holes lie on the two sides of the beam.
        std::vector<double> distances;
        for (const std::vector<Polygon>& holes : structure.holes) {
          for (int i = -4; i <= 4; ++i) {
            for (int j = -4; j <= 4; ++j) {
              const Eigen::Vector2d seen_from = middle - tiling.lattice * Eigen::Vector2d(i, j);
              for (const Polygon& hole : holes) distances.push_back(distance_to_outline(hole, seen_from));
            }
          }
        }
        std::sort(distances.begin(), distances.end());
        EXPECT_NEAR(distances[0], printed_beam_width / 2, 1e-6) << family.id << " side " << k;
        EXPECT_NEAR(distances[1], printed_beam_width / 2, 1e-6) << family.id << " side " << k;
      }
    }
  }
}

TEST(Structure, TheSolidHasTheAreaOfItsBeams) {
  for (const Family& family : families()) {
    const Structure structure = make_structure(family, presets(family));
    double beams = 0;
    for (const Placement& placement : structure.tiling.placements) {
      beams += structure.beam_width * perimeter(structure.tiling.tiles[placement.tile]) / 2;
    }
    // Beams overlap where they meet, but little, since the default tiles are large compared with the beam width.
    EXPECT_LT(structure.solid_area, beams) << family.id;
    EXPECT_GT(structure.solid_area, 0.85 * beams) << family.id;
    EXPECT_NEAR(structure.cell_area, std::abs(structure.tiling.lattice.determinant()), 1e-12);
  }
}

TEST(Structure, LengthsAreMillimetres) {
  const Structure structure = preset_structure("IH50");
  EXPECT_NEAR(structure.scale, 0.3 / 0.0385, 1e-12);
  EXPECT_NEAR((structure.tiling.tiles[0][3] - structure.tiling.tiles[0][0]).norm(), 0.3 / 0.0385, 1e-12);
  EXPECT_NEAR(structure.tiling.lattice.col(1).norm(), 0.3 / 0.0385, 1e-12);
}

TEST(Structure, ScalesWithTheWidthOfItsBeams) {
  for (const Family& family : families()) {
    const Structure structure = make_structure(family, presets(family));
    const Structure wide = scaled(structure, 3 * structure.beam_width);
    EXPECT_EQ(wide.beam_width, 3 * structure.beam_width);
    EXPECT_DOUBLE_EQ(wide.scale, 3 * structure.scale);
    EXPECT_TRUE(wide.tiling.lattice.isApprox(3 * structure.tiling.lattice, 1e-15));
    EXPECT_DOUBLE_EQ(wide.cell_area, 9 * structure.cell_area);
    EXPECT_DOUBLE_EQ(wide.solid_area / wide.cell_area, structure.solid_area / structure.cell_area);
    // The areas of scaled holes and tiles agree with those that the structure states.
    double holes = 0;
    for (const auto& of_tile : wide.holes)
      for (const Polygon& hole : of_tile) holes += std::abs(area(hole));
    EXPECT_NEAR(wide.cell_area - holes, wide.solid_area, 1e-9 * wide.cell_area) << family.id;
    for (std::size_t k = 0; k < wide.tiling.placements.size(); ++k) {
      const auto& placement = wide.tiling.placements[k];
      const auto& before = structure.tiling.placements[k];
      const Polygon tile = placed(wide.tiling.tiles[placement.tile], placement);
      const Polygon tile_before = placed(structure.tiling.tiles[before.tile], before);
      for (std::size_t i = 0; i < tile.size(); ++i) EXPECT_LT((tile[i] - 3 * tile_before[i]).norm(), 1e-12);
    }
  }
}

TEST(Structure, HolesOfTheSquareFamilyCloseAtHalfABeamWidth) {
  const auto at = [](double p) { return make_structure(family("square"), std::vector{p}); };
  // Holes narrower than half a percent of the beam width are closed, which is 0.0005 of the parameter.
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(holes_in(at(sign * (0.0424 - 1e-6)), 0), 0u);
    EXPECT_EQ(holes_in(at(sign * (0.0424 + 6e-4)), 0), 1u);
    EXPECT_EQ(holes_in(at(sign * (0.9576 - 6e-4)), 1), 1u);
    EXPECT_EQ(holes_in(at(sign * (0.9576 + 1e-6)), 1), 0u);
  }
  EXPECT_EQ(holes_in(at(0.5), 0), 1u);
  EXPECT_EQ(holes_in(at(0.5), 1), 1u);
}

TEST(Structure, TheSquareFamilyIsSymmetricInItsParameter) {
  for (const double p : {0.01, 0.3, 0.97, 1.0}) {
    const Structure plus = make_structure(family("square"), std::vector{p});
    const Structure minus = make_structure(family("square"), std::vector{-p});
    EXPECT_EQ(plus.solid_area, minus.solid_area);
    EXPECT_EQ(plus.holes, minus.holes);
  }
}

TEST(Structure, AtItsSingularityTheSquareIsTwoCrossingDiagonals) {
  const Structure structure = make_structure(family("square"), std::vector{0.0});
  const double w = structure.beam_width;
  // Two diagonals overlap in a square at the centre and in one at the corners.
  EXPECT_NEAR(structure.solid_area, 2 * std::sqrt(structure.cell_area * 2) * w - 2 * w * w, 1e-6);
}

TEST(Structure, SolidAreaChangesContinuouslyThroughTheSingularity) {
  double before = make_structure(family("square"), std::vector{-0.06}).solid_area;
  for (int k = 1; k <= 120; ++k) {
    const double here = make_structure(family("square"), std::vector{-0.06 + 0.001 * k}).solid_area;
    EXPECT_NEAR(here, before, 0.03);
    before = here;
  }
}

TEST(Structure, TilesMayCrossThemselves) {
  // A vertex of the tile lies just beyond one of its sides.
  const Structure structure =
      make_structure(family("IH01"), std::vector{0.1802089117, 0.5506587018, 0.09055189846, 0.778137});
  EXPECT_TRUE(structure.tiles_cross);
  EXPECT_EQ(holes_in(structure, 0), 1u);
  EXPECT_FALSE(preset_structure("IH01").tiles_cross);
}

/// Whether the point is farther than half a beam width from all sides of all translates of the cell's tiles.
bool clear_of_beams(const Structure& structure, const Eigen::Vector2d& point) {
  for (const Placement& placement : structure.tiling.placements) {
    const Polygon tile = placed(structure.tiling.tiles[placement.tile], placement);
    for (int i = -6; i <= 6; ++i) {
      for (int j = -6; j <= 6; ++j) {
        const Eigen::Vector2d seen = point - structure.tiling.lattice * Eigen::Vector2d(i, j);
        if (distance_to_outline(tile, seen) <= structure.beam_width / 2) return false;
      }
    }
  }
  return true;
}

TEST(Structure, ThePlaneIsSolidWithinHalfABeamWidthOfEverySideAndOpenFarFromThemAll) {
  // This holds for crossing tiles, too: winding numbers of tiles do not decide which points are solid.
  const std::vector<std::pair<const char*, std::vector<double>>> designs = {
      {"IH01", {0.1802089117, 0.5506587018, 0.09055189846, 0.778137}},
      {"IH01", {0.097405, 0.406142, 0.05, 0.7675}},
      {"IH01", {0.2346258869, 0.7291153145, 0.05125551419, 0.4096083779}},
      {"IH67", {0.2341, 1.0539}},
      {"IH22", {0.15, 0.35, 0.02}},
      {"IH28", {0.3, 0.8}},
      {"IH21", {0.15, 0.6}}};
  for (const auto& [id, parameters] : designs) {
    const Structure structure = make_structure(family(id), parameters);
    RandomStream random("tiling.clear_of_beams", 5);
    int open = 0, differing = 0;
    for (int k = 0; k < 400; ++k) {
      const Eigen::Vector2d point =
          structure.tiling.lattice * Eigen::Vector2d(random.uniform(0, 1), random.uniform(0, 1));
      const int holes = testing::windings(structure.tiling, structure.holes, point);
      ASSERT_TRUE(holes == 0 || holes == 1) << id;
      const bool clear = clear_of_beams(structure, point);
      EXPECT_TRUE(clear || holes == 0) << id << " at " << point.transpose();
      // A few points differ, since square joints extend beyond the circle around a vertex.
      open += holes;
      differing += clear && holes == 0;
    }
    EXPECT_GT(open, 20) << id;
    EXPECT_LT(differing, 12) << id;
  }
}

TEST(Structure, HolesOfOverlappingTilesAreListedOnceAndWithinTheirTile) {
  const Structure structure = make_structure(family("IH67"), std::vector{0.2341, 1.0539});
  ASSERT_TRUE(structure.tiles_cross);
  for (std::size_t k = 0; k < structure.holes.size(); ++k) {
    const Placement& placement = structure.tiling.placements[k];
    const Polygon tile = placed(structure.tiling.tiles[placement.tile], placement);
    for (const Polygon& hole : structure.holes[k]) EXPECT_GT(winding_number(tile, hole[0]), 0);
  }
}

/// The jump of the solid's area, as a ratio to the cell's, that bisection finds on a line of designs between `lower`
/// and `upper` (fractions of the line). Bisection ends when the interval is 1e-9 long or the area changes by less than
/// `step`.
double largest_jump(const Family& type, const std::vector<double>& from, const std::vector<double>& to, double lower,
                    double upper, double step) {
  const auto density = [&](double t) {
    std::vector<double> parameters;
    for (std::size_t k = 0; k < from.size(); ++k) parameters.push_back((1 - t) * from[k] + t * to[k]);
    const Structure structure = make_structure(type, parameters, 0.05);
    return structure.solid_area / structure.cell_area;
  };
  double at_lower = density(lower), at_upper = density(upper);
  while (upper - lower > 1e-9 && std::abs(at_upper - at_lower) > step) {
    const double middle = (lower + upper) / 2, at_middle = density(middle);
    if (std::abs(at_middle - at_lower) > std::abs(at_upper - at_middle)) {
      upper = middle;
      at_upper = at_middle;
    } else {
      lower = middle;
      at_lower = at_middle;
    }
  }
  return std::abs(at_upper - at_lower);
}

class LinesThroughTheBox : public ::testing::TestWithParam<std::string> {};

TEST_P(LinesThroughTheBox, MeetNoJumpOfTheSolidsArea) {
  const Family& type = family(GetParam());
  RandomStream random("tiling.lines." + type.id, 6);
  constexpr int steps = 60;
  // The allowed jump as a ratio to the cell's area: at half a percent of a beam's width, holes may close and sides
  // become points.
  constexpr double allowed = 2e-3;
  int seen = 0, crossing = 0;
  for (int line = 0; line < 6; ++line) {
    const auto from = random_parameters(type, random, 0.05), to = random_parameters(type, random, 0.05);
    double before = NAN;
    for (int k = 0; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      std::vector<double> parameters;
      for (std::size_t i = 0; i < from.size(); ++i) parameters.push_back((1 - t) * from[i] + t * to[i]);
      try {
        const Structure structure = make_structure(type, parameters, 0.05);
        const double density = structure.solid_area / structure.cell_area;
        ++seen;
        crossing += structure.tiles_cross;
        if (std::abs(density - before) > allowed) {
          EXPECT_LT(largest_jump(type, from, to, t - 1.0 / steps, t, allowed), allowed)
              << "line " << line << " at " << t;
        }
        before = density;
      } catch (const Error& error) {
        EXPECT_TRUE(error.code() == "tiling.cell_too_small" || error.code() == "tiling.hole_closed") << error.code();
        before = NAN;
      }
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_TRUE(type.id != "IH01" || crossing > 20) << "tiles that cross themselves are what is hard";
}

INSTANTIATE_TEST_SUITE_P(Structure, LinesThroughTheBox,
                         ::testing::Values("IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67", "square"),
                         [](const auto& instance) { return instance.param; });

TEST(Structure, BeamsOfFoldedPartsAreKept) {
  // The upper side of the trapezoid is so short that its neighbouring sides cross.
  const Structure structure = make_structure(family("IH67"), std::vector{0.2341, 1.0539});
  EXPECT_TRUE(structure.tiles_cross);
  const Polygon& tile = structure.tiling.tiles[0];
  for (std::size_t k = 0; k < tile.size(); ++k) {
    for (const double t : {0.1, 0.5, 0.9}) {
      const Eigen::Vector2d on_beam = (1 - t) * tile[k] + t * tile[(k + 1) % tile.size()];
      EXPECT_EQ(testing::windings(structure.tiling, structure.holes, on_beam), 0) << k << " " << t;
    }
  }
}

TEST(Structure, BeamsThatSwallowAHoleAreRefused) {
  // This family is like the square family, but its holes must stay open.
  Family closed = family("square");
  closed.holes_may_close = false;
  closed.parameters[0].preset = 0.03;
  const Error error = expect_error("tiling.hole_closed", [&] { make_structure(closed, std::vector{0.03}); });
  EXPECT_NE(std::string(error.what()).find("0.3 mm"), std::string::npos) << error.what();
  EXPECT_NO_THROW(make_structure(closed, std::vector{0.5}));
}

TEST(Structure, ATilesInsetCanFallApartIntoSeveralHoles) {
  // The waist of this hourglass is narrower than a beam.
  Family hourglass;
  hourglass.id = "hourglass";
  hourglass.beam_width = 0.3;
  hourglass.shape = [](std::span<const double>) {
    Tiling tiling;
    tiling.tiles = {{{0, 0}, {4, 0}, {2.1, 2}, {4, 4}, {0, 4}, {1.9, 2}}};
    tiling.placements = {{}};
    tiling.lattice = 4 * Eigen::Matrix2d::Identity();
    return tiling;
  };
  EXPECT_EQ(holes_in(make_structure(hourglass, {}), 0), 2u);
}

TEST(Structure, HolesHaveSquareCornersAroundReentrantCornersOfTiles) {
  Family notched;
  notched.id = "notched";
  notched.beam_width = 0.3;
  notched.shape = [](std::span<const double>) {
    Tiling tiling;
    const double half = 2 * (std::sqrt(2) - 1);  // half width of the notch's mouth, so that its tip has 45 degrees
    tiling.tiles = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2 + half}, {2, 2}, {0, 2 - half}}};
    tiling.placements = {{}};
    tiling.lattice = 4 * Eigen::Matrix2d::Identity();
    return tiling;
  };
  const Structure structure = make_structure(notched, {});
  ASSERT_EQ(holes_in(structure, 0), 1u);
  // The tip's corner is cut off at half a beam width: one turn of 135 degrees becomes two of 67.5 degrees.
  ASSERT_EQ(structure.holes[0][0].size(), 8u);
  const double reach = 0.15 * std::tan(3 * std::numbers::pi / 16);
  for (const double side : {-1.0, 1.0}) {
    double least = INFINITY;
    for (const Eigen::Vector2d& p : structure.holes[0][0])
      least = std::min(least, (p - Eigen::Vector2d(2 + 0.15, 2 + side * reach)).norm());
    EXPECT_LT(least, 1e-8);
  }
}

TEST(Structure, HolesHaveNoShortSidesAndLieWithinTheirTiles) {
  for (const Family& family : families()) {
    RandomStream random("tiling.holes." + family.id, 2);
    int made = 0;
    for (int design = 0; design < 40; ++design) {
      const auto parameters = random_parameters(family, random, 0.05);
      try {
        const Structure structure = make_structure(family, parameters, 0.05);
        ++made;
        EXPECT_GT(structure.solid_area, 0);
        EXPECT_LT(structure.solid_area, structure.cell_area);
        for (std::size_t placement = 0; placement < structure.holes.size(); ++placement) {
          const Placement& place = structure.tiling.placements[placement];
          const Polygon tile = placed(structure.tiling.tiles[place.tile], place);
          for (const Polygon& hole : structure.holes[placement]) {
            EXPECT_GT(area(hole), 0);
            EXPECT_GE(outline_distance(hole, tile), 0.99 * structure.beam_width / 2);
            for (std::size_t k = 0; k < hole.size(); ++k) {
              EXPECT_GE((hole[(k + 1) % hole.size()] - hole[k]).norm(), 0.005 * structure.beam_width);
              EXPECT_GT(winding_number(tile, hole[k]), 0);
            }
          }
        }
      } catch (const Error& error) {
        EXPECT_TRUE(error.code() == "tiling.cell_too_small" || error.code() == "tiling.hole_closed") << error.code();
      }
    }
    EXPECT_GT(made, 20) << family.id;
  }
}

TEST(CanBeBuilt, AgreesWithTheStructureThatIsMade) {
  int refused = 0;
  for (const Family& family : families()) {
    RandomStream random("can be built " + family.id, 1);
    for (int draw = 0; draw < 60; ++draw) {
      // Half of the parameters are near the lower bounds, where holes close.
      std::vector<double> parameters = random_parameters(family, random);
      if (draw % 2 == 0)
        for (std::size_t k = 0; k < parameters.size(); ++k)
          parameters[k] = family.parameters[k].lower + 0.1 * (parameters[k] - family.parameters[k].lower);
      bool made = true;
      try {
        make_structure(family, parameters);
      } catch (const Error&) {
        made = false;
        ++refused;
      }
      EXPECT_EQ(can_be_built(family, parameters), made) << family.id << " draw " << draw;
    }
    const std::vector<double> beyond(family.parameters.size(), 1e3);
    EXPECT_FALSE(can_be_built(family, beyond)) << family.id;
  }
  EXPECT_GT(refused, 10) << "or nothing was compared";
}

TEST(CanBeBuilt, AgreesWhereHolesAreAboutToClose) {
  // On this line the structure ceases to exist between two of the steps.
  const Family& id = family("IH29");
  int changes = 0;
  bool before = false;
  for (int step = 0; step <= 400; ++step) {
    const std::vector<double> parameters{0.005 + 0.0005 * step};
    bool made = true;
    try {
      make_structure(id, parameters);
    } catch (const Error&) {
      made = false;
    }
    ASSERT_EQ(can_be_built(id, parameters), made) << parameters[0];
    changes += step > 0 && made != before;
    before = made;
  }
  EXPECT_GE(changes, 1);
}

}  // namespace
}  // namespace supple::tiling
