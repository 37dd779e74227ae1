#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// An affine function of a family's parameters: constant + sum over k of slopes[k] * p_k, added in this order.
/// Parameters without a slope have no influence.
struct AffineExpression {
  double constant = 0;
  std::vector<double> slopes;

  AffineExpression() = default;
  // These constructors are implicit, so that {1, {0, 0.5}} is a point: a number, and a constant with a slope.
  AffineExpression(double value) : constant(value) {}
  AffineExpression(std::initializer_list<double> constant_and_slopes);

  double operator()(std::span<const double> parameters) const;
  bool operator==(const AffineExpression&) const = default;
};

struct ExpressionPoint {
  AffineExpression x, y;

  bool operator==(const ExpressionPoint&) const = default;
};

/// What an edge of an isohedral tile may look like [Kaplan2009, chapter 3].
enum class EdgeSymmetry {
  any,               ///< J: any curve
  point_symmetric,   ///< S: looks the same after half a turn about its middle
  mirror_symmetric,  ///< U: looks the same after a reflection in its perpendicular bisector
  straight           ///< I: a straight line
};

/// The points of shapes are relative to the chord, the segment between the edge's ends: x runs along it from 0 to 1, y
/// is the distance to its left in chord lengths.
struct StraightEdge {
  bool operator==(const StraightEdge&) const = default;
};

/// Straight pieces from (0, 0) over the points to (1, 0). If the edge is point-symmetric or mirror-symmetric, only the
/// points of its first half are given. A last point with the constant x = 1/2 is the middle of a mirror-symmetric edge.
struct PolylineEdge {
  std::vector<ExpressionPoint> points;

  bool operator==(const PolylineEdge&) const = default;
};

/// The curve y(x) = sum over k of sines[k - 1] * sin(k pi x), drawn as straight pieces of equal extent along the chord.
/// Odd k must be 0 in point-symmetric edges, even k in mirror-symmetric ones.
struct SineEdge {
  std::vector<AffineExpression> sines;
  int pieces = 16;

  bool operator==(const SineEdge&) const = default;
};

/// The shape that one or several edges of the tile have.
struct EdgeShape {
  EdgeSymmetry symmetry = EdgeSymmetry::straight;
  std::variant<StraightEdge, PolylineEdge, SineEdge> line;

  bool operator==(const EdgeShape&) const = default;
};

/// How an edge of the tile, from vertex k to vertex k + 1, has its shape.
struct TileEdge {
  int shape = 0;          ///< index into FamilyDefinition::shapes
  bool turned = false;    ///< by half a turn about the chord's middle, so that it is drawn from its other end
  bool mirrored = false;  ///< reflected in the chord

  bool operator==(const TileEdge&) const = default;
};

/// Where a copy of the tile lies: x -> linear * x + offset, with `linear` row by row.
struct DefinedPlacement {
  std::array<double, 4> linear{1, 0, 0, 1};
  ExpressionPoint offset;

  bool operator==(const DefinedPlacement&) const = default;
};

/// The tile and how its copies fill the plane, in tiling units.
struct TileDefinition {
  std::vector<ExpressionPoint> vertices;  ///< counterclockwise
  std::vector<TileEdge> edges;            ///< one for each vertex, from it to the next; without any all are straight
  std::array<ExpressionPoint, 2> translations;
  std::vector<DefinedPlacement> placements;  ///< the tiles of one cell

  bool operator==(const TileDefinition&) const = default;
};

struct DefinedParameter {
  std::string description;  ///< in words: what changes with it
  Parameter range;

  bool operator==(const DefinedParameter& other) const;
};

/// A family as data: what a family file holds (schema `FamilyDefinition` of the contract).
struct FamilyDefinition {
  std::string id;
  std::string description;
  std::vector<DefinedParameter> parameters;
  AffineExpression beam_width;                      ///< tiling units
  double sufficient_mesh_size = default_mesh_size;  ///< as in Family
  /// Number of the isohedral type that `tile` was taken from, or 0. A file names the type instead of the tile then.
  int isohedral_type = 0;
  TileDefinition tile;
  std::vector<EdgeShape> shapes;

  bool operator==(const FamilyDefinition&) const = default;
};

/// Limits of definitions, which `check_definition` holds.
inline constexpr int max_defined_parameters = 8;
inline constexpr int max_tile_vertices = 12;
inline constexpr int max_placements = 24;  ///< twice as many as any isohedral type has
inline constexpr int max_polyline_points = 32;
inline constexpr int max_sines = 8;
inline constexpr int min_sine_pieces = 2;
inline constexpr int max_sine_pieces = 64;
inline constexpr int max_outline_points = 256;  ///< of a tile with all points of its edges
inline constexpr double max_coordinate = 1000;  ///< tiling units; the greatest coordinate within the box

/// The tiling at parameters, of which there must be as many as the definition has. The definition must be one that
/// `check_definition` finds no structural fault in. Linear in the number of points.
Tiling tiling_at(const FamilyDefinition& definition, std::span<const double> parameters);

/// The family that a definition describes. It keeps a copy of the definition.
Family make_family(FamilyDefinition definition);

/// The definitions of the families that are files (models/families), in the order of `families()`.
const std::vector<FamilyDefinition>& shipped_definitions();

}  // namespace supple::tiling
