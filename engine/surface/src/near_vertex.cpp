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

/// Points nearer to a vertex than this part of the least height over it are near. Further away, the rounding of an
/// edge's length, which windows err by, is less than 1e-12 of the distances.
constexpr double kNear = 1e-3;

Vector2d apex_of(const EdgeFrame& frame) { return {frame.apex_x(), frame.apex_y}; }

/// A point of a fan: how far from the vertex and at which angles from the two edges of its corner.
struct FanPoint {
  FanPoint(const SearchMesh& mesh, std::int32_t at, const SurfacePoint& point)
      : corner(at),
        head(point.barycentric[(corner + 1) % 3]),
        apex(point.barycentric[(corner + 2) % 3]),
        position(planar_point(mesh.frames[corner], point.barycentric, corner % 3)),
        radius(position.norm()) {
    const EdgeFrame& frame = mesh.frames[corner];
    from_first = std::atan2(position.y(), position.x());
    to_last = std::atan2(head * frame.length * frame.apex_y, position.dot(apex_of(frame)));
  }

  std::int32_t corner;
  double head, apex;  ///< barycentric coordinates
  Vector2d position;
  double radius;
  double from_first, to_last;  ///< angles from the corner's first edge, and on to its last
};

/// The straight path from one point counterclockwise to another in the unfolded fan.
struct FanChord {
  double turn = std::numeric_limits<double>::infinity();  ///< infinity where the boundary lies between
  double length = std::numeric_limits<double>::infinity();
  Vector2d departure, arrival;
};

FanChord chord_between(const SearchMesh& mesh, const FanPoint& a, const FanPoint& b) {
  const TriangleMesh& m = *mesh.mesh;
  FanChord chord;
  double turn = a.to_last + b.from_first;
  const std::int32_t next = m.rotate(a.corner);
  for (std::int32_t h = next; h != b.corner; h = m.rotate(h)) {
    if (h < 0) return chord;
    turn += m.corner_angle(h);
  }
  chord.turn = turn;
  if (turn >= pi) return chord;
  if (next == b.corner) {
    // From differences of barycentric coordinates along the one edge between, so that points beside each other keep
    // their digits too.
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
  // Along and across the rays from the vertex to the ends.
  const double half = std::sin(0.5 * turn);
  const double outward = b.radius - a.radius;
  const auto turned = [](const FanPoint& p, double along, double across) {
    const Vector2d ray = p.position / p.radius;
    return Vector2d(along * ray + across * Vector2d(-ray.y(), ray.x()));
  };
  chord.departure = turned(a, outward - 2 * b.radius * half * half, b.radius * std::sin(turn));
  chord.arrival = turned(b, outward + 2 * a.radius * half * half, a.radius * std::sin(turn));
  chord.length = std::sqrt(outward * outward + 4 * a.radius * b.radius * half * half);
  return chord;
}

double least_height(const SearchMesh& mesh, std::int32_t vertex) {
  double least = std::numeric_limits<double>::infinity();
  for (const FanCorner& corner : mesh.fan(vertex)) {
    least = std::min(least, mesh.frames[TriangleMesh::next(corner.halfedge)].apex_y);
  }
  return least;
}

}  // namespace

bool NearVertexPath::through_vertex() const { return turn >= pi; }

std::optional<NearVertexPath> path_near_vertex(const SearchMesh& mesh, const SurfacePoint& from,
                                               const SurfacePoint& to) {
  // A point's height over the opposite side is its barycentric coordinate, so that points near a vertex have one of
  // nearly 1.
  int corner = 0;
  if (!(from.barycentric.maxCoeff(&corner) >= 1 - kNear) || from.face == to.face || corner_of(from) >= 0) return {};
  int other = 0;
  if (!(to.barycentric.maxCoeff(&other) >= 1 - kNear) || corner_of(to) >= 0) return {};
  const std::vector<Triangle>& faces = mesh.mesh->faces();
  const std::int32_t vertex = faces[index(from.face)][corner];
  if (faces[index(to.face)][other] != vertex) return {};
  const FanPoint a(mesh, 3 * index(from.face) + corner, from);
  const FanPoint b(mesh, 3 * index(to.face) + other, to);
  const double reach = kNear * least_height(mesh, vertex);
  if (std::max(a.radius, b.radius) > reach) return {};

  FanChord ahead = chord_between(mesh, a, b);
  FanChord back = chord_between(mesh, b, a);
  NearVertexPath path{vertex, a.corner, b.corner, a.position, b.position, 0, 0, 0, false, a.to_last, {}, {}, reach};
  path.clockwise = back.length < ahead.length;
  if (path.clockwise) {
    std::swap(back.departure, back.arrival);
    back.departure = -back.departure;
    back.arrival = -back.arrival;
    std::swap(ahead, back);
    path.angle_to_first_edge = b.to_last;
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
  // Counterclockwise, from whichever end that is.
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
      // Where the ray at this angle meets the chord: by the areas of the two triangles that it cuts the whole into.
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
