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

/// The union, intersection or difference of areas whose paths wind around what is solid.
ClipperLib::Paths operation(ClipperLib::ClipType type, const ClipperLib::Paths& subject, const ClipperLib::Paths& clip);

/// The area, grown by a distance (mm) or shrunk where that is negative.
ClipperLib::Paths grown(const ClipperLib::Paths& paths, double by, ClipperLib::JoinType joints);

/// All points within `half_width` (mm) of an open line.
ClipperLib::Paths widened_line(const ClipperLib::Path& line, double half_width);

/// Adds the connected parts of a tree: its outlines are children of even depth, and what lies directly within one are
/// its holes.
void add_faces(const ClipperLib::PolyNode& parent, std::vector<Face>& faces);

/// The union of areas whose paths wind around what is solid, as connected parts with holes, without slivers: polygons
/// narrower than `smallest_width` (mm) are left out, and sides shorter than it become points. Where they do, outlines
/// that run close to each other may cross. Therefore the union is taken again until no side is that short; in the rare
/// case that this never ends, short sides remain after a few times. No outline of the result crosses itself or another
/// one by more than rounding. O(n log n) for few crossings among n sides, besides O(m^2) for a polygon of m sides.
std::vector<Face> faces_without_slivers(const ClipperLib::Paths& paths, double smallest_width);

/// Whether a polygon remains as a hole or an outline after it was simplified: sides shorter than `smallest_width` (mm)
/// became points, and vertices on the line through their neighbours were dropped. Twice the area over the perimeter is
/// the width of a long strip and half that of a square.
bool remains(Polygon& polygon, double smallest_width);

}  // namespace supple::tiling
