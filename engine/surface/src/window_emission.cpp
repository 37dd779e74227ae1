#include "window_emission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace supple::surface {
namespace {

/// A point p of the frame's face as a source, in the frame of the halfedge on the other side of the frame's edge. The
/// second function does the same for the face's apex.
WindowSource source_across(const EdgeFrame& frame, const Eigen::Vector2d& p) {
  return {frame.length - p.x(), std::max(0.0, p.y())};
}
WindowSource apex_across(const EdgeFrame& frame) { return {frame.right_x(), frame.apex_y}; }

/// Improves the corners of a face with a source in it, and emits a window across each side but `entered_through`, on
/// which the source lies. `planar` is the source in the frames of the three sides.
void emit_into_face(SearchFront& front, std::int32_t face, const std::array<Eigen::Vector2d, 3>& planar,
                    std::int32_t origin, int entered_through) {
  const std::int32_t source = -1 - origin;
  front.targets.visit(
      face, [&](SearchTarget& target) { update_by_direct_path(*front.mesh, target, front.sources[source], source); });
  for (int side = 0; side < 3; ++side) {
    const std::int32_t h = 3 * face + side;
    const EdgeFrame& frame = front.mesh->frames[h];
    const Eigen::Vector2d& p = planar[side];
    // The distance is taken in the frame whose origin is the apex, where a source next to the apex keeps its digits.
    front.improve_vertex(frame.apex, planar[(side + 2) % 3].norm(), 0, p.x(), -p.y(), h, Trail::none(), origin, -1);
    const std::int32_t across = front.mesh->mesh->twin(h);
    if (side == entered_through || across < 0) continue;
    const WindowSource behind = source_across(frame, p);
    Window window{0, frame.length, behind.x, behind.depth, 0, Trail::start(), -1, origin};
    front.admit_first(window, across);
  }
}

/// Emits a window through the part [low, high] of a corner's angle, and improves the neighbours at those ends of the
/// corner that the part reaches.
void emit_through(SearchFront& front, std::int32_t v, const FanCorner& corner, double low, double high) {
  const EdgeFrame& frame = front.mesh->frames[TriangleMesh::next(corner.halfedge)];  // v is its apex
  const double sigma = front.vertices.distance(v);
  const double angle = corner.angle;
  if (low <= 0) {
    front.improve_vertex(frame.tail, sigma + frame.left_length, sigma, 0, 0, -1, Trail::none(), v, corner.halfedge);
  }
  if (high >= angle) {
    front.improve_vertex(frame.head, sigma + frame.right_length, sigma, 0, 0, -1, Trail::none(), v,
                         TriangleMesh::previous(corner.halfedge));
  }
  low = std::max(low, 0.0);
  high = std::min(high, angle);
  if (corner.across < 0 || high - low <= 3 * sector_tolerance) return;
  // The ray at angle `turn` from the direction apex to tail meets the opposite edge at this distance from its tail.
  const auto meets = [&](double turn) {
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const double dx = -frame.apex_x() * c + frame.apex_y * s;
    const double dy = -frame.apex_x() * s - frame.apex_y * c;
    return std::clamp(frame.apex_x() - frame.apex_y * dx / dy, 0.0, frame.length);
  };
  const double from = low <= 0 ? 0 : meets(low);
  const double to = high >= angle ? frame.length : meets(high);
  const WindowSource behind = apex_across(frame);
  Window window{frame.length - to, frame.length - from, behind.x, behind.depth, sigma, Trail::start(), -1, v};
  front.admit_first(window, corner.across);
}

/// Emits windows into the sector behind the vertex, for a path that arrives at angle `arrival`. What other arrivals
/// have covered is left out. `recorded` is the angle of the recorded path.
void emit_behind(SearchFront& front, std::int32_t v, double arrival, double recorded) {
  const VertexRecord& record = front.vertices.reached(v);
  const double total = front.mesh->mesh->vertex_angle(v);
  const bool boundary = front.mesh->mesh->is_boundary(v);
  using std::numbers::pi;
  const double first = pi - sector_tolerance;
  const double last = total - pi + sector_tolerance;
  // Angles on either side of the arrival to the nearest arrivals that have been continued.
  double below = infinity;
  double above = infinity;
  const auto leave_out = [&](double other) {
    double turn = other - arrival;
    if (!boundary && turn > 0.5 * total) turn -= total;
    if (!boundary && turn < -0.5 * total) turn += total;
    if (turn <= 0) below = std::min(below, -turn);
    if (turn >= 0) above = std::min(above, turn);
  };
  if (record.emitted) leave_out(recorded);
  const std::vector<TiedArrival>& ties = front.vertices.ties();
  for (std::int32_t i = record.ties; i >= 0; i = ties[i].next) {
    if (ties[i].emitted) leave_out(ties[i].angle);
  }
  if (boundary) {
    // A boundary vertex emits on both sides of the arriving path, where the angle from it is at least pi.
    const bool after_emitted = below < infinity;
    const bool before_emitted = above < infinity;
    for (const FanCorner& corner : front.mesh->fan(v)) {
      const double after = arrival + first - corner.polar_angle;
      if (!after_emitted && after <= corner.angle && after + above >= 0) {
        emit_through(front, v, corner, after, std::min(corner.angle, after + above));
      }
      const double before = arrival - first - corner.polar_angle;
      if (!before_emitted && before >= 0 && before - below <= corner.angle) {
        emit_through(front, v, corner, std::max(0.0, before - below), before);
      }
    }
    return;
  }
  const double from = std::max(first, last - below);
  const double to = std::min(last, first + above);
  if (!(to >= from)) return;
  for (const FanCorner& corner : front.mesh->fan(v)) {
    double relative = corner.polar_angle - arrival;
    if (relative < 0) relative += total;
    const double low = from - relative;
    const double high = to - relative;
    if (low <= corner.angle && high >= 0) emit_through(front, v, corner, low, high);
  }
}

}  // namespace

