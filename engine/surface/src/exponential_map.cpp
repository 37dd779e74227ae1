#include "supple/surface/exponential_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "halfedge_frame.h"
#include "planar_cross.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/base/stop_pace.h"
#include "triangle_area.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Index = std::int32_t;

/// A path that comes this close to a vertex, relative to the face's longest edge, passes through it. This is some tens
/// of times the rounding of a position on an edge.
constexpr double vertex_tolerance = 1e-14;
/// A direction that points out of the surface by at most this angle (radians) runs along the boundary.
constexpr double boundary_angle_tolerance = 1e-14;

/// The part of its face through which the path entered it: none (it starts inside), the reference halfedge, or the tail
/// of this.
enum class Entrance { inside, side, corner };

/// A moving point, written relative to a reference halfedge of its face. The corners are its tail, its head and the
/// apex. In the face's plane, the first axis points along the halfedge and the second into the face.
struct State {
  Index halfedge;
  Vector3d weights;  // barycentric, in the order tail, head, apex
  Vector2d direction;
  Entrance entry;
};

/// The point where the path leaves a face: on side k (from corner k to k + 1), or at corner k.
struct Exit {
  int k;
  bool through_corner;
  Vector3d weights;
  double travel;
};

/// The k-th halfedge after h in its face.
Index following(Index h, int k) { return h - h % 3 + (h + k) % 3; }

/// The three sides of the face of h as plane vectors.
std::array<Vector2d, 3> plane_sides(const TriangleMesh& mesh, Index h) {
  const auto& p = mesh.positions();
  const Vector3d& tail = p[mesh.tail(h)];
  const Vector3d& head = p[mesh.head(h)];
  const Vector3d& apex = p[mesh.tail(TriangleMesh::previous(h))];
  const double length = mesh.edge_length(h);
  const Vector3d along = (head - tail) / length;
  const double height = doubled_area(tail, head, apex).norm() / length;
  return {Vector2d(length, 0), Vector2d(along.dot(apex - head), height), Vector2d(along.dot(tail - apex), -height)};
}

SurfacePoint surface_point(Index h, const Vector3d& weights) {
  SurfacePoint point{FaceId(TriangleMesh::face_of(h)), {}};
  for (int k = 0; k < 3; ++k) point.barycentric[following(h, k) % 3] = weights[k];
  return point;
}

Vector3d weights_of(const SurfacePoint& point, Index h) {
  Vector3d weights;
  for (int k = 0; k < 3; ++k) weights[k] = point.barycentric[following(h, k) % 3];
  return weights;
}

/// Clamps rounding below 0. The largest weight absorbs the rounding of the sum.
Vector3d clamped(const Vector3d& weights) {
  Vector3d w = weights.cwiseMax(0.0).cwiseMin(1.0);
  int largest = 0;
  w.maxCoeff(&largest);
  w[largest] = 1 - (w[(largest + 1) % 3] + w[(largest + 2) % 3]);
  return w;
}

/// The side through which the path leaves its face. `sides_of_corners` is positive for corners to the left of the path.
int exit_side(Entrance entry, const Vector3d& sides_of_corners) {
  if (entry == Entrance::corner) return 1;
  if (entry == Entrance::side) return sides_of_corners[2] > 0 ? 1 : 2;
  int best = 0;
  double best_margin = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double margin = std::min(-sides_of_corners[k], sides_of_corners[(k + 1) % 3]);
    if (margin > best_margin) {
      best_margin = margin;
      best = k;
    }
  }
  return best;
}

Exit leave_face(const State& state, const std::array<Vector2d, 3>& sides) {
  // Position of each corner relative to the point: the distance to the left of the path, and the distance ahead. It is
  // computed from differences of corners, so that small weights keep their digits.
  Vector3d left, ahead;
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, previous = (k + 2) % 3;
    const double w_next = state.weights[next], w_previous = state.weights[previous];
    left[k] = w_previous * cross(state.direction, sides[previous]) - w_next * cross(state.direction, sides[k]);
    ahead[k] = w_previous * state.direction.dot(sides[previous]) - w_next * state.direction.dot(sides[k]);
    longest = std::max(longest, sides[k].norm());
  }
  int corner = -1;
  for (int k = 0; k < 3; ++k) {
    const bool hits_corner = std::abs(left[k]) <= vertex_tolerance * longest && ahead[k] > 0;
    if (hits_corner && !(state.entry == Entrance::corner && k == 0) && (corner < 0 || ahead[k] < ahead[corner]))
      corner = k;
  }
  if (corner >= 0) return {corner, true, Vector3d::Unit(corner), ahead[corner]};

  const int k = exit_side(state.entry, left);
  const int end = (k + 1) % 3;
  const double span = left[end] - left[k];
  const double t = span > 0 ? std::clamp(-left[k] / span, 0.0, 1.0) : 0.5;
  Vector3d weights = Vector3d::Zero();
  weights[k] = 1 - t;
  weights[end] = t;
  return {k, false, weights, std::max(0.0, (1 - t) * ahead[k] + t * ahead[end])};
}

