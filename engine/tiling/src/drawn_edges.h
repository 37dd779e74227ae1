#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {

/// The line of an edge relative to its chord, as in PolylineEdge, with both ends.
using ChordLine = std::vector<Eigen::Vector2d>;

/// The line from corner `begin` to corner `end` of an outline, as the edge's shape has it: what the edge turns and
/// mirrors is undone. O(points).
ChordLine shape_line(const Polygon& outline, std::size_t begin, std::size_t end, const TileEdge& edge);

/// The greatest distance of a corner of one line from the other one, in chord lengths. O(points of one times points of
/// the other).
double line_distance(const ChordLine& a, const ChordLine& b);

/// The greatest distance of an edge from its image under the symmetry of its class, in chord lengths.
double symmetry_misfit(EdgeSymmetry symmetry, const ChordLine& line);

/// The shape that a line has, with as few points as keep its form, and at most `max_points` along the whole edge.
EdgeShape shape_of_line(EdgeSymmetry symmetry, const ChordLine& line, int max_points);

}  // namespace supple::tiling
