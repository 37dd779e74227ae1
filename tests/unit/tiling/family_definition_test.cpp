#include "supple/tiling/family_definition.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "designs.h"
#include "family_expressions.h"
#include "polygon.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {
namespace {

using testing::expressed_families;
using testing::ExpressedFamily;
using testing::random_parameters;
using testing::windings;

// The bits of a tiling's numbers in a fixed order.
std::vector<std::uint64_t> bits(const Tiling& tiling) {
  std::vector<std::uint64_t> result;
  const auto add = [&](const auto& matrix) {
    for (Eigen::Index k = 0; k < matrix.size(); ++k) result.push_back(std::bit_cast<std::uint64_t>(matrix.data()[k]));
  };
  for (const Polygon& tile : tiling.tiles)
    for (const Eigen::Vector2d& vertex : tile) add(vertex);
  for (const Placement& placement : tiling.placements) {
    add(placement.linear);
    add(placement.offset);
  }
  add(tiling.lattice);
  return result;
}

// A unit square, of which opposite sides have the same shape.
FamilyDefinition square_with(const EdgeShape& shape, bool mirrored = false) {
  FamilyDefinition definition;
  definition.id = "own";
  definition.beam_width = 0.1;
  definition.parameters = {{"bend", {-0.3, 0.3, 0.2}}};
  definition.tile = {.vertices = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                     .edges = {{0, false, mirrored}, {1, false, false}, {0, true, mirrored}, {1, true, false}},
                     .translations = {{{1, 0}, {0, 1}}},
                     .placements = {{{{1, 0, 0, 1}}, {0, 0}}}};
  definition.shapes = {shape, {EdgeSymmetry::straight, StraightEdge{}}};
  return definition;
}

// The points of the square's lower side between its ends at p.
Polygon lower_side(const FamilyDefinition& definition, double p) {
  const Polygon tile = tiling_at(definition, std::vector{p}).tiles[0];
  return {tile.begin() + 1, tile.begin() + static_cast<long>(tile.size() - 4) / 2 + 1};
}

void expect_near(const Polygon& points, const Polygon& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t k = 0; k < points.size(); ++k) EXPECT_NEAR((points[k] - expected[k]).norm(), 0, 1e-15) << k;
}

// An edge shape of the symmetry with random inner points.
EdgeShape random_shape(EdgeSymmetry symmetry, RandomStream& random) {
  constexpr double amplitude = 0.05;
  if (symmetry == EdgeSymmetry::straight) return {};
  if (random.uniform() < 0.5) {
    const double x = random.uniform(0.1, 0.4);
    return {symmetry, PolylineEdge{{{x, random.uniform(-amplitude, amplitude)}}}};
  }
  SineEdge curve{{0.0, 0.0, 0.0}, 6};
  for (std::size_t k = 0; k < 3; ++k) {
    const bool odd = k % 2 == 0;
    if (symmetry == EdgeSymmetry::any || (symmetry == EdgeSymmetry::mirror_symmetric) == odd)
      curve.sines[k] = random.uniform(-amplitude, amplitude);
  }
  return {symmetry, curve};
}

// Expects that the placed tiles cover the plane once: the areas of the tiles and of the cell are equal, and so is the
// winding number at each point of a raster of rows x rows points, which has a random offset. A tile that crosses itself
// winds -1 times around its inverted part, which its neighbours cover twice.
void expect_cover(const Tiling& tiling, RandomStream& random, int rows, const std::string& which) {
  const double cell = std::abs(tiling.lattice.determinant());
  std::vector<std::vector<Polygon>> tiles;
  double sum = 0;
  for (const Placement& placement : tiling.placements) {
    tiles.push_back({placed(tiling.tiles[0], placement)});
    sum += area(tiling.tiles[0]);
  }
  ASSERT_NEAR(sum, cell, 1e-10 * cell) << which;
  const Eigen::Vector2d offset(random.uniform(), random.uniform());
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      const Eigen::Vector2d point = tiling.lattice * (offset + Eigen::Vector2d(i, j)) / rows;
      ASSERT_EQ(windings(tiling, tiles, point), 1) << which << " at " << point.transpose();
    }
}

