#pragma once

#include <span>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A connected part of the plane: its counterclockwise outline, then its clockwise holes.
using Face = std::vector<Polygon>;

/// The sides of a closed outline on which joints fill the corners of beams: a corner where the outline turns away from
/// a side is filled on that side.
enum class Joints {
  left,  ///< the inside of a counterclockwise tile, at its re-entrant corners
  both
};

/// Counterclockwise polygons whose union are the beams along a closed outline: for each side the strip of points beside
/// it within `half_width` (mm), and for each corner a joint that closes the gap between two strips. A joint is square:
/// it is cut off by that tangent to the circle of radius `half_width` around the vertex which is symmetric to both
/// strips, as ClipperLib's jtSquare and the published data [LiCoros2023]. At turns below 15 degrees it is mitred. Sides
/// of no length are left out.
///
/// The union depends continuously on the outline's vertices, even if the outline crosses itself, because beams only add
/// to the solid. There is one exception: the direction of a side whose length vanishes may change the solid around it,
/// by less than a beam width.
std::vector<Polygon> beams_along(const Polygon& outline, double half_width, Joints joints);

/// The holes of the union of counterclockwise polygons, as counterclockwise polygons. Holes narrower than `min_width`
/// (mm) are left out, sides shorter than it are merged into a point. O(n log n) for few crossings among n sides.
std::vector<Polygon> holes_between(std::span<const Polygon> solid, double min_width);

/// The counterclockwise outlines, without holes, of the connected parts of the polygons' union. Parts closer than 1e-6
/// mm are connected.
std::vector<Polygon> outlines_of_union(std::span<const Polygon> polygons);

/// The union of counterclockwise polygons as connected parts with holes, without pieces narrower than `min_width` (mm)
/// and sides shorter than it (see `faces_without_slivers`).
std::vector<Face> faces_of_union(std::span<const Polygon> polygons, double min_width);

/// The polygon without the holes, which may cross its outline but not each other.
std::vector<Face> difference(const Polygon& polygon, const std::vector<Polygon>& holes);

}  // namespace supple::tiling
