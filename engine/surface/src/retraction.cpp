#include "supple/surface/retraction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple::surface {
namespace {

using std::numbers::pi;

/// A vertex whose total angle differs from 2 pi by at most this (radians) is treated as a point of a flat face.
constexpr double flat_angle_tolerance = 1e-12;

/// The fraction of a length that was travelled: 1 unless the boundary ended the path.
double travelled_fraction(const ExponentialMap& geodesic, double length) {
  return geodesic.reached_boundary && length > 0 ? std::min(1.0, geodesic.length / length) : 1.0;
}

Retraction retract_from_tip(const TriangleMesh& mesh, std::int32_t vertex, Eigen::Vector2d step,
                            const CancellationToken& cancellation) {
  const VertexCone cone(mesh, vertex);
  if (cone.open()) step[1] = std::max(step[1], 0.0);
  double angle = std::atan2(step[1], step[0]);
  if (angle < 0) angle += 2 * pi;
  const double length = step.norm();
  const VertexCone::Direction direction = cone.direction(std::min(angle / cone_angle_scale(cone), cone.total_angle()));
  const ExponentialMap geodesic =
      exponential_map(mesh, direction.vertex, length * direction.vector, cancellation, false);
  return {geodesic.end, travelled_fraction(geodesic, length) * step, 0, false};
}

}  // namespace

double cone_angle_scale(const VertexCone& cone) { return (cone.open() ? pi : 2 * pi) / cone.total_angle(); }

Eigen::Vector2d cone_coordinates(const VertexCone& cone, double angle) {
  return {std::cos(angle * cone_angle_scale(cone)), std::sin(angle * cone_angle_scale(cone))};
}

bool on_cone_tip(const TriangleMesh& mesh, const SurfacePoint& point) {
  const int corner = corner_of(point);
  if (corner < 0) return false;
  const std::int32_t vertex = mesh.faces()[index(point.face)][corner];
  return mesh.is_boundary(vertex) || std::abs(mesh.vertex_angle(vertex) - 2 * pi) > flat_angle_tolerance;
}

Retraction retract(const TriangleMesh& mesh, const SurfacePoint& point, const Eigen::Vector2d& step,
                   const CancellationToken& cancellation) {
  if (on_cone_tip(mesh, point))
    return retract_from_tip(mesh, mesh.faces()[index(point.face)][corner_of(point)], step, cancellation);
  const auto frame = tangent_frame(mesh, point.face);
  Eigen::Vector3d tangent = frame * step;
  bool slid = false;
  const int side = side_of(point);
  if (side >= 0 && mesh.twin(3 * index(point.face) + side) < 0) {
    const Triangle& face = mesh.faces()[index(point.face)];
    const auto& positions = mesh.positions();
    const Eigen::Vector3d along = (positions[face[(side + 1) % 3]] - positions[face[side]]).normalized();
    const Eigen::Vector3d to_apex = positions[face[(side + 2) % 3]] - positions[face[side]];
    const Eigen::Vector3d inward = (to_apex - along.dot(to_apex) * along).normalized();
    if (tangent.dot(inward) < 0) {
      tangent = along.dot(tangent) * along;
      slid = true;
    }
  }
  const ExponentialMap geodesic = exponential_map(mesh, point, tangent, cancellation, false);
  const double fraction = travelled_fraction(geodesic, tangent.norm());
  const Eigen::Vector2d travelled = slid ? Eigen::Vector2d(fraction * (frame.transpose() * tangent)) : fraction * step;
  return {geodesic.end, travelled, geodesic.transport_angle, !slid && !on_cone_tip(mesh, geodesic.end)};
}

}  // namespace supple::surface