TEST(FamilyFiles, GiveTheSevenFamiliesToTheLastBit) {
  for (const ExpressedFamily& expected : expressed_families()) {
    const Family& found = family(expected.id);
    ASSERT_TRUE(found.definition) << expected.id;
    EXPECT_EQ(found.beam_width, expected.beam_width) << expected.id;
    EXPECT_EQ(found.sufficient_mesh_size, expected.sufficient_mesh_size) << expected.id;
    ASSERT_EQ(found.parameters.size(), expected.parameters.size()) << expected.id;
    for (std::size_t k = 0; k < expected.parameters.size(); ++k) {
      EXPECT_EQ(found.parameters[k].lower, expected.parameters[k].lower) << expected.id << " " << k;
      EXPECT_EQ(found.parameters[k].upper, expected.parameters[k].upper) << expected.id << " " << k;
      EXPECT_EQ(found.parameters[k].preset, expected.parameters[k].preset) << expected.id << " " << k;
      EXPECT_FALSE(found.definition->parameters[k].description.empty()) << expected.id << " " << k;
    }
    EXPECT_EQ(bits(found.shape(presets(found))), bits(evaluate(expected, presets(found)))) << expected.id;
    RandomStream random("tiling.family_files." + expected.id, 1);
    for (int design = 0; design < 1000; ++design) {
      const auto parameters = random_parameters(found, random, 0.3);
      ASSERT_EQ(bits(found.shape(parameters)), bits(evaluate(expected, parameters))) << expected.id << " " << design;
      EXPECT_EQ(beam_width_at(found, parameters), expected.beam_width);
    }
  }
}

TEST(FamilyFiles, AreAllButTheSquare) {
  ASSERT_EQ(shipped_definitions().size() + 1, families().size());
  for (std::size_t k = 0; k < shipped_definitions().size(); ++k) {
    EXPECT_EQ(shipped_definitions()[k].id, families()[k].id);
    EXPECT_EQ(shipped_definitions()[k], *families()[k].definition);
  }
  EXPECT_FALSE(family("square").definition);
}

TEST(IsohedralTypes, AreEightyOneOfWhichTwentySixHaveNoParameter) {
  const std::vector<int> missing = {19, 35, 48, 60, 63, 65, 70, 75, 80, 87, 89, 92};
  std::size_t without = 0, k = 0;
  for (int number = 1; number <= 93; ++number) {
    const bool absent = std::find(missing.begin(), missing.end(), number) != missing.end();
    const IsohedralType* type = find_isohedral_type(number);
    ASSERT_EQ(type == nullptr, absent) << number;
    if (!type) continue;
    EXPECT_EQ(type, &isohedral_types()[k++]);
    EXPECT_EQ(type->number, number);
    EXPECT_EQ(type->tile.edges.size(), type->tile.vertices.size()) << number;
    EXPECT_LE(type->defaults.size(), 6u) << number;
    without += type->defaults.empty();
  }
  EXPECT_EQ(isohedral_types().size(), 81u);
  EXPECT_EQ(without, 26u);
  EXPECT_EQ(find_isohedral_type(0), nullptr);
  EXPECT_EQ(find_isohedral_type(94), nullptr);
}

TEST(IsohedralTypes, CoverThePlaneOnceAtTheirDefaultsAndAround) {
  for (const IsohedralType& type : isohedral_types()) {
    const FamilyDefinition definition = definition_of(type, 0.05, 0.05);
    const Family made = make_family(definition);
    RandomStream random("tiling.isohedral." + definition.id, 1);
    const Tiling preset = tiling_at(definition, type.defaults);
    EXPECT_GT(area(preset.tiles[0]), 0.1) << definition.id << ": vertices are counterclockwise";
    EXPECT_FALSE(self_intersection(preset.tiles[0])) << definition.id;
    expect_cover(preset, random, 15, definition.id);
    for (const Placement& placement : preset.placements)
      EXPECT_TRUE((placement.linear * placement.linear.transpose()).isIdentity(2e-12)) << definition.id;
    for (int design = 0; design < (type.defaults.empty() ? 1 : 1000); ++design)
      expect_cover(tiling_at(definition, random_parameters(made, random)), random, 3, definition.id);
  }
}

TEST(IsohedralTypes, CoverThePlaneOnceWithAnyEdgesOfTheirClasses) {
  for (const IsohedralType& type : isohedral_types()) {
    FamilyDefinition definition = definition_of(type, 0.02, 0.05);
    RandomStream random("tiling.isohedral_edges." + definition.id, 1);
    for (int design = 0; design < 20; ++design) {
      for (std::size_t k = 0; k < type.symmetries.size(); ++k)
        definition.shapes[k] = random_shape(type.symmetries[k], random);
      const Tiling tiling = tiling_at(definition, random_parameters(make_family(definition), random));
      expect_cover(tiling, random, 7, definition.id);
    }
  }
}

