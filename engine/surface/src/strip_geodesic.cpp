#include "strip_geodesic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planar_cross.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Minimum length of a path that is unfolded, in mean edges. Shorter ones would lose digits.
constexpr double min_unfolded_length = 1e-5;
/// A path is certainly the shortest if all others are longer by this fraction.
constexpr double certain_excess = 1e-9;
/// Maximum number of faces behind the strip's sides that are tested. A search for the shortest path costs less than
/// more of them.
constexpr int max_faces_behind = 12;

Vector2d rotated_left(const Vector2d& v) { return {-v.y(), v.x()}; }

/// The minimum of |p - x| + |x - q| over the points x of a segment. Rotating p about the segment's line, into one plane
/// with q and opposite to it, makes the shortest path a straight line. If that misses the segment, x is an end of it.
double min_detour(const Vector3d& p, const Vector3d& q, const Vector3d& tail, const Vector3d& along, double length) {
  const Vector3d u = along / length;
  const Vector3d from_p = p - tail;
  const Vector3d from_q = q - tail;
  const double at_p = from_p.dot(u);
  const double at_q = from_q.dot(u);
  const double off_p = u.cross(from_p).norm();
  const double off_q = u.cross(from_q).norm();
  const double off = off_p + off_q;
  const double x = off > 0 ? std::clamp(at_p + (at_q - at_p) * (off_p / off), 0.0, length)
                           : std::clamp(0.5 * (at_p + at_q), 0.0, length);
  return Vector2d(at_p - x, off_p).norm() + Vector2d(at_q - x, off_q).norm();
}

/// Proves that no path across a side of the strip is as short as `length`, as within_strip explains. One certificate
/// serves all sides, since it counts the faces behind them.
class Certificate {
 public:
  Certificate(const TriangleMesh& mesh, const Vector3d& p, const Vector3d& q, double length)
      : mesh_(mesh), p_(p), q_(q), length_(length) {}

  bool excludes(std::int32_t h) {
    const std::int32_t across = mesh_.twin(h);
    if (across < 0) return true;
    const Vector3d& tail = mesh_.positions()[mesh_.tail(h)];
    const Vector3d along = mesh_.positions()[mesh_.head(h)] - tail;
    if (min_detour(p_, q_, tail, along, mesh_.edge_length(h)) > length_ * (1 + certain_excess)) return true;
    if (++faces_behind_ > max_faces_behind) return false;
    return excludes(TriangleMesh::next(across)) && excludes(TriangleMesh::previous(across));
  }

 private:
  const TriangleMesh& mesh_;
  const Vector3d& p_;
  const Vector3d& q_;
  double length_;
  int faces_behind_ = 0;
};

/// The corners of a face in the plane.
using PlanarFace = std::array<Vector2d, 3>;

PlanarFace first_face(const SearchMesh& mesh, std::int32_t face) {
  const EdgeFrame& frame = mesh.frames[3 * face];
  return {Vector2d(0, 0), Vector2d(frame.length, 0), Vector2d(frame.apex_x(), frame.apex_y)};
}

/// The face across halfedge h of a face in the plane.
PlanarFace next_face(const SearchMesh& mesh, const PlanarFace& face, std::int32_t h) {
  const std::int32_t across = mesh.mesh->twin(h);
  const EdgeFrame& frame = mesh.frames[across];
  const Vector2d& tail = face[(h + 1) % 3];  // the two halfedges of an edge have opposite directions
  const Vector2d& head = face[h % 3];
  const Vector2d u = (head - tail) / frame.length;
  PlanarFace next;
  next[across % 3] = tail;
  next[(across + 1) % 3] = head;
  next[(across + 2) % 3] = tail + frame.apex_x() * u + frame.apex_y * rotated_left(u);
  return next;
}

Vector2d point_in(const PlanarFace& face, const Vector3d& barycentric) {
  return barycentric[0] * face[0] + barycentric[1] * face[1] + barycentric[2] * face[2];
}

int side_towards(const TriangleMesh& mesh, std::int32_t face, std::int32_t other) {
  for (int side = 0; side < 3; ++side) {
    const std::int32_t across = mesh.twin(3 * face + side);
    if (across >= 0 && TriangleMesh::face_of(across) == other) return side;
  }
  return -1;
}

