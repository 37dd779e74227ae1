#include "path_sections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "edge_frames.h"
#include "halfedge_frame.h"
#include "path_strip.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A path that runs straight through a vertex passes it on the left, unless the angle on the right is closer to pi by
/// this amount (radians). Paths along edges then pass all vertices on one side.
constexpr double side_tolerance = 1e-6;

/// The corners at `vertex` of the faces that contain both it and the point, as outgoing halfedges in counterclockwise
/// order. There are two if the point lies on an edge of the vertex.
std::vector<std::int32_t> corners_towards(const TriangleMesh& mesh, const SurfacePoint& vertex,
                                          const SurfacePoint& point) {
  std::vector<std::int32_t> found;
  const std::vector<std::int32_t> faces = faces_around(mesh, point);
  for (const std::int32_t corner : faces_around(mesh, vertex)) {
    if (std::any_of(faces.begin(), faces.end(),
                    [&](std::int32_t h) { return TriangleMesh::face_of(h) == TriangleMesh::face_of(corner); })) {
      found.push_back(corner);
    }
  }
  if (found.size() > 1 && mesh.rotate(found.front()) != found.back()) std::swap(found.front(), found.back());
  return found;
}

/// The angle at tail(corner) from halfedge `corner` to the point; radians.
double angle_in_corner(const TriangleMesh& mesh, std::int32_t corner, const Vector3d& point) {
  const Eigen::Matrix<double, 3, 2> frame = halfedge_frame(mesh, corner);
  const Vector2d d = frame.transpose() * (point - mesh.positions()[mesh.tail(corner)]);
  return std::atan2(d.y(), d.x());
}

/// The faces around a vertex on one side of a path that passes it.
struct VertexBypass {
  std::int32_t from = -1, to = -1;  ///< corners by which the path arrives and leaves
  std::vector<std::int32_t> over;   ///< edges of the vertex in between, as halfedges of the face before
  /// Angle between both parts of the path, in radians; infinity if the boundary lies in between.
  double angle = std::numeric_limits<double>::infinity();
};

/// The faces on the left side of the path are passed clockwise, those on the right side counterclockwise.
VertexBypass bypass_of(const TriangleMesh& mesh, const PathPoint& before, const PathPoint& at, const PathPoint& after,
                       bool left) {
  VertexBypass bypass;
  const std::vector<std::int32_t> in = corners_towards(mesh, at.point, before.point);
  const std::vector<std::int32_t> out = corners_towards(mesh, at.point, after.point);
  if (in.empty() || out.empty()) return bypass;
  bypass.from = left ? in.front() : in.back();
  bypass.to = left ? out.back() : out.front();
  const double in_angle = angle_in_corner(mesh, bypass.from, before.position);
  const double out_angle = angle_in_corner(mesh, bypass.to, after.position);
  double angle = left ? in_angle - out_angle : out_angle - in_angle;
  std::int32_t corner = bypass.from;
  do {
    const std::int32_t edge = left ? corner : TriangleMesh::previous(corner);
    if (mesh.twin(edge) < 0) return bypass;
    bypass.over.push_back(edge);
    if (!left) angle += mesh.corner_angle(corner);
    corner = left ? TriangleMesh::next(mesh.twin(edge)) : mesh.twin(edge);
    if (left) angle += mesh.corner_angle(corner);
  } while (corner != bypass.to && corner != bypass.from);
  if (corner == bypass.to) bypass.angle = angle;
  return bypass;
}

}  // namespace

std::vector<PathSection> sections_of(const TriangleMesh& mesh, const std::vector<PathPoint>& path) {
  std::vector<PathSection> sections;
  std::int32_t face = -1;  // a halfedge of the face through which the path runs
  const auto begin = [&](std::size_t k) {
    face = common_face(mesh, path[k].point, path[k + 1].point);
    if (face < 0) face = 3 * index(path[k].point.face);
    sections.push_back({k, k, face, {}});
  };
  begin(0);
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    PathSection& section = sections.back();
    if (crosses_edge(path[k])) {
      const int side = side_of(path[k].point);
      std::int32_t over = 3 * index(path[k].point.face) + side;
      double t = path[k].point.barycentric[(side + 1) % 3];
      if (TriangleMesh::face_of(over) != TriangleMesh::face_of(face)) {
        over = mesh.twin(over);
        t = 1 - t;
      }
      section.crossings.push_back({over, t});
      face = mesh.twin(over);
      continue;
    }
    const std::int32_t v = index(path[k].vertex);
    if (v >= 0 && !bends_paths(mesh, v)) {
      const VertexBypass left = bypass_of(mesh, path[k - 1], path[k], path[k + 1], true);
      const VertexBypass right = bypass_of(mesh, path[k - 1], path[k], path[k + 1], false);
      const double off_left = std::abs(left.angle - std::numbers::pi);
      const double off_right = std::abs(right.angle - std::numbers::pi);
      const VertexBypass& bypass = off_right < off_left - side_tolerance ? right : left;
      if (bypass.angle < std::numeric_limits<double>::infinity()) {
        if (section.crossings.empty()) section.entered = bypass.from;
        for (const std::int32_t over : bypass.over)
          section.crossings.push_back({over, mesh.head(over) == v ? 1.0 : 0.0});
        face = bypass.to;
        continue;
      }
    }
    section.last = k;
    begin(k);
  }
  sections.back().last = path.size() - 1;
  return sections;
}

}  // namespace supple::surface