TEST(IsohedralTypes, OfTheThesisAreThoseOfItsFamilies) {
  for (const ExpressedFamily& expected : expressed_families()) {
    const IsohedralType* type = find_isohedral_type(std::stoi(expected.id.substr(2)));
    ASSERT_TRUE(type) << expected.id;
    const FamilyDefinition definition = definition_of(*type, 0.05, 0.05);
    const Family& shipped = family(expected.id);
    RandomStream random("tiling.isohedral_thesis." + expected.id, 1);
    for (int design = 0; design < 20; ++design) {
      const auto parameters = random_parameters(shipped, random);
      const Tiling tiling = tiling_at(definition, parameters), reference = evaluate(expected, parameters);
      ASSERT_EQ(tiling.tiles[0].size(), reference.tiles[0].size()) << expected.id;
      // The coefficients of the table have twelve digits.
      for (std::size_t k = 0; k < reference.tiles[0].size(); ++k)
        EXPECT_NEAR((tiling.tiles[0][k] - reference.tiles[0][k]).norm(), 0, 1e-11) << expected.id << " " << k;
      EXPECT_NEAR((tiling.lattice - reference.lattice).norm(), 0, 1e-11) << expected.id;
      ASSERT_EQ(tiling.placements.size(), reference.placements.size()) << expected.id;
      for (std::size_t k = 0; k < reference.placements.size(); ++k) {
        EXPECT_NEAR((tiling.placements[k].linear - reference.placements[k].linear).norm(), 0, 1e-11) << expected.id;
        EXPECT_NEAR((tiling.placements[k].offset - reference.placements[k].offset).norm(), 0, 1e-11) << expected.id;
      }
    }
    EXPECT_EQ(shipped.definition->tile.edges, type->tile.edges) << expected.id;
  }
}

TEST(EdgeShapes, PolylinesAreGivenByTheirFirstHalfWhereTheyAreSymmetric) {
  const PolylineEdge line{{{0.25, {0, 1}}}};  // a point at the height p over a quarter of the chord
  const double p = 0.2;
  expect_near(lower_side(square_with({EdgeSymmetry::any, line}), p), {{0.25, p}});
  expect_near(lower_side(square_with({EdgeSymmetry::point_symmetric, line}), p), {{0.25, p}, {0.5, 0}, {0.75, -p}});
  expect_near(lower_side(square_with({EdgeSymmetry::mirror_symmetric, line}), p), {{0.25, p}, {0.75, p}});
  const PolylineEdge roof{{{0.25, 0.1}, {0.5, {0, 1}}}};
  expect_near(lower_side(square_with({EdgeSymmetry::mirror_symmetric, roof}), p), {{0.25, 0.1}, {0.5, p}, {0.75, 0.1}});
}

TEST(EdgeShapes, AreTurnedAboutTheMiddleAndMirroredInTheChord) {
  const EdgeShape shape{EdgeSymmetry::any, PolylineEdge{{{0.25, {0, 1}}, {0.5, 0.1}}}};
  const double p = 0.2;
  expect_near(lower_side(square_with(shape, true), p), {{0.25, -p}, {0.5, -0.1}});
  FamilyDefinition turned = square_with(shape);
  turned.tile.edges[0].turned = true;
  expect_near(lower_side(turned, p), {{0.5, -0.1}, {0.75, -p}});
  turned.tile.edges[0].mirrored = true;
  expect_near(lower_side(turned, p), {{0.5, 0.1}, {0.75, p}});
}

TEST(EdgeShapes, CurvesAreSumsOfSinesOfTheChord) {
  const FamilyDefinition curved = square_with({EdgeSymmetry::any, SineEdge{{{0, 1}, 0.05}, 4}});
  const double half = std::sqrt(0.5);
  expect_near(lower_side(curved, 0.2), {{0.25, 0.2 * half + 0.05}, {0.5, 0.2}, {0.75, 0.2 * half - 0.05}});
}

TEST(EdgeShapes, ScaleWithTheirChords) {
  FamilyDefinition definition = square_with({EdgeSymmetry::any, PolylineEdge{{{0.5, {0, 1}}}}});
  for (ExpressionPoint* point : {&definition.tile.vertices[1], &definition.tile.vertices[2]}) point->x = 3;
  definition.tile.translations[0].x = 3;
  expect_near(lower_side(definition, 0.1), {{1.5, 0.3}});
}

TEST(BeamWidth, MayDependOnTheParameters) {
  FamilyDefinition definition = square_with({});
  definition.beam_width = {0, 1};
  definition.parameters = {{"width", {0.05, 0.3, 0.2}}};
  const Family made = make_family(definition);
  EXPECT_EQ(made.beam_width, 0.2);
  EXPECT_EQ(beam_width_at(made, std::vector{0.1}), 0.1);
  const Structure slender = make_structure(made, std::vector{0.1});
  EXPECT_NEAR(slender.scale, printed_beam_width / 0.1, 1e-12);
  // A square of side 1 with beams of width w along its sides is solid but for a square of side 1 - w.
  EXPECT_NEAR(slender.solid_area / slender.cell_area, 1 - 0.9 * 0.9, 1e-6);
  EXPECT_TRUE(can_be_built(made, std::vector{0.3}));
}

}  // namespace
}  // namespace supple::tiling