Strip without_faces_before(const TriangleMesh& mesh, const Strip& strip, std::int32_t face) {
  Strip rest;
  for (int i = 0; i < strip.count; ++i) {
    if (TriangleMesh::face_of(mesh.twin(strip.halfedges[i])) != face) continue;
    rest.count = strip.count - i - 1;
    std::copy_n(strip.halfedges.begin() + i + 1, rest.count, rest.halfedges.begin());
    break;
  }
  return rest;
}

}  // namespace

Eigen::Matrix4d TangentGeodesic::hessian() const {
  Eigen::Vector4d n;
  n << surface::rotated_left(from_direction), surface::rotated_left(to_direction);
  Eigen::Matrix4d result = Eigen::Matrix4d::Zero();
  result.topLeftCorner<2, 2>() = n.head<2>() * n.head<2>().transpose() / first_length;
  result.bottomRightCorner<2, 2>() = n.tail<2>() * n.tail<2>().transpose() / last_length;
  if (!pinned) {
    result.topRightCorner<2, 2>() = -n.head<2>() * n.tail<2>().transpose() / first_length;
    result.bottomLeftCorner<2, 2>() = result.topRightCorner<2, 2>().transpose();
  }
  return result;
}

Eigen::Vector4d TangentGeodesic::gradient() const {
  Eigen::Vector4d result;
  result << -from_direction, to_direction;
  return result;
}

// The vectors at an end have the direction of the straight piece there as first axis, its left normal as second.
TangentGeodesic TangentGeodesic::extrapolated(const Eigen::Vector4d& step) const {
  const Vector2d from_step(from_direction.dot(step.head<2>()),
                           surface::rotated_left(from_direction).dot(step.head<2>()));
  const Vector2d to_step(to_direction.dot(step.tail<2>()), surface::rotated_left(to_direction).dot(step.tail<2>()));
  const auto rotated_to = [](const Vector2d& direction, const Vector2d& vector) -> Vector2d {
    return (vector.x() * direction + vector.y() * surface::rotated_left(direction)) / vector.norm();
  };
  TangentGeodesic result = *this;
  const Vector2d first =
      pinned ? Vector2d(Vector2d(first_length, 0) - from_step) : Vector2d(Vector2d(distance, 0) + to_step - from_step);
  const Vector2d last = pinned ? Vector2d(Vector2d(last_length, 0) + to_step) : first;
  result.first_length = first.norm();
  result.last_length = last.norm();
  result.distance = pinned ? distance + (result.first_length - first_length) + (result.last_length - last_length)
                           : result.first_length;
  result.from_direction = rotated_to(from_direction, first);
  result.to_direction = rotated_to(to_direction, last);
  return result;
}

TangentGeodesic TangentGeodesic::in_frames_before(double from_turn, double to_turn) const {
  TangentGeodesic result = *this;
  result.from_direction = Eigen::Rotation2Dd(-from_turn) * from_direction;
  result.to_direction = Eigen::Rotation2Dd(-to_turn) * to_direction;
  return result;
}

Strip adjusted_strip(const TriangleMesh& mesh, const Strip& known, std::int32_t from_face, std::int32_t to_face) {
  Strip strip = known;
  if (!strip.known() || strip.count == 0) {
    strip = {};
    const int side = side_towards(mesh, from_face, to_face);
    if (side < 0) return strip;
    strip.count = 1;
    strip.halfedges[0] = 3 * from_face + side;
    return strip;
  }
  if (const std::int32_t first = TriangleMesh::face_of(strip.halfedges[0]); first != from_face) {
    if (const Strip rest = without_faces_before(mesh, strip, from_face); rest.known()) {
      strip = rest;
    } else {
      const int side = side_towards(mesh, from_face, first);
      if (side < 0 || strip.count == Strip::capacity) return {};
      std::copy_backward(strip.halfedges.begin(), strip.halfedges.begin() + strip.count,
                         strip.halfedges.begin() + strip.count + 1);
      strip.halfedges[0] = 3 * from_face + side;
      ++strip.count;
    }
  }
  const auto face_behind = [&](int i) { return TriangleMesh::face_of(mesh.twin(strip.halfedges[i])); };
  if (strip.count == 0) return adjusted_strip(mesh, {}, from_face, to_face);
  if (face_behind(strip.count - 1) == to_face) return strip;
  for (int i = strip.count - 1; i >= 0; --i) {
    if (TriangleMesh::face_of(strip.halfedges[i]) != to_face) continue;
    strip.count = i;
    return i > 0 ? strip : Strip{};
  }
  const std::int32_t last = face_behind(strip.count - 1);
  const int side = side_towards(mesh, last, to_face);
  if (side < 0 || strip.count == Strip::capacity) return {};
  strip.halfedges[strip.count++] = 3 * last + side;
  return strip;
}

