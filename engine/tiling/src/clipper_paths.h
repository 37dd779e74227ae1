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

/// The union, intersection or difference of two areas, which the nonzero rule fills.
ClipperLib::Paths operation(ClipperLib::ClipType type, const ClipperLib::Paths& subject, const ClipperLib::Paths& clip);

/// The area offset by a distance (mm): it grows, or shrinks if the distance is negative.
ClipperLib::Paths grown(const ClipperLib::Paths& paths, double distance, ClipperLib::JoinType joints);

/// All points within `half_width` (mm) of an open line.
ClipperLib::Paths widened_line(const ClipperLib::Path& line, double half_width);

/// Adds the connected parts of a tree. Its children and further descendants at even depth are outlines; the children of
/// an outline are its holes.
void add_faces(const ClipperLib::PolyNode& parent, std::vector<Face>& faces);

/// The area that the nonzero rule fills, as connected parts with holes, without slivers: polygons narrower than
/// `min_width` (mm) are left out, and sides shorter than it become points. This may make outlines that run close to
/// each other cross. Therefore the union is taken again until no side is that short. In rare cases this would not
/// terminate, and short sides remain after 16 unions. No outline of the result crosses itself or another one by more
/// than rounding. O(n log n) for few crossings among n sides, besides O(m^2) for a polygon of m sides.
std::vector<Face> faces_without_slivers(const ClipperLib::Paths& paths, double min_width);

/// Simplifies a polygon: sides shorter than `min_width` (mm) become points, and vertices on the line through their
/// neighbours are dropped. Returns whether it remains as a hole or an outline: twice its area over its perimeter, which
/// is the width of a long strip and half that of a square, must exceed `min_width`.
bool remains(Polygon& polygon, double min_width);

}  // namespace supple::tiling
