#pragma once

#include <span>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A connected part of the plane: its counterclockwise outline, then its clockwise holes.
using Face = std::vector<Polygon>;

/// On which side of a closed outline the corners of its beams are filled: where the outline turns away from the side.
enum class Joints {
  left,  ///< the tile's own side, if it is counterclockwise: its re-entrant corners
  both
};

/// The beams along a closed outline as counterclockwise polygons, whose union they are: for each side the strip of
/// points beside it within `half_width` (mm), and for each corner a joint that closes the gap between two strips. A
/// joint is square: cut off by the tangent to the circle of radius `half_width` around the vertex that is symmetric to
/// both strips, as ClipperLib's jtSquare and as in the data published with Neural Metamaterial Networks. Turns below 15
/// degrees are mitred. Sides of no length are left out.
///
/// All that is made of beams is continuous in the outline's vertices, also where the outline crosses itself: beams only
/// ever add to the solid. The exception is the direction of a side that shrinks to nothing, in a corner that has moved
/// by less than a beam width then.
std::vector<Polygon> beams_along(const Polygon& outline, double half_width, Joints joints);

/// What the union of counterclockwise polygons leaves of the plane, but for its unbounded part: counterclockwise.
/// Pieces narrower than `smallest_width` (mm) are left out, sides shorter than it are merged into a point. O(n log n)
/// for few crossings among n sides.
std::vector<Polygon> holes_between(std::span<const Polygon> solid, double smallest_width);

/// The polygons' union, which makes no difference between parts closer than 1e-6 mm: the outlines of its parts,
/// counterclockwise, without their holes.
std::vector<Polygon> outlines_of_union(std::span<const Polygon> polygons);

/// The union of counterclockwise polygons as connected parts with holes, without pieces narrower than `smallest_width`
/// (mm) and sides shorter than it (see `faces_without_slivers`).
std::vector<Face> faces_of_union(std::span<const Polygon> polygons, double smallest_width);

/// What of the polygon lies outside the holes, which may cross its outline but not each other.
std::vector<Face> difference(const Polygon& polygon, const std::vector<Polygon>& holes);

}  // namespace supple::tiling
