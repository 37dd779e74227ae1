#pragma once

#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A connected part of the plane: its counterclockwise outline, then its clockwise holes.
using Face = std::vector<Polygon>;

/// The points of positive winding number that are farther than `distance` (mm) from the polygon's outline, corners
/// mitred: none, one or several counterclockwise polygons. Pieces narrower than `smallest_width` are left out, sides
/// shorter than it are merged into a point.
std::vector<Polygon> inset(const Polygon& polygon, double distance, double smallest_width);

/// Where the polygon's outline crosses itself it runs backwards around some of its parts: those parts, made larger by
/// `distance` (mm) on all sides, corners mitred up to twice the distance. Counterclockwise; none for a simple polygon.
std::vector<Polygon> folds(const Polygon& polygon, double distance);

/// What remains of a hole outside the given counterclockwise polygons, under the same rules as `inset`.
std::vector<Polygon> hole_outside(const Polygon& hole, const std::vector<Polygon>& solid, double smallest_width);

/// The polygons' union, each first made larger by `distance` (mm) on all sides, without the holes. Sides shorter than
/// `smallest_side` are merged into a point.
std::vector<Face> expanded_union(const std::vector<Polygon>& polygons, double distance,
                                 const std::vector<Polygon>& holes, double smallest_side);

/// What of the polygon lies outside the holes, which may cross its outline but not each other.
std::vector<Face> difference(const Polygon& polygon, const std::vector<Polygon>& holes);

}  // namespace supple::tiling
