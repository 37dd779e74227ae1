#include "supple/tiling/tile_drawing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "polygon.h"
#include "supple/base/random.h"
#include "supple/tiling/definition_check.h"
#include "supple/tiling/isohedral_types.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

std::vector<double> presets_of(const FamilyDefinition& definition) {
  std::vector<double> presets;
  for (const auto& parameter : definition.parameters) presets.push_back(parameter.range.preset);
  return presets;
}

// A curve that each class of edges may have, which is flat enough for all tiles.
EdgeShape curve_of(EdgeSymmetry symmetry) {
  switch (symmetry) {
    case EdgeSymmetry::any:
      return {symmetry, SineEdge{{0.03, 0.02}, 40}};
    case EdgeSymmetry::point_symmetric:
      return {symmetry, SineEdge{{0, 0.03}, 40}};
    case EdgeSymmetry::mirror_symmetric:
      return {symmetry, SineEdge{{0.03}, 40}};
    default:
      return {symmetry, StraightEdge{}};
  }
}

FamilyDefinition curved(const IsohedralType& type) {
  FamilyDefinition definition = definition_of(type, 0.05, 0.05);
  for (auto& shape : definition.shapes) shape = curve_of(shape.symmetry);
  return definition;
}

// The outline somewhere else on the paper, turned, larger, and reflected if `mirror` is -1.
Polygon on_paper(Polygon outline, double mirror, std::size_t first) {
  const Eigen::Rotation2Dd turn(0.7);
  for (auto& point : outline) {
    point.y() *= mirror;
    point = 37 * (turn * point) + Eigen::Vector2d(120, -40);
  }
  std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(first % outline.size()), outline.end());
  return outline;
}

// The greatest distance of a point of one outline from the other, where the second is moved as little as possible: both
// are compared by their centroids, areas and distances from the centroid.
double difference_in_form(const Polygon& a, const Polygon& b) {
  return std::abs(perimeter(a) / std::sqrt(std::abs(area(a))) - perimeter(b) / std::sqrt(std::abs(area(b))));
}

std::string message_of(const TileDrawing& drawing) {
  try {
    definition_of_drawing(drawing);
  } catch (const TilingError& error) {
    EXPECT_EQ(error.code(), "tiling.drawing");
    EXPECT_EQ(error.details().at(0).where, "svg");
    return error.what();
  }
  return "";
}

TEST(TileDrawing, TheStraightTileOfEachTypeGivesItsParametersBack) {
  int with_corners = 0;
  for (const IsohedralType& type : isohedral_types()) {
    const FamilyDefinition drawn = definition_of(type, 0.05, 0.05);
    const Polygon tile = tiling_at(drawn, presets_of(drawn)).tiles.front();
    TileDrawing drawing{.outline = on_paper(tile, 1, 2), .isohedral_type = type.number, .id = "own", .description = ""};
    FamilyDefinition found;
    try {
      found = definition_of_drawing(drawing);
    } catch (const TilingError&) {
      continue;  // two sides of the tile are one line at the table's defaults
    }
    ++with_corners;
    EXPECT_LT(difference_in_form(tile, tiling_at(found, presets_of(found)).tiles.front()), 1e-6) << type.number;
    const auto report = check_definition(found);
    EXPECT_TRUE(report.good()) << type.number << ": " << (report.good() ? "" : report.faults[0].message);
  }
  EXPECT_GE(with_corners, 60);
}

TEST(TileDrawing, BoundsEndBeforeTheTileVanishes) {
  // A parameter of IH51 moves vertices by ten times its change, so that its unit square vanishes at a change of 0.05.
  const Polygon square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const Polygon flat{{0, 0}, {10, 0}, {11, 2}, {1, 2}};
  const std::pair<int, const Polygon&> tiles[] = {{51, square}, {41, flat}};
  for (const auto& [type, tile] : tiles) {
    const TileDrawing drawing{.outline = tile, .isohedral_type = type, .id = "own", .description = "", .reach = 0.5};
    const FamilyDefinition found = definition_of_drawing(drawing);
    const auto report = check_definition(found);
    EXPECT_TRUE(report.good()) << type << ": " << (report.good() ? "" : report.faults[0].message);
    for (const auto& parameter : found.parameters) {
      EXPECT_GT(parameter.range.upper - parameter.range.preset, 1e-3) << type;
      EXPECT_LT(parameter.range.upper - parameter.range.preset, 0.4) << type;
      EXPECT_NEAR(parameter.range.lower + parameter.range.upper, 2 * parameter.range.preset, 1e-12) << type;
    }
  }
}

TEST(TileDrawing, ACurvedTileIsFoundWhicheverWayItIsDrawn) {
  for (const int number : {1, 4, 21, 28, 29, 41, 50, 67}) {
    const IsohedralType& type = *find_isohedral_type(number);
    const FamilyDefinition drawn = curved(type);
    const Polygon tile = tiling_at(drawn, presets_of(drawn)).tiles.front();
    for (const double mirror : {1.0, -1.0}) {
      const TileDrawing drawing{
          .outline = on_paper(tile, mirror, 17), .isohedral_type = number, .id = "own", .description = "Drawn"};
      FamilyDefinition found;
      ASSERT_NO_THROW(found = definition_of_drawing(drawing)) << number;
      EXPECT_EQ(found.id, "own");
      EXPECT_LT(difference_in_form(tile, tiling_at(found, presets_of(found)).tiles.front()), 0.02) << number;
      const auto report = check_definition(found);
      EXPECT_TRUE(report.good()) << number << ": " << (report.good() ? "" : report.faults[0].message);
    }
  }
}

TEST(TileDrawing, HeightsOfCurvesBecomeParameters) {
  const FamilyDefinition drawn = curved(*find_isohedral_type(29));
  TileDrawing drawing{.outline = tiling_at(drawn, presets_of(drawn)).tiles.front(),
                      .isohedral_type = 29,
                      .id = "own",
                      .description = "",
                      .has_shape_parameters = true};
  const FamilyDefinition found = definition_of_drawing(drawing);
  EXPECT_GT(found.parameters.size(), drawn.parameters.size());
  EXPECT_EQ(found.parameters.back().range.preset, 1);
  EXPECT_TRUE(check_definition(found).good());
}

TEST(TileDrawing, WhatDoesNotFitIsSaid) {
  const Polygon square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const auto says = [](const std::string& message, const char* part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(message_of({.outline = square, .isohedral_type = 1, .id = "own", .description = ""}), "has 4 corners");
  says(message_of({.outline = square, .isohedral_type = 2222, .id = "own", .description = ""}), "no isohedral type");
  const Polygon kite{{0, 0}, {10, 0}, {14, 13}, {0, 6}};
  says(message_of({.outline = kite, .isohedral_type = 41, .id = "own", .description = ""}),
       "the best choice deviates by");
  Polygon bent;  // its lower side is bent and its upper one is not
  for (int k = 0; k < 20; ++k) bent.emplace_back(0.5 * k, std::sin(0.05 * M_PI * k));
  bent.insert(bent.end(), {{10, 0}, {10, 10}, {0, 10}});
  says(message_of({.outline = bent, .isohedral_type = 41, .id = "own", .description = ""}),
       "has the shape of the edge from");
}

}  // namespace
}  // namespace supple::tiling
