#pragma once

#include <polyclipping/clipper.hpp>
#include <span>
#include <vector>

#include "beams.h"

// Polygons in millimetres and Clipper's paths; only the files that call Clipper see this.
namespace supple::tiling {

/// Clipper computes in integers, whose unit is 1e-9 mm: below every tolerance used on its results, and patches of a
/// metre stay a million times below the 4.6e18 that Clipper can hold.
inline constexpr double units_per_millimetre = 1e9;

ClipperLib::Path to_path(const Polygon& polygon);
ClipperLib::Paths to_paths(std::span<const Polygon> polygons);
Polygon to_polygon(const ClipperLib::Path& path);

/// Adds the connected parts of a tree: its outlines are children of even depth, and what lies directly within one are
/// its holes.
void add_faces(const ClipperLib::PolyNode& parent, std::vector<Face>& faces);

/// Whether a polygon remains as a hole or an outline after it was simplified: sides shorter than `smallest_width` (mm)
/// became points, and vertices on the line through their neighbours were dropped. Twice the area over the perimeter is
/// the width of a long strip and half that of a square.
bool remains(Polygon& polygon, double smallest_width);

}  // namespace supple::tiling