/// The state beyond the halfedge `crossed`, which must have a twin. `side` is this halfedge in the plane of
/// `direction`.
State cross_halfedge(const TriangleMesh& mesh, Index crossed, double weight_of_tail, double weight_of_head,
                     const Vector2d& direction, const Vector2d& side) {
  const Vector2d turned(-direction.dot(side), std::max(0.0, cross(direction, side)));
  return {mesh.twin(crossed), {weight_of_head, weight_of_tail, 0}, turned.normalized(), Entrance::side};
}

State leave_corner(Index outgoing, double angle) {
  return {outgoing, Vector3d::UnitX(), {std::cos(angle), std::sin(angle)}, Entrance::corner};
}

/// Turns counterclockwise from `outgoing` by `angle` >= 0 (radians) around its tail. If the fan ends first, the last
/// corner is returned, and `beyond` receives the angle that is left.
State turn_counterclockwise(const TriangleMesh& mesh, Index outgoing, double angle, double* beyond = nullptr) {
  while (angle > mesh.corner_angle(outgoing)) {
    const Index next = mesh.rotate(outgoing);
    if (next < 0) {
      if (beyond) *beyond = angle - mesh.corner_angle(outgoing);
      return leave_corner(outgoing, mesh.corner_angle(outgoing));
    }
    angle -= mesh.corner_angle(outgoing);
    outgoing = next;
  }
  return leave_corner(outgoing, angle);
}

/// The state after a vertex inside the surface, with equal angles on both sides of the path.
State pass_vertex(const TriangleMesh& mesh, const State& state, int corner, const Vector2d& side) {
  const Index outgoing = following(state.halfedge, corner);
  const double total = mesh.vertex_angle(mesh.tail(outgoing));
  const Vector2d back = -state.direction;
  const double arrival = std::clamp(std::atan2(cross(side, back), side.dot(back)), 0.0, mesh.corner_angle(outgoing));
  return turn_counterclockwise(mesh, outgoing, std::fmod(arrival + 0.5 * total, total));
}

struct Departure {
  State state;
  bool leaves_surface;
};

Departure depart_from_corner(const TriangleMesh& mesh, Index outgoing, const Vector3d& tangent) {
  const Index v = mesh.tail(outgoing);
  const double corner_angle = mesh.corner_angle(outgoing);
  const Vector2d direction = halfedge_frame(mesh, outgoing).transpose() * tangent;
  double angle = std::atan2(direction[1], direction[0]);
  // A direction outside of the corner is measured from the corner's nearer side.
  if (angle < 0.5 * corner_angle - std::numbers::pi) angle += 2 * std::numbers::pi;
  const double total = mesh.vertex_angle(v);
  double beyond = 0;
  if (angle >= 0) {
    if (!mesh.is_boundary(v)) angle = std::fmod(angle, total);
    const State state = turn_counterclockwise(mesh, outgoing, angle, &beyond);
    return {state, beyond > boundary_angle_tolerance};
  }
  if (!mesh.is_boundary(v)) {
    angle = total - std::fmod(-angle, total);
    return {turn_counterclockwise(mesh, outgoing, angle, &beyond), false};
  }
  // Turns clockwise towards the first face of the fan.
  while (angle < 0 && mesh.twin(outgoing) >= 0) {
    outgoing = TriangleMesh::next(mesh.twin(outgoing));
    angle += mesh.corner_angle(outgoing);
  }
  return {leave_corner(outgoing, std::max(angle, 0.0)), angle < -boundary_angle_tolerance};
}

