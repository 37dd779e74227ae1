#include "near_vertex.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// A point is near a vertex if, in its face, its distance from the vertex is below this fraction of the vertex's height
/// over the opposite side. Further away, the error of windows, which is the rounding of an edge's length, is below
/// 1e-12 of the distances.
constexpr double near_ratio = 1e-3;

Vector2d apex_of(const EdgeFrame& frame) { return {frame.apex_x(), frame.apex_y}; }

/// A point of a fan with its distance from the vertex and its angles from both edges of its corner.
struct FanPoint {
  FanPoint(const SearchMesh& mesh, std::int32_t at, const SurfacePoint& point)
      : corner(at),
        head(point.barycentric[(corner + 1) % 3]),
        apex(point.barycentric[(corner + 2) % 3]),
        position(planar_point(mesh.frames[corner], point.barycentric, corner % 3)),
        radius(position.norm()) {
    const EdgeFrame& frame = mesh.frames[corner];
    angle_from_first = std::atan2(position.y(), position.x());
    angle_to_last = std::atan2(head * frame.length * frame.apex_y, position.dot(apex_of(frame)));
  }

  std::int32_t corner;
  double head, apex;  ///< barycentric coordinates of the corner halfedge's head and apex
  Vector2d position;
  double radius;
  double angle_from_first, angle_to_last;  ///< angles in radians, from the corner's first edge and to its last
};

/// The straight path in the unfolded fan from one point counterclockwise to another.
struct FanChord {
  /// Angle at the vertex in radians; infinity if the boundary lies between the points.
  double turn = std::numeric_limits<double>::infinity();
  double length = std::numeric_limits<double>::infinity();
  Vector2d departure, arrival;
};

FanChord chord_between(const SearchMesh& mesh, const FanPoint& a, const FanPoint& b) {
  const TriangleMesh& m = *mesh.mesh;
  FanChord chord;
  double turn = a.angle_to_last + b.angle_from_first;
  const std::int32_t next = m.rotate(a.corner);
  for (std::int32_t h = next; h != b.corner; h = m.rotate(h)) {
    if (h < 0) return chord;
    turn += m.corner_angle(h);
  }
  chord.turn = turn;
  if (turn >= pi) return chord;
  if (next == b.corner) {
    // One edge lies between the points. Differences of barycentric coordinates along it keep the digits of points that
    // are close to each other.
    const EdgeFrame& behind = mesh.frames[a.corner];
    const EdgeFrame& ahead = mesh.frames[b.corner];
    const Vector2d along = apex_of(behind) / behind.left_length;
    const double dx = ahead.length * (b.head - a.apex) + b.apex * ahead.apex_x() - a.head * behind.length * along.x();
    const double dy = b.position.y() + a.head * behind.length * along.y();
    chord.arrival = {dx, dy};
    chord.departure = dx * along + dy * Vector2d(-along.y(), along.x());
    chord.length = chord.arrival.norm();
    return chord;
  }
  // The vectors are composed of parts along and across the rays from the vertex to the ends.
  const double half_sine = std::sin(0.5 * turn);
  const double radial_difference = b.radius - a.radius;
  const auto rotated = [](const FanPoint& p, double along, double across) {
    const Vector2d ray = p.position / p.radius;
    return Vector2d(along * ray + across * Vector2d(-ray.y(), ray.x()));
  };
  chord.departure = rotated(a, radial_difference - 2 * b.radius * half_sine * half_sine, b.radius * std::sin(turn));
  chord.arrival = rotated(b, radial_difference + 2 * a.radius * half_sine * half_sine, a.radius * std::sin(turn));
  chord.length = std::sqrt(radial_difference * radial_difference + 4 * a.radius * b.radius * half_sine * half_sine);
  return chord;
}

double min_height(const SearchMesh& mesh, std::int32_t vertex) {
  double height = std::numeric_limits<double>::infinity();
  for (const FanCorner& corner : mesh.fan(vertex)) {
    height = std::min(height, mesh.frames[TriangleMesh::next(corner.halfedge)].apex_y);
  }
  return height;
}

}  // namespace

bool NearVertexPath::through_vertex() const { return turn >= pi; }

std::optional<NearVertexPath> path_near_vertex(const SearchMesh& mesh, const SurfacePoint& from,
                                               const SurfacePoint& to) {
  // A barycentric coordinate is the relative height over the side opposite the vertex. Points near a vertex therefore
  // have one that is nearly 1.
  int corner = 0;
  if (!(from.barycentric.maxCoeff(&corner) >= 1 - near_ratio) || from.face == to.face || corner_of(from) >= 0)
    return {};
  int other = 0;
  if (!(to.barycentric.maxCoeff(&other) >= 1 - near_ratio) || corner_of(to) >= 0) return {};
  const std::vector<Triangle>& faces = mesh.mesh->faces();
  const std::int32_t vertex = faces[index(from.face)][corner];
  if (faces[index(to.face)][other] != vertex) return {};
  const FanPoint a(mesh, 3 * index(from.face) + corner, from);
  const FanPoint b(mesh, 3 * index(to.face) + other, to);
  const double near_radius = near_ratio * min_height(mesh, vertex);
  if (std::max(a.radius, b.radius) > near_radius) return {};

  FanChord ahead = chord_between(mesh, a, b);
  FanChord back = chord_between(mesh, b, a);
  NearVertexPath path{vertex, a.corner, b.corner,        a.position, b.position, 0,          0,
                      0,      false,    a.angle_to_last, {},         {},         near_radius};
  path.clockwise = back.length < ahead.length;
  if (path.clockwise) {
    std::swap(back.departure, back.arrival);
    back.departure = -back.departure;
    back.arrival = -back.arrival;
    std::swap(ahead, back);
    path.angle_to_first_edge = b.angle_to_last;
  }
  path.turn = ahead.turn;
  path.length = ahead.length;
  path.competing_length = back.length;
  path.departure = ahead.departure;
  path.arrival = ahead.arrival;
  if (path.through_vertex()) {
    path.length = a.radius + b.radius;
    path.departure = -a.position;
    path.arrival = b.position;
  }
  return path;
}

std::vector<FanCrossing> fan_crossings(const SearchMesh& mesh, const NearVertexPath& path) {
  // The crossings are found counterclockwise, beginning at the end from which the path runs in that direction.
  const TriangleMesh& m = *mesh.mesh;
  const std::int32_t first = path.clockwise ? path.to_corner : path.from_corner;
  const std::int32_t last = path.clockwise ? path.from_corner : path.to_corner;
  const Vector2d& begin = path.clockwise ? path.to : path.from;
  const Vector2d& end = path.clockwise ? path.from : path.to;
  const double r0 = begin.norm(), r1 = end.norm();
  double angle = path.angle_to_first_edge;
  std::vector<FanCrossing> crossings;
  for (std::int32_t h = m.rotate(first);; h = m.rotate(h)) {
    const double remaining = path.turn - angle;
    if (angle > 0 && !(h == last && end.y() <= 0)) {
      // The ray at this angle divides the triangle of the vertex and both ends into two. Their areas give its length.
      const double across = r0 * std::sin(angle) + r1 * std::sin(remaining);
      crossings.push_back({h, across > 0 ? r0 * r1 * std::sin(path.turn) / across : 0});
    }
    if (h == last) break;
    angle += m.corner_angle(h);
  }
  if (path.clockwise) std::reverse(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace supple::surface
