#include "beams.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "clipper_paths.h"
#include "polygon.h"

namespace supple::tiling {
namespace {

/// Joints at smaller turns (rad; 15 degrees) are mitred. The third side of a square joint would be at most a seventh of
/// the half width there, and would require elements as small. The areas differ by less than 6e-4 squared half widths.
constexpr double min_square_turn = std::numbers::pi / 12;

/// Tiles grow by this (mm) before their union is taken, since neighbours share their sides only up to rounding.
constexpr double union_margin = 1e-6;

void unite(const ClipperLib::Paths& paths, ClipperLib::PolyTree& tree) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(paths, ClipperLib::ptSubject, true);
  clipper.Execute(ClipperLib::ctUnion, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
}

Eigen::Vector2d left_of(const Eigen::Vector2d& direction) { return {-direction.y(), direction.x()}; }

/// One side of an outline: its first point, its unit direction and its length.
struct Side {
  Eigen::Vector2d begin, direction;
  double length;
};

/// The joint that closes the gap between the strips beside two consecutive sides. It overlaps both strips, so that
/// rounding leaves no slit between them.
Polygon joint(const Side& in, const Side& out, double half_width) {
  const double turn = std::atan2(cross(in.direction, out.direction), in.direction.dot(out.direction));
  const double side = turn > 0 ? -1 : 1;  // 1 if the gap is to the left, -1 if it is to the right
  const double along = half_width * std::tan(std::abs(turn) / (std::abs(turn) < min_square_turn ? 2 : 4));
  const Eigen::Vector2d from = out.begin + side * half_width * left_of(in.direction);
  const Eigen::Vector2d to = out.begin + side * half_width * left_of(out.direction);
  Polygon polygon = {out.begin, from - std::min(half_width, in.length) / 2 * in.direction, from + along * in.direction,
                     to - along * out.direction, to + std::min(half_width, out.length) / 2 * out.direction};
  if (side > 0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

void collect_holes(const ClipperLib::PolyNode& parent, double min_width, std::vector<Polygon>& holes) {
  for (const ClipperLib::PolyNode* outline : parent.Childs) {
    for (const ClipperLib::PolyNode* hole : outline->Childs) {
      Polygon polygon = to_polygon(hole->Contour);
      std::reverse(polygon.begin(), polygon.end());
      if (remains(polygon, min_width)) holes.push_back(std::move(polygon));
      collect_holes(*hole, min_width, holes);
    }
  }
}

}  // namespace

std::vector<Polygon> beams_along(const Polygon& outline, double half_width, Joints joints) {
  std::vector<Side> sides;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d side = outline[(k + 1) % outline.size()] - outline[k];
    const double length = side.norm();
    if (length * units_per_millimetre >= 1) sides.push_back({outline[k], side / length, length});
  }
  std::vector<Polygon> result;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Side& side = sides[k];
    const Side& before = sides[(k + sides.size() - 1) % sides.size()];
    const Eigen::Vector2d across = half_width * left_of(side.direction),
                          end = side.begin + side.length * side.direction;
    result.push_back({side.begin + across, side.begin - across, end - across, end + across});
    const double turn = cross(before.direction, side.direction);
    if (turn < 0 || (turn > 0 && joints == Joints::both)) result.push_back(joint(before, side, half_width));
  }
  return result;
}

std::vector<Polygon> holes_between(std::span<const Polygon> solid, double min_width) {
  ClipperLib::PolyTree tree;
  unite(to_paths(solid), tree);
  std::vector<Polygon> holes;
  collect_holes(tree, min_width, holes);
  return holes;
}

std::vector<Polygon> outlines_of_union(std::span<const Polygon> polygons) {
  ClipperLib::Paths grown;
  for (const Polygon& polygon : polygons) {
    // Each tile is simplified by itself. If its outline crosses itself, an area that it surrounds clockwise belongs to
    // the tile, too.
    ClipperLib::Paths simple;
    ClipperLib::SimplifyPolygon(to_path(polygon), simple, ClipperLib::pftNonZero);
    ClipperLib::ClipperOffset offset;
    offset.AddPaths(simple, ClipperLib::jtSquare, ClipperLib::etClosedPolygon);
    ClipperLib::Paths result;
    offset.Execute(result, union_margin * units_per_millimetre);
    grown.insert(grown.end(), result.begin(), result.end());
  }
  ClipperLib::PolyTree tree;
  unite(grown, tree);
  std::vector<Face> faces;
  add_faces(tree, faces);
  std::vector<Polygon> outlines;
  for (Face& face : faces) {
    if (remains(face[0], 2 * union_margin)) outlines.push_back(std::move(face[0]));
  }
  return outlines;
}

std::vector<Face> faces_of_union(std::span<const Polygon> polygons, double min_width) {
  return faces_without_slivers(to_paths(polygons), min_width);
}

std::vector<Face> difference(const Polygon& polygon, const std::vector<Polygon>& holes) {
  ClipperLib::Clipper clipper;
  clipper.AddPath(to_path(polygon), ClipperLib::ptSubject, true);
  for (const Polygon& hole : holes) clipper.AddPath(to_path(hole), ClipperLib::ptClip, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctDifference, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  std::vector<Face> faces;
  add_faces(tree, faces);
  return faces;
}

}  // namespace supple::tiling
