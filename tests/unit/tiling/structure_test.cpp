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
using testing::presets;
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

std::size_t holes_in(const Structure& structure, int tile) { return structure.holes[tile].size(); }

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
        for (const Placement& other : tiling.placements) {
          for (int i = -4; i <= 4; ++i) {
            for (int j = -4; j <= 4; ++j) {
              Placement moved = other;
              moved.offset += tiling.lattice * Eigen::Vector2d(i, j);
              for (const Polygon& hole : structure.holes[other.tile]) {
                distances.push_back(distance_to_outline(placed(hole, moved), middle));
              }
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
    // Beams overlap where they meet: the default tiles are large against their width.
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

TEST(Structure, HolesOfTheSquareFamilyCloseAtHalfABeamWidth) {
  const auto at = [](double p) { return make_structure(family("square"), std::vector{p}); };
  // Holes narrower than half a percent of the beam width are closed: 0.0005 in the parameter.
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
  // Two diagonals, which share a square at the centre and one at the corners.
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

TEST(Structure, TilesMayCrossThemselvesWhereBeamsHideIt) {
  // A vertex of the tile lies just beyond a side.
  const std::vector<double> hidden = {0.1802089117, 0.5506587018, 0.09055189846, 0.778137};
  const Structure structure = make_structure(family("IH01"), hidden);
  EXPECT_TRUE(structure.tiles_cross);
  EXPECT_EQ(holes_in(structure, 0), 1u);
  EXPECT_FALSE(preset_structure("IH01").tiles_cross);
}

TEST(Structure, BeamsOfFoldedPartsAreKept) {
  // The upper side of the trapezoid is so short that its neighbours cross before they reach it.
  const Structure structure = make_structure(family("IH67"), std::vector{0.2341, 1.0539});
  EXPECT_TRUE(structure.tiles_cross);
  const Polygon& tile = structure.tiling.tiles[0];
  for (std::size_t k = 0; k < tile.size(); ++k) {
    for (const double t : {0.1, 0.5, 0.9}) {
      const Eigen::Vector2d on_beam = (1 - t) * tile[k] + t * tile[(k + 1) % tile.size()];
      EXPECT_EQ(testing::winding_number(structure.tiling, structure.holes, on_beam), 0) << k << " " << t;
    }
  }
}

TEST(Structure, TilesThatCrossThemselvesAndLeaveThinBeamsAreRefusedWithTheSides) {
  // A square with a twisted corner, whose copies come too close to each other.
  Family twisted;
  twisted.id = "twisted";
  twisted.beam_width = 0.3;
  double period = 0;
  twisted.shape = [&period](std::span<const double>) {
    Tiling tiling;
    tiling.tiles = {{{0, 0}, {4, 0}, {4, 4}, {0, 3.9}, {0.1, 4}}};
    tiling.placements = {{}};
    tiling.lattice = period * Eigen::Matrix2d::Identity();
    return tiling;
  };
  period = 4.1;
  EXPECT_TRUE(make_structure(twisted, {}).tiles_cross);
  period = 3.8;
  const Error error = expect_error("tiling.self_intersecting", [&] { make_structure(twisted, {}); });
  EXPECT_NE(std::string(error.what()).find("sides 2 and 4"), std::string::npos) << error.what();
}

TEST(Structure, BeamsThatSwallowAHoleAreRefused) {
  // Of a family like the square's, but in which holes must stay open.
  Family closed = family("square");
  closed.holes_may_close = false;
  closed.parameters[0].preset = 0.03;
  const Error error = expect_error("tiling.hole_closed", [&] { make_structure(closed, std::vector{0.03}); });
  EXPECT_NE(std::string(error.what()).find("0.3 mm"), std::string::npos) << error.what();
  EXPECT_NO_THROW(make_structure(closed, std::vector{0.5}));
}

TEST(Structure, ATilesInsetCanFallApartIntoSeveralHoles) {
  // An hourglass whose waist is narrower than a beam.
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

TEST(Structure, HolesHaveMitredCornersAroundReentrantCornersOfTiles) {
  Family notched;
  notched.id = "notched";
  notched.beam_width = 0.3;
  notched.shape = [](std::span<const double>) {
    Tiling tiling;
    const double half = 2 * (std::sqrt(2) - 1);  // of the notch's mouth: its tip has 45 degrees
    tiling.tiles = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2 + half}, {2, 2}, {0, 2 - half}}};
    tiling.placements = {{}};
    tiling.lattice = 4 * Eigen::Matrix2d::Identity();
    return tiling;
  };
  const Structure structure = make_structure(notched, {});
  ASSERT_EQ(holes_in(structure, 0), 1u);
  ASSERT_EQ(structure.holes[0][0].size(), 7u);
  double least = INFINITY;
  const Eigen::Vector2d mitre(2 + 0.15 / std::sin(std::numbers::pi / 8), 2);
  for (const Eigen::Vector2d& p : structure.holes[0][0]) least = std::min(least, (p - mitre).norm());
  EXPECT_LT(least, 1e-8);
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
        for (std::size_t tile = 0; tile < structure.holes.size(); ++tile) {
          for (const Polygon& hole : structure.holes[tile]) {
            EXPECT_GT(area(hole), 0);
            EXPECT_GE(outline_distance(hole, structure.tiling.tiles[tile]), 0.99 * structure.beam_width / 2);
            for (std::size_t k = 0; k < hole.size(); ++k) {
              EXPECT_GE((hole[(k + 1) % hole.size()] - hole[k]).norm(), 0.005 * structure.beam_width);
              EXPECT_EQ(testing::winding_number(structure.tiling.tiles[tile], hole[k]), 1);
            }
          }
        }
      } catch (const Error& error) {
        EXPECT_TRUE(error.code() == "tiling.self_intersecting" || error.code() == "tiling.cell_too_small" ||
                    error.code() == "tiling.hole_closed")
            << error.code();
      }
    }
    EXPECT_GT(made, 20) << family.id;
  }
}

}  // namespace
}  // namespace supple::tiling
