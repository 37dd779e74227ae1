#include "offset.h"

#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>
#include <utility>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Clipper computes in integers, whose unit is 1e-9 mm: below every tolerance used on its results, and patches of a
/// metre stay a million times below the 4.6e18 that Clipper can hold.
constexpr double units_per_millimetre = 1e9;

/// Mitres longer than this many offset distances are cut off: only tips below 5.8 degrees, which tiles get when they
/// are about to fold back onto themselves.
constexpr double mitre_limit = 20;

/// The beams of a folded part are mitred no farther than this: the rule of the published data.
constexpr double fold_mitre_limit = 2;

/// The same around the rim of a patch, whose sharp corners carry no load.
constexpr double outer_mitre_limit = 2;

/// Vertices closer than this (mm) to the line through their neighbours are no corners.
constexpr double straightness = 1e-7;

ClipperLib::Path to_path(const Polygon& polygon) {
  ClipperLib::Path path;
  path.reserve(polygon.size());
  for (const Eigen::Vector2d& p : polygon) {
    path.emplace_back(std::llround(p.x() * units_per_millimetre), std::llround(p.y() * units_per_millimetre));
  }
  return path;
}

Polygon to_polygon(const ClipperLib::Path& path) {
  Polygon polygon;
  polygon.reserve(path.size());
  for (const ClipperLib::IntPoint& p : path) {
    polygon.emplace_back(static_cast<double>(p.X) / units_per_millimetre,
                         static_cast<double>(p.Y) / units_per_millimetre);
  }
  return polygon;
}

// The outlines of a tree are its children of even depth; what lies directly within one are its holes.
void add_faces(const ClipperLib::PolyNode& parent, std::vector<Face>& faces) {
  for (const ClipperLib::PolyNode* outline : parent.Childs) {
    Face face = {to_polygon(outline->Contour)};
    for (const ClipperLib::PolyNode* hole : outline->Childs) face.push_back(to_polygon(hole->Contour));
    faces.push_back(std::move(face));
    for (const ClipperLib::PolyNode* hole : outline->Childs) add_faces(*hole, faces);
  }
}

std::vector<Face> without(const ClipperLib::Paths& paths, const std::vector<Polygon>& holes) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(paths, ClipperLib::ptSubject, true);
  for (const Polygon& hole : holes) clipper.AddPath(to_path(hole), ClipperLib::ptClip, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctDifference, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  std::vector<Face> faces;
  add_faces(tree, faces);
  return faces;
}

ClipperLib::Paths offset(const ClipperLib::Paths& paths, double distance, double limit) {
  ClipperLib::ClipperOffset clipper(limit);
  clipper.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
  ClipperLib::Paths result;
  clipper.Execute(result, distance * units_per_millimetre);
  return result;
}

/// Merges the ends of the shortest side until none is shorter than `smallest_side`; then drops straight vertices.
void simplify(Polygon& polygon, double smallest_side) {
  while (polygon.size() > 2) {
    std::size_t shortest = 0;
    double length = INFINITY;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const double candidate = (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
      if (candidate < length) {
        length = candidate;
        shortest = k;
      }
    }
    if (length >= smallest_side) break;
    const std::size_t next = (shortest + 1) % polygon.size();
    polygon[shortest] = (polygon[shortest] + polygon[next]) / 2;
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(next));
  }
  for (std::size_t k = 0; k < polygon.size() && polygon.size() > 2;) {
    const Eigen::Vector2d& before = polygon[(k + polygon.size() - 1) % polygon.size()];
    const Eigen::Vector2d& after = polygon[(k + 1) % polygon.size()];
    if (std::abs(cross(after - before, polygon[k] - before)) < straightness * (after - before).norm()) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
}

std::vector<Polygon> to_holes(const ClipperLib::Paths& paths, double smallest_width) {
  std::vector<Polygon> result;
  for (const ClipperLib::Path& path : paths) {
    Polygon hole = to_polygon(path);
    simplify(hole, smallest_width);
    // Twice the area over the perimeter is the width of a long strip and half that of a square.
    if (hole.size() > 2 && 2 * area(hole) > smallest_width * perimeter(hole)) result.push_back(std::move(hole));
  }
  return result;
}

}  // namespace

std::vector<Polygon> inset(const Polygon& polygon, double distance, double smallest_width) {
  return to_holes(offset({to_path(polygon)}, -distance, mitre_limit), smallest_width);
}

std::vector<Polygon> folds(const Polygon& polygon, double distance) {
  ClipperLib::Clipper clipper;
  clipper.AddPath(to_path(polygon), ClipperLib::ptSubject, true);
  ClipperLib::Paths backwards;
  clipper.Execute(ClipperLib::ctUnion, backwards, ClipperLib::pftNegative, ClipperLib::pftNegative);
  std::vector<Polygon> result;
  for (ClipperLib::Path& path : backwards) {
    if (!ClipperLib::Orientation(path)) ClipperLib::ReversePath(path);
    for (const ClipperLib::Path& larger : offset({path}, distance, fold_mitre_limit))
      result.push_back(to_polygon(larger));
  }
  return result;
}

std::vector<Polygon> hole_outside(const Polygon& hole, const std::vector<Polygon>& solid, double smallest_width) {
  ClipperLib::Clipper clipper;
  clipper.AddPath(to_path(hole), ClipperLib::ptSubject, true);
  for (const Polygon& polygon : solid) clipper.AddPath(to_path(polygon), ClipperLib::ptClip, true);
  ClipperLib::Paths rest;
  clipper.Execute(ClipperLib::ctDifference, rest, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return to_holes(rest, smallest_width);
}

std::vector<Face> expanded_union(const std::vector<Polygon>& polygons, double distance,
                                 const std::vector<Polygon>& holes, double smallest_side) {
  ClipperLib::Paths expanded;
  for (const Polygon& polygon : polygons) {
    for (ClipperLib::Path& path : offset({to_path(polygon)}, distance, outer_mitre_limit)) {
      expanded.push_back(std::move(path));
    }
  }
  std::vector<Face> faces = without(expanded, holes);
  for (Face& face : faces) {
    for (Polygon& polygon : face) simplify(polygon, smallest_side);
    std::erase_if(face, [](const Polygon& polygon) { return polygon.size() < 3; });
  }
  std::erase_if(faces, [](const Face& face) { return face.empty(); });
  return faces;
}

std::vector<Face> difference(const Polygon& polygon, const std::vector<Polygon>& holes) {
  return without({to_path(polygon)}, holes);
}

}  // namespace supple::tiling
