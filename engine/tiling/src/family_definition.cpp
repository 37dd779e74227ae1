#include "supple/tiling/family_definition.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <utility>

#include "defined_outline.h"

namespace supple::tiling {
namespace {

Eigen::Vector2d evaluate(const ExpressionPoint& point, std::span<const double> parameters) {
  return {point.x(parameters), point.y(parameters)};
}

/// Inner points of an edge, relative to its chord.
using ChordPoints = std::vector<Eigen::Vector2d>;

/// The second half of an edge of which the first half is given.
void complete(EdgeSymmetry symmetry, const PolylineEdge& line, ChordPoints& points) {
  ChordPoints rest(points.rbegin(), points.rend());
  if (symmetry == EdgeSymmetry::point_symmetric) {
    for (Eigen::Vector2d& point : rest) point = {1 - point.x(), -point.y()};
    points.emplace_back(0.5, 0);
  } else {
    const AffineExpression middle = 0.5;
    if (!line.points.empty() && line.points.back().x == middle) rest.erase(rest.begin());
    for (Eigen::Vector2d& point : rest) point.x() = 1 - point.x();
  }
  points.insert(points.end(), rest.begin(), rest.end());
}

ChordPoints inner_points(const EdgeShape& shape, std::span<const double> parameters) {
  ChordPoints points;
  if (const auto* line = std::get_if<PolylineEdge>(&shape.line)) {
    for (const ExpressionPoint& point : line->points) points.push_back(evaluate(point, parameters));
    if (shape.symmetry == EdgeSymmetry::point_symmetric || shape.symmetry == EdgeSymmetry::mirror_symmetric)
      complete(shape.symmetry, *line, points);
  } else if (const auto* curve = std::get_if<SineEdge>(&shape.line)) {
    std::vector<double> amplitudes;
    for (const AffineExpression& sine : curve->sines) amplitudes.push_back(sine(parameters));
    for (int i = 1; i < curve->pieces; ++i) {
      const double x = static_cast<double>(i) / curve->pieces;
      double y = 0;
      for (std::size_t k = 0; k < amplitudes.size(); ++k)
        y += amplitudes[k] * std::sin(static_cast<double>(k + 1) * std::numbers::pi * x);
      points.emplace_back(x, y);
    }
  }
  return points;
}

void orient(const TileEdge& edge, ChordPoints& points) {
  if (edge.turned) {
    std::reverse(points.begin(), points.end());
    for (Eigen::Vector2d& point : points) point = {1 - point.x(), -point.y()};
  }
  if (edge.mirrored)
    for (Eigen::Vector2d& point : points) point.y() = -point.y();
}

Polygon outline(const FamilyDefinition& definition, std::span<const double> parameters) {
  std::vector<ChordPoints> shapes;
  for (const EdgeShape& shape : definition.shapes) shapes.push_back(inner_points(shape, parameters));
  Polygon vertices, result;
  for (const ExpressionPoint& vertex : definition.tile.vertices) vertices.push_back(evaluate(vertex, parameters));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    result.push_back(vertices[k]);
    if (definition.tile.edges.empty()) continue;
    const TileEdge& edge = definition.tile.edges[k];
    ChordPoints points = shapes[static_cast<std::size_t>(edge.shape)];
    orient(edge, points);
    const Eigen::Vector2d chord = vertices[(k + 1) % vertices.size()] - vertices[k];
    const Eigen::Vector2d left(-chord.y(), chord.x());
    for (const Eigen::Vector2d& point : points) result.emplace_back(vertices[k] + point.x() * chord + point.y() * left);
  }
  return result;
}

}  // namespace

AffineExpression::AffineExpression(std::initializer_list<double> constant_and_slopes) {
  if (constant_and_slopes.size() == 0) return;
  constant = *constant_and_slopes.begin();
  slopes.assign(std::next(constant_and_slopes.begin()), constant_and_slopes.end());
}

double AffineExpression::operator()(std::span<const double> parameters) const {
  double value = constant;
  for (std::size_t k = 0; k < slopes.size(); ++k) value += slopes[k] * parameters[k];
  return value;
}

bool DefinedParameter::operator==(const DefinedParameter& other) const {
  return description == other.description && range.lower == other.range.lower && range.upper == other.range.upper &&
         range.preset == other.range.preset;
}

std::vector<std::size_t> edge_starts(const FamilyDefinition& definition) {
  std::vector<double> parameters;
  for (const DefinedParameter& parameter : definition.parameters) parameters.push_back(parameter.range.preset);
  std::vector<std::size_t> starts{0};
  for (std::size_t k = 0; k < definition.tile.vertices.size(); ++k) {
    std::size_t points = 1;
    if (!definition.tile.edges.empty()) {
      const auto shape = static_cast<std::size_t>(definition.tile.edges[k].shape);
      points += inner_points(definition.shapes[shape], parameters).size();
    }
    starts.push_back(starts.back() + points);
  }
  return starts;
}

Tiling tiling_at(const FamilyDefinition& definition, std::span<const double> parameters) {
  Tiling tiling;
  tiling.tiles.push_back(outline(definition, parameters));
  for (const DefinedPlacement& placement : definition.tile.placements) {
    const auto& [a, b, c, d] = placement.linear;
    tiling.placements.push_back(
        {.tile = 0, .linear = Eigen::Matrix2d{{a, b}, {c, d}}, .offset = evaluate(placement.offset, parameters)});
  }
  for (int k = 0; k < 2; ++k)
    tiling.lattice.col(k) = evaluate(definition.tile.translations[static_cast<std::size_t>(k)], parameters);
  return tiling;
}

Family make_family(FamilyDefinition definition) {
  const auto shared = std::make_shared<const FamilyDefinition>(std::move(definition));
  Family family{.id = shared->id,
                .description = shared->description,
                .parameters = {},
                .sufficient_mesh_size = shared->sufficient_mesh_size,
                .shape = [shared](std::span<const double> parameters) { return tiling_at(*shared, parameters); },
                .definition = shared};
  for (const DefinedParameter& parameter : shared->parameters) family.parameters.push_back(parameter.range);
  family.beam_width = shared->beam_width(presets(family));
  return family;
}

}  // namespace supple::tiling
