#include "supple/tiling/family.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <set>

#include "designs.h"
#include "polygon.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;
using supple::testing::places;
using testing::random_parameters;
using testing::windings;

std::vector<std::vector<Polygon>> tiles_of(const Tiling& tiling) {
  std::vector<std::vector<Polygon>> result;
  for (const Placement& placement : tiling.placements)
    result.push_back({placed(tiling.tiles[placement.tile], placement)});
  return result;
}

double tiles_area(const Tiling& tiling) {
  double sum = 0;
  for (const Placement& placement : tiling.placements) sum += area(tiling.tiles[placement.tile]);
  return sum;
}

TEST(Family, TheTableHasSevenIsohedralTypesAndTheSquare) {
  std::vector<std::string> ids;
  for (const Family& family : families()) ids.push_back(family.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67", "square"}));
  for (const Family& family : families()) {
    EXPECT_FALSE(family.description.empty());
    for (const auto& [lower, upper, preset] : family.parameters) {
      EXPECT_LT(lower, upper) << family.id;
      EXPECT_GE(preset, lower) << family.id;
      EXPECT_LE(preset, upper) << family.id;
    }
  }
}

TEST(Family, OfManySlenderBeamsKnowsThatACoarserMeshSuffices) {
  std::vector<std::string> slender;
  for (const Family& family : families()) {
    EXPECT_GE(family.sufficient_mesh_size, default_mesh_size) << family.id;
    if (family.sufficient_mesh_size > default_mesh_size) slender.push_back(family.id);
  }
  EXPECT_EQ(slender, (std::vector<std::string>{"IH21", "IH28", "IH29"}));
}

TEST(Family, ThePlacedTilesCoverThePlaneExactlyOnce) {
  for (const Family& family : families()) {
    RandomStream random("tiling.cover." + family.id, 1);
    for (int design = 0; design < 20; ++design) {
      const auto parameters = random_parameters(family, random);
      const Tiling tiling = family.shape(parameters);
      const double cell = std::abs(tiling.lattice.determinant());
      EXPECT_NEAR(tiles_area(tiling), cell, 1e-9 * cell) << family.id;
      bool crosses = false;
      for (const Polygon& tile : tiling.tiles) crosses |= self_intersection(tile).has_value();
      const auto tiles = tiles_of(tiling);
      for (int sample = 0; sample < 30; ++sample) {
        const Eigen::Vector2d point = tiling.lattice * Eigen::Vector2d(random.uniform(), random.uniform());
        // A tile that crosses itself winds -1 times around its inverted part, which its neighbours cover twice.
        ASSERT_EQ(windings(tiling, tiles, point), 1) << family.id << " at " << point.transpose();
      }
      for (const Polygon& tile : tiling.tiles) {
        EXPECT_TRUE(crosses || area(tile) > 0) << family.id;
      }
    }
  }
}

TEST(Family, PlacementsAreRotationsOrReflections) {
  for (const Family& family : families()) {
    const Tiling tiling = family.shape(presets(family));
    for (const Placement& placement : tiling.placements) {
      EXPECT_TRUE((placement.linear * placement.linear.transpose()).isIdentity(1e-14)) << family.id;
      ASSERT_LT(placement.tile, static_cast<int>(tiling.tiles.size()));
    }
  }
}

TEST(Family, TilesOfOneCellAreThoseOfTheReference) {
  const std::vector<std::size_t> expected = {1, 6, 2, 4, 4, 4, 2, 3};
  for (std::size_t k = 0; k < families().size(); ++k) {
    const Family& family = families()[k];
    EXPECT_EQ(family.shape(presets(family)).placements.size(), expected[k]) << family.id;
  }
}

TEST(Family, TheSquareFamilyIsASquareAndTwoHexagonsButAtItsSingularParameters) {
  const Family& square = family("square");
  const auto sizes = [&](double p) {
    std::vector<std::size_t> result;
    for (const Polygon& tile : tiling_of(square, std::vector{p}).tiles) result.push_back(tile.size());
    return result;
  };
  EXPECT_EQ(sizes(0.5), (std::vector<std::size_t>{4, 6}));
  EXPECT_EQ(sizes(-0.5), (std::vector<std::size_t>{4, 6}));
  EXPECT_EQ(sizes(0), std::vector<std::size_t>{4});  // two crossing diagonals: diamonds
  EXPECT_EQ(sizes(1), std::vector<std::size_t>{4});  // the square alone
  EXPECT_EQ(sizes(-1), std::vector<std::size_t>{4});
  EXPECT_EQ(area(tiling_of(square, std::vector{0.5}).tiles[0]), 1);
}

TEST(Family, BeyondItsBoxTheSquareStaysTheCell) {
  const Tiling tiling = tiling_of(family("square"), std::vector{1.1}, 0.1);
  ASSERT_EQ(tiling.tiles.size(), 1u);
  EXPECT_EQ(area(tiling.tiles[0]), 4);
}

TEST(Family, AnUnknownFamilyIsRefusedWithTheKnownOnes) {
  const Error error = expect_error<FamilyNotFound>("tiling.family_not_found", [] { family("IH99"); });
  EXPECT_NE(std::string(error.what()).find("IH99"), std::string::npos);
  EXPECT_NE(std::string(error.what()).find("IH01, IH21, IH22, IH28, IH29, IH50, IH67, square"), std::string::npos);
}

TEST(Family, TheNumberOfParametersIsChecked) {
  const Error error = expect_error("tiling.parameter_count", [] { tiling_of(family("IH01"), std::vector{0.1, 0.5}); });
  EXPECT_EQ(places(error), std::vector<std::string>{"parameters"});
  EXPECT_NE(std::string(error.what()).find("4 parameters, but 2 were given"), std::string::npos) << error.what();
}

TEST(Family, EachParameterOutOfBoundsIsNamedWithItsBoundsAndValue) {
  const Error error = expect_error("tiling.parameter_out_of_bounds", [] {
    tiling_of(family("IH01"), std::vector{0.2, 0.9, 0.1, std::numeric_limits<double>::quiet_NaN()});
  });
  EXPECT_EQ(places(error), (std::vector<std::string>{"parameters/1", "parameters/3"}));
  EXPECT_EQ(error.details()[0].message, "must lie between 0.25 and 0.75, but is 0.9");
}

TEST(Family, AMarginWidensTheBox) {
  const Family& type = family("IH01");
  const std::vector<double> outside = {0.2, 0.78, 0.12, 0.6};
  expect_error("tiling.parameter_out_of_bounds", [&] { tiling_of(type, outside); });
  expect_error("tiling.parameter_out_of_bounds", [&] { tiling_of(type, outside, 0.05); });
  EXPECT_NO_THROW(tiling_of(type, outside, 0.1));
}

TEST(Family, ATileFarSmallerThanTheDefaultIsRefused) {
  const Error error = expect_error("tiling.cell_too_small", [] { tiling_of(family("IH29"), std::vector{0.02}); });
  EXPECT_NE(std::string(error.what()).find("10 %"), std::string::npos) << error.what();
}

TEST(SelfIntersection, NamesTheSidesThatCrossTouchOrFold) {
  using Sides = std::pair<int, int>;
  EXPECT_EQ(self_intersection({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), std::nullopt);
  EXPECT_EQ(self_intersection({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), Sides(0, 2));          // bow tie
  EXPECT_EQ(self_intersection({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}), Sides(0, 2));  // a vertex on a side
  EXPECT_EQ(self_intersection({{0, 0}, {2, 0}, {1, 0}, {1, 1}}), Sides(0, 1));          // folds back
  EXPECT_EQ(self_intersection({{0, 0}, {1, 0}, {1, 0}, {1, 1}}), Sides(0, 1));          // no length
}

}  // namespace
}  // namespace supple::tiling
