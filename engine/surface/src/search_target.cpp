#include <numbers>

#include "window_search.h"

namespace supple::surface {
namespace {

/// Two arrivals come from the same direction if their unfolded sources are closer than this, relative to the length.
constexpr double kSameImage = 1e-6;

Eigen::Vector2d to_side_zero(const SearchMesh& mesh, const SearchTarget& target, int side, const Eigen::Vector2d& relative) {
  if (side == 0) return relative;
  // The frame of side s is turned against that of side 0 by the direction of halfedge s in the frame of side 0.
  const EdgeFrame& frame = mesh.frames[3 * index(target.point.face)];
  const Eigen::Vector2d apex(frame.apex_x, frame.apex_y);
  const Eigen::Vector2d direction =
      side == 1 ? Eigen::Vector2d((apex - Eigen::Vector2d(frame.length, 0)) / frame.right_length)
                : Eigen::Vector2d(-apex / frame.left_length);
  return {relative.x() * direction.x() - relative.y() * direction.y(),
          relative.x() * direction.y() + relative.y() * direction.x()};
}

Eigen::Vector2d polar_image(const SearchMesh& mesh, std::int32_t vertex, double angle, double length) {
  const double turn = 2 * std::numbers::pi / mesh.mesh->vertex_angle(vertex);
  return {length * std::cos(angle * turn), length * std::sin(angle * turn)};
}

double angle_at_apex(const EdgeFrame& frame, double source_x, double depth) {
  const double to_tail_x = -frame.apex_x;
  const double to_tail_y = -frame.apex_y;
  const double to_source_x = source_x - frame.apex_x;
  const double to_source_y = -depth - frame.apex_y;
  return std::atan2(to_tail_x * to_source_y - to_tail_y * to_source_x,
                    to_tail_x * to_source_x + to_tail_y * to_source_y);
}

}  // namespace

SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& point) {
  SearchTarget target;
  target.point = point;
  const std::int32_t face = index(point.face);
  const int corner = corner_of(point);
  if (corner >= 0) target.vertex = mesh.mesh->faces()[face][corner];
  for (int side = 0; side < 3; ++side) {
    target.planar[side] = planar_point(mesh.frames[3 * face + side], point.barycentric, side);
  }
  target.position = position(*mesh.mesh, point);
  return target;
}

double arrival_angle(const SearchMesh& mesh, const VertexRecord& record, std::int32_t vertex) {
  const TriangleMesh& m = *mesh.mesh;
  if (record.along >= 0) {
    if (m.tail(record.along) == vertex) return mesh.polar_angle(record.along);
    const std::int32_t corner = TriangleMesh::next(record.along);
    return mesh.polar_angle(corner) + m.corner_angle(corner);
  }
  return mesh.polar_angle(TriangleMesh::previous(record.halfedge)) +
         angle_at_apex(mesh.frames[record.halfedge], record.source_x, record.depth);
}

void offer(SearchTarget& target, const Arrival& arrival) {
  // Bent ways only fill gaps that rounding may leave: they yield to straight ones of the same length.
  double limit = target.best.length;
  if (arrival.bent && !target.best.bent) limit *= 1 - kDropTolerance;
  if (!arrival.bent && target.best.bent) limit *= 1 + kDropTolerance;
  if (arrival.length < limit) {
    const Arrival previous = target.best;
    target.best = arrival;
    if (previous.kind != Arrival::Kind::none && !previous.bent &&
        (previous.image - arrival.image).norm() > kSameImage * previous.length) {
      target.competing_length = previous.length;
    }
  } else if (!arrival.bent && arrival.length < target.competing_length &&
             (target.best.image - arrival.image).norm() > kSameImage * arrival.length) {
    target.competing_length = arrival.length;
  }
}

namespace {

/// Whether the straight way from the window's source to (x, y) misses the interval by more than rounding.
bool misses_interval(const Window& window, double x, double y) {
  const double total = window.depth + y;
  const double crossing = total > 0 ? window.source_x + (x - window.source_x) * (window.depth / total) : x;
  const double rounding = kDropTolerance * (std::abs(window.b0) + std::abs(window.b1));
  return crossing < window.b0 - rounding || crossing > window.b1 + rounding;
}

}  // namespace