/// Finds the face into which the path starts.
Departure depart(const TriangleMesh& mesh, const SurfacePoint& start, const Vector3d& tangent) {
  const Index first = 3 * index(start.face);
  if (const int corner = corner_of(start); corner >= 0) return depart_from_corner(mesh, first + corner, tangent);
  const int side = side_of(start);
  const Index h = first + std::max(side, 0);
  State state{h, weights_of(start, h), (halfedge_frame(mesh, h).transpose() * tangent).normalized(),
              side < 0 ? Entrance::inside : Entrance::side};
  if (side < 0 || state.direction[1] >= 0) return {state, false};
  if (mesh.twin(h) < 0) return {state, state.direction[1] < -boundary_angle_tolerance};
  return {cross_halfedge(mesh, h, state.weights[0], state.weights[1], state.direction, Vector2d(1, 0)), false};
}

PathPoint path_point(const TriangleMesh& mesh, const SurfacePoint& point) {
  const int corner = corner_of(point);
  const VertexId vertex = corner < 0 ? VertexId::none : VertexId(mesh.faces()[index(point.face)][corner]);
  return {point, position(mesh, point), vertex};
}

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

double angle_in_face(const TriangleMesh& mesh, FaceId face, const Vector3d& vector) {
  const Vector2d in_frame = tangent_frame(mesh, face).transpose() * vector;
  return std::atan2(in_frame[1], in_frame[0]);
}

}  // namespace

ExponentialMap exponential_map(const TriangleMesh& mesh, const SurfacePoint& start, const Vector3d& tangent,
                               const CancellationToken& cancellation, bool record_trace, std::int64_t max_crossings) {
  const SurfacePoint from = checked_point(mesh, start, "start");
  if (!tangent.allFinite() || !std::isfinite(tangent.norm())) {
    throw Error("exponential_map.non_finite", "The tangent vector is not finite.",
                {{"tangent", "must be three finite numbers of finite length"}});
  }
  const Eigen::Matrix<double, 3, 2> start_frame = tangent_frame(mesh, from.face);
  const Vector2d in_face = start_frame.transpose() * tangent;
  const double requested_length = in_face.stableNorm();
  ExponentialMap result;
  result.end = from;
  result.end_direction.setZero();
  if (record_trace) result.trace.push_back(path_point(mesh, from));
  if (requested_length == 0) return result;

  auto [state, leaves_surface] = depart(mesh, from, start_frame * (in_face / requested_length));
  double remaining = requested_length;
  result.reached_boundary = leaves_surface;
  StopPace pace(cancellation);
  for (std::int64_t crossings = 0; !result.reached_boundary; ++crossings) {
    pace.check();
    if (crossings > max_crossings) {
      throw Error("exponential_map.too_long", "The path crosses more than " + std::to_string(max_crossings) + " edges.",
                  {{"tangent", "has length " + number_text(requested_length) + ", too long for the limit of " +
                                   std::to_string(max_crossings) + " edge crossings (max_crossings)"}});
    }
    const std::array<Vector2d, 3> sides = plane_sides(mesh, state.halfedge);
    const Exit exit = leave_face(state, sides);
    if (exit.travel >= remaining) {
      const double fraction = exit.travel > 0 ? remaining / exit.travel : 0;
      state.weights = clamped(state.weights + fraction * (exit.weights - state.weights));
      remaining = 0;
      break;
    }
    remaining -= exit.travel;
    const Index leaving = following(state.halfedge, exit.k);
    const bool ends_at_boundary = exit.through_corner ? mesh.is_boundary(mesh.tail(leaving)) : mesh.twin(leaving) < 0;
    if (ends_at_boundary) {
      state.weights = exit.weights;
      result.reached_boundary = true;
      break;
    }
    if (record_trace) result.trace.push_back(path_point(mesh, surface_point(state.halfedge, exit.weights)));
    state = exit.through_corner ? pass_vertex(mesh, state, exit.k, sides[exit.k])
                                : cross_halfedge(mesh, leaving, exit.weights[exit.k], exit.weights[(exit.k + 1) % 3],
                                                 state.direction, sides[exit.k]);
  }

  result.length = requested_length - remaining;
  result.end_direction = halfedge_frame(mesh, state.halfedge) * state.direction;
  if (leaves_surface) {
    result.end_direction = start_frame * (in_face / requested_length);
  } else {
    result.end = surface_point(state.halfedge, state.weights);
  }
  result.transport_angle = wrapped(angle_in_face(mesh, result.end.face, result.end_direction) -
                                   angle_in_face(mesh, from.face, start_frame * in_face));
  if (record_trace) result.trace.push_back(path_point(mesh, result.end));
  return result;
}

}  // namespace supple::surface