double turn_across(const SearchMesh& mesh, std::int32_t h) {
  const PlanarFace next = next_face(mesh, first_face(mesh, TriangleMesh::face_of(h)), h);
  const Vector2d x = next[1] - next[0];
  return std::atan2(x.y(), x.x());
}

Strip strip_of(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
               std::span<const PathPoint> path) {
  Strip strip;
  int count = 0;
  std::int32_t face = index(from.face);
  const auto cross = [&](std::int32_t h) {
    if (count == Strip::capacity) return false;
    strip.halfedges[count++] = h;
    face = TriangleMesh::face_of(mesh.twin(h));
    return true;
  };
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const int side = side_of(path[i].point);
    if (side < 0) return {};
    const std::int32_t h = 3 * index(path[i].point.face) + side;
    const std::int32_t across = mesh.twin(h);
    if (across < 0) return {};
    if (face != TriangleMesh::face_of(h) && face != TriangleMesh::face_of(across)) {
      // The path starts on an edge of its face, and continues in the face beyond this edge.
      const int start = side_of(from);
      if (i != 1 || start < 0 || mesh.twin(3 * face + start) < 0 || !cross(3 * face + start)) return {};
    }
    if (face == TriangleMesh::face_of(h)) {
      if (!cross(h)) return {};
    } else if (face != TriangleMesh::face_of(across) || !cross(across)) {
      return {};
    }
  }
  if (face != index(to.face)) {
    const int side = side_towards(mesh, face, index(to.face));
    if (side < 0 || !cross(3 * face + side)) return {};
  }
  strip.count = count;
  return strip;
}

TangentGeodesic within_face(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to) {
  const EdgeFrame& frame = mesh.frames[3 * index(from.face)];
  // Differences of barycentric coordinates keep the digits of points that are close to each other.
  const Vector3d difference = to.barycentric - from.barycentric;
  const Vector2d displacement(difference[1] * frame.length + difference[2] * frame.apex_x(),
                              difference[2] * frame.apex_y);
  TangentGeodesic found;
  found.distance = found.first_length = found.last_length = displacement.norm();
  found.strip.count = 0;
  if (found.distance > 0) found.from_direction = found.to_direction = displacement / found.distance;
  return found;
}

std::optional<TangentGeodesic> within_strip(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                            const Strip& strip) {
  const TriangleMesh& m = *mesh.mesh;
  std::array<Vector2d, Strip::capacity> tails;
  std::array<Vector2d, Strip::capacity> heads;
  PlanarFace face = first_face(mesh, index(from.face));
  const Vector2d start = point_in(face, from.barycentric);
  const auto crossed = strip.crossed();
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    tails[i] = face[crossed[i] % 3];
    heads[i] = face[(crossed[i] + 1) % 3];
    face = next_face(mesh, face, crossed[i]);
  }
  const Vector2d displacement = point_in(face, to.barycentric) - start;
  const double length = displacement.norm();
  if (!(length > min_unfolded_length * m.mean_edge_length())) return std::nullopt;
  // A face lies to the left of its halfedges. A path that leaves it has the head of the edge on its left, the tail on
  // its right.
  for (std::size_t i = 0; i < crossed.size(); ++i)
    if (!(cross(displacement, tails[i] - start) <= 0 && cross(displacement, heads[i] - start) >= 0))
      return std::nullopt;

  const Vector3d p = position(m, from);
  const Vector3d q = position(m, to);
  Certificate certificate(m, p, q, length);
  std::int32_t entered = -1;
  for (const std::int32_t h : crossed) {
    for (const std::int32_t side : {TriangleMesh::next(h), TriangleMesh::previous(h)})
      if (side != entered && !certificate.excludes(side)) return std::nullopt;
    entered = m.twin(h);
  }
  for (const std::int32_t side : {TriangleMesh::next(entered), TriangleMesh::previous(entered)})
    if (!certificate.excludes(side)) return std::nullopt;

  TangentGeodesic found;
  found.distance = found.first_length = found.last_length = length;
  found.from_direction = displacement / length;
  const Vector2d x = (face[1] - face[0]) / m.edge_length(3 * index(to.face));
  found.to_direction = {found.from_direction.dot(x), found.from_direction.dot(rotated_left(x))};
  found.strip = strip;
  return found;
}

}  // namespace supple::surface
