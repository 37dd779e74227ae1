#pragma once

#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A region of the plane: counterclockwise outlines, clockwise holes, none crossing another.
using Region = std::vector<Polygon>;

/// The points inside the polygon that are farther than `distance` (mm) from its outline, corners mitred: none, one or
/// several counterclockwise polygons. Pieces narrower than `smallest_width` are left out, sides shorter than it are
/// merged into a point.
std::vector<Polygon> inset(const Polygon& polygon, double distance, double smallest_width);

/// The polygons' union, each first made larger by `distance` (mm) on all sides, without the holes.
Region expanded_union(const std::vector<Polygon>& polygons, double distance, const std::vector<Polygon>& holes);

/// What of the polygon lies outside the holes, which may overlap its outline but not each other.
Region difference(const Polygon& polygon, const std::vector<Polygon>& holes);

}  // namespace supple::tiling