void offer_window(const SearchMesh& mesh, SearchTarget& target, std::int32_t h, const Window& window,
                  std::int32_t window_index) {
  Arrival arrival;
  arrival.kind = Arrival::Kind::window;
  arrival.window = window_index;
  if (target.vertex < 0) {
    const int side = h % 3;
    const Eigen::Vector2d& p = target.planar[side];
    arrival.length = length_to(window, p.x(), p.y(), arrival.crossing);
    if (arrival.length >= target.best.length * (1 + kDropTolerance) && arrival.length >= target.competing_length) return;
    arrival.bent = misses_interval(window, p.x(), p.y());
    arrival.image = to_side_zero(mesh, target, side, {window.source_x - p.x(), -window.depth - p.y()});
  } else {
    const EdgeFrame& frame = mesh.frames[h];
    if (frame.apex != target.vertex) return;
    arrival.length = length_to(window, frame.apex_x, frame.apex_y, arrival.crossing);
    if (arrival.length >= target.best.length * (1 + kDropTolerance) && arrival.length >= target.competing_length) return;
    arrival.bent = misses_interval(window, frame.apex_x, frame.apex_y);
    const double angle = mesh.polar_angle(TriangleMesh::previous(h)) +
                         angle_at_apex(frame, window.source_x, window.depth);
    arrival.image = polar_image(mesh, target.vertex, angle,
                                hypotenuse(window.source_x - frame.apex_x, window.depth + frame.apex_y));
  }
  offer(target, arrival);
}

void offer_direct(const SearchMesh& mesh, SearchTarget& target, const SurfacePoint& source, int source_index) {
  // Vertices have their own records, as sources and as targets.
  if (target.vertex >= 0 || corner_of(source) >= 0) return;
  const std::int32_t face = index(target.point.face);
  Arrival arrival;
  arrival.kind = Arrival::Kind::direct;
  arrival.source = source_index;
  if (index(source.face) == face) {
    // From differences of barycentrics, so that close points keep their relative accuracy.
    arrival.image = planar_point(mesh.frames[3 * face], source.barycentric - target.point.barycentric, 0);
  } else {
    const int side = side_of(source);
    if (side < 0) return;
    const std::int32_t across = mesh.mesh->twin(3 * index(source.face) + side);
    if (across < 0 || TriangleMesh::face_of(across) != face) return;
    Eigen::Vector3d here = Eigen::Vector3d::Zero();
    here[across % 3] = source.barycentric[(side + 1) % 3];
    here[(across + 1) % 3] = source.barycentric[side];
    arrival.image = planar_point(mesh.frames[3 * face], here - target.point.barycentric, 0);
  }
  arrival.length = arrival.image.norm();
  offer(target, arrival);
}

void offer_vertex(const SearchMesh& mesh, SearchTarget& target, int corner, double distance,
                  const VertexRecord& record) {
  const std::int32_t v = mesh.mesh->faces()[index(target.point.face)][corner];
  Arrival arrival;
  arrival.kind = Arrival::Kind::vertex;
  arrival.vertex = v;
  if (target.vertex >= 0) {
    if (target.vertex != v) return;
    arrival.length = distance;
    if (!(arrival.length < kInfinity)) return;
    if (record.along >= 0 || record.halfedge >= 0) {
      const double reach = record.along >= 0
                               ? mesh.mesh->edge_length(record.along)
                               : hypotenuse(record.source_x - mesh.frames[record.halfedge].apex_x,
                                            record.depth + mesh.frames[record.halfedge].apex_y);
      arrival.image = polar_image(mesh, v, arrival_angle(mesh, record, v), reach);
    }
  } else {
    // In the frame of side `corner` this corner is the origin.
    const Eigen::Vector2d relative = -target.planar[corner];
    arrival.length = distance + relative.norm();
    if (!(arrival.length < kInfinity)) return;
    const bool bends = mesh.pins(v) || distance == 0;
    if (!bends) {
      // Paths by other vertices are longer than the window beside them, up to rounding: they count only to fill a gap.
      if (arrival.length >= target.best.length * (1 - kDropTolerance)) return;
    }
    arrival.image = to_side_zero(mesh, target, corner, relative);
  }
  offer(target, arrival);
}

}  // namespace supple::surface