WindowSource first_source(const SearchMesh& mesh, std::span<const SurfacePoint> sources, std::int32_t origin,
                          std::int32_t h) {
  const std::int32_t behind = mesh.mesh->twin(h);
  const EdgeFrame& frame = mesh.frames[behind];
  if (origin >= 0) return apex_across(frame);
  const SurfacePoint& point = sources[-1 - origin];
  Eigen::Vector3d barycentric = point.barycentric;
  if (TriangleMesh::face_of(behind) != index(point.face)) {
    const int side = side_of(point);
    barycentric = across_side(point, side, mesh.mesh->twin(3 * index(point.face) + side));
  }
  return source_across(frame, planar_point(frame, barycentric, behind % 3));
}

void emit_from_source(SearchFront& front, std::int32_t source) {
  const SurfacePoint& point = front.sources[source];
  const TriangleMesh& mesh = *front.mesh->mesh;
  const std::int32_t face = index(point.face);
  const std::int32_t origin = -1 - source;
  if (const int corner = corner_of(point); corner >= 0) {
    front.improve_vertex(mesh.faces()[face][corner], 0, 0, 0, 0, -1, Trail::none(), origin, -1);
    VertexRecord& record = front.vertices.record(mesh.faces()[face][corner]);
    record.emits = true;
    front.queue_vertex(mesh.faces()[face][corner]);
    return;
  }
  std::array<Eigen::Vector2d, 3> planar;
  for (int side = 0; side < 3; ++side) {
    planar[side] = planar_point(front.mesh->frames[3 * face + side], point.barycentric, side);
  }
  const int side = side_of(point);
  emit_into_face(front, face, planar, origin, side);
  if (side < 0) return;
  const std::int32_t across = mesh.twin(3 * face + side);
  if (across < 0) return;
  const Eigen::Vector3d other = across_side(point, side, across);
  for (int s = 0; s < 3; ++s) {
    planar[s] = planar_point(front.mesh->frames[across - across % 3 + s], other, s);
  }
  emit_into_face(front, TriangleMesh::face_of(across), planar, origin, across % 3);
}

void emit_from_vertex(SearchFront& front, std::int32_t v) {
  VertexRecord& record = front.vertices.reached(v);
  const bool is_source = record.halfedge < 0 && record.along < 0;
  if (is_source || record.emits_all_around) {
    for (const FanCorner& corner : front.mesh->fan(v)) emit_through(front, v, corner, 0, corner.angle);
    return;
  }
  const double recorded = arrival_angle(*front.mesh, record, v);
  if (!record.emitted) emit_behind(front, v, recorded, recorded);
  record.emitted = true;
  std::vector<TiedArrival>& ties = front.vertices.ties();
  for (std::int32_t i = record.ties; i >= 0; i = ties[i].next) {
    if (ties[i].emitted || !front.vertices.within_drop_tolerance(ties[i].length, front.vertices.distance(v))) continue;
    emit_behind(front, v, ties[i].angle, recorded);
    ties[i].emitted = true;
  }
}

}  // namespace supple::surface
