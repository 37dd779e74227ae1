#include "clipper_paths.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Vertices closer than this (mm) to the line through their neighbours are no corners.
constexpr double collinear_distance = 1e-7;
/// Distance between a round joint's arc and the sides of the polygon that replaces it, as a ratio to the arc's radius.
constexpr double arc_tolerance = 2e-3;
/// Limit of the unions. After each union fewer short sides are left, mostly none after the first.
constexpr int max_unions = 16;

/// Drops vertices on the line through their neighbours, among them tips of spikes of no width.
void drop_collinear(Polygon& polygon) {
  for (std::size_t k = 0, retained = 0; retained < polygon.size() && polygon.size() > 2;) {
    const std::size_t n = polygon.size();
    const Eigen::Vector2d in = polygon[k] - polygon[(k + n - 1) % n], out = polygon[(k + 1) % n] - polygon[k];
    // Twice the area of the triangle over its longer side here is its height over that side.
    if (std::abs(cross(in, out)) <= collinear_distance * std::max(in.norm(), out.norm())) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
      if (k == polygon.size()) k = 0;
      // The one before has a new neighbour, and is checked again.
      k = (k + polygon.size() - 1) % polygon.size();
      retained = 0;
    } else {
      k = (k + 1) % n;
      ++retained;
    }
  }
}

/// Merges the ends of the shortest side until none is shorter than `min_side`, and drops collinear vertices.
void simplify(Polygon& polygon, double min_side) {
  drop_collinear(polygon);
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
    if (length >= min_side) break;
    const std::size_t next = (shortest + 1) % polygon.size();
    polygon[shortest] = (polygon[shortest] + polygon[next]) / 2;
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(next));
  }
  drop_collinear(polygon);
}

bool is_narrow(const Polygon& polygon, double min_width) {
  return polygon.size() < 3 || 2 * std::abs(area(polygon)) <= min_width * perimeter(polygon);
}

std::vector<Face> faces_of(const ClipperLib::Paths& paths, ClipperLib::PolyFillType fill) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(paths, ClipperLib::ptSubject, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctUnion, tree, fill, fill);
  std::vector<Face> faces;
  add_faces(tree, faces);
  return faces;
}

/// Drops narrow polygons, and with a narrow outline its holes.
void drop_narrow(std::vector<Face>& faces, double min_width) {
  for (Face& face : faces) std::erase_if(face, [&](const Polygon& polygon) { return is_narrow(polygon, min_width); });
  std::erase_if(faces, [](const Face& face) { return face.empty() || area(face[0]) < 0; });
}

}  // namespace

ClipperLib::Path to_path(const Polygon& polygon) {
  ClipperLib::Path path;
  path.reserve(polygon.size());
  for (const Eigen::Vector2d& p : polygon) {
    path.emplace_back(std::llround(p.x() * units_per_millimetre), std::llround(p.y() * units_per_millimetre));
  }
  return path;
}

ClipperLib::Paths to_paths(std::span<const Polygon> polygons) {
  ClipperLib::Paths paths;
  paths.reserve(polygons.size());
  for (const Polygon& polygon : polygons) paths.push_back(to_path(polygon));
  return paths;
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

ClipperLib::Paths operation(ClipperLib::ClipType type, const ClipperLib::Paths& subject,
                            const ClipperLib::Paths& clip) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(subject, ClipperLib::ptSubject, true);
  clipper.AddPaths(clip, ClipperLib::ptClip, true);
  ClipperLib::Paths result;
  clipper.Execute(type, result, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return result;
}

ClipperLib::Paths grown(const ClipperLib::Paths& paths, double distance, ClipperLib::JoinType joints) {
  ClipperLib::ClipperOffset offset(4);
  offset.ArcTolerance = arc_tolerance * std::abs(distance) * units_per_millimetre;
  offset.AddPaths(paths, joints, ClipperLib::etClosedPolygon);
  ClipperLib::Paths result;
  offset.Execute(result, distance * units_per_millimetre);
  return result;
}

ClipperLib::Paths widened_line(const ClipperLib::Path& line, double half_width) {
  ClipperLib::ClipperOffset offset;
  offset.ArcTolerance = arc_tolerance * half_width * units_per_millimetre;
  offset.AddPath(line, ClipperLib::jtRound, ClipperLib::etOpenRound);
  ClipperLib::Paths result;
  offset.Execute(result, half_width * units_per_millimetre);
  return result;
}

void add_faces(const ClipperLib::PolyNode& parent, std::vector<Face>& faces) {
  for (const ClipperLib::PolyNode* outline : parent.Childs) {
    Face face = {to_polygon(outline->Contour)};
    for (const ClipperLib::PolyNode* hole : outline->Childs) face.push_back(to_polygon(hole->Contour));
    faces.push_back(std::move(face));
    for (const ClipperLib::PolyNode* hole : outline->Childs) add_faces(*hole, faces);
  }
}

std::vector<Face> faces_without_slivers(const ClipperLib::Paths& paths, double min_width) {
  std::vector<Face> faces = faces_of(paths, ClipperLib::pftNonZero);
  for (int unions = 1; unions < max_unions; ++unions) {
    bool has_changed = false;
    for (Face& face : faces) {
      for (Polygon& polygon : face) {
        const std::size_t corners = polygon.size();
        simplify(polygon, min_width);
        has_changed = has_changed || (polygon.size() != corners && !is_narrow(polygon, min_width));
      }
    }
    drop_narrow(faces, min_width);
    if (!has_changed) return faces;
    ClipperLib::Paths simplified;
    for (const Face& face : faces) {
      for (const Polygon& polygon : face) simplified.push_back(to_path(polygon));
    }
    // Where an outline now crosses itself, it runs clockwise around areas that are not solid.
    faces = faces_of(simplified, ClipperLib::pftPositive);
  }
  drop_narrow(faces, min_width);
  return faces;
}

bool remains(Polygon& polygon, double min_width) {
  simplify(polygon, min_width);
  return !is_narrow(polygon, min_width);
}

}  // namespace supple::tiling
