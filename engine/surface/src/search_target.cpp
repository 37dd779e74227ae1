#include "search_target.h"

#include <numbers>

#include "near_vertex.h"

namespace supple::surface {
namespace {

/// A point with two barycentric coordinates below this value is taken for the vertex: its coordinates in the frames of
/// other faces are those of the vertex up to rounding.
constexpr double at_vertex_tolerance = 1e-14;
/// Arrivals whose directions differ by less than this angle (radians) count as one path.
constexpr double same_direction_tolerance = 1e-6;
/// An arrival that is bent at a window's end may stand for a straight path whose window was trimmed on the way. This is
/// assumed if its direction differs from that of the best path by more than this angle (radians). Otherwise it only
/// approximates the best path.
constexpr double other_direction_angle = 0.1;

/// A path whose line misses its window by less than this fraction of the coordinates counts as straight.
constexpr double straight_tolerance = 1e-13;

bool same_direction(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance) {
  const double scale = a.norm() * b.norm();
  return scale == 0 || (a.dot(b) > 0 && std::abs(a.x() * b.y() - a.y() * b.x()) < tolerance * scale);
}

/// Whether both arrivals count as one path.
bool same_path(const Arrival& a, const Arrival& b) {
  if (same_direction(a.image, b.image, std::max(a.rank, b.rank) > 1 ? other_direction_angle : same_direction_tolerance))
    return true;
  // A path that is bent at a vertex and a path by that vertex are the same if both are equally long: a window that
  // passes beside a vertex ends there, and a path bent at its end restarts at the vertex. A longer one stands for
  // another path.
  const auto last = [](const Arrival& x) { return x.bend.isZero(0) ? x.image : x.bend; };
  return !(a.bend.isZero(0) && b.bend.isZero(0)) && std::abs(a.length - b.length) <= tie_tolerance * a.length &&
         same_direction(last(a), last(b), same_direction_tolerance);
}

Eigen::Vector2d in_frame_of_side_zero(const SearchMesh& mesh, const SearchTarget& target, int side,
                                      const Eigen::Vector2d& relative) {
  if (side == 0) return relative;
  // The direction of halfedge s in the frame of side 0 is the rotation between the frames of both sides.
  const EdgeFrame& frame = mesh.frames[3 * index(target.point.face)];
  const Eigen::Vector2d apex(frame.apex_x(), frame.apex_y);
  const Eigen::Vector2d direction =
      side == 1 ? Eigen::Vector2d(Eigen::Vector2d(-frame.right_x(), frame.apex_y) / frame.right_length)
                : Eigen::Vector2d(-apex / frame.left_length);
  return {relative.x() * direction.x() - relative.y() * direction.y(),
          relative.x() * direction.y() + relative.y() * direction.x()};
}

/// a - b for barycentric coordinates in one face. The largest coordinates have the largest absolute rounding, so that
/// their difference is computed from the other two.
Eigen::Vector3d barycentric_difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d d = a - b;
  int largest = 0;
  a.cwiseMax(b).maxCoeff(&largest);
  d[largest] = -(d[(largest + 1) % 3] + d[(largest + 2) % 3]);
  return d;
}

/// Component along h of the vector from the target to the source. h is the halfedge of the target's face that the path
/// crosses. Differences of barycentric coordinates keep the accuracy of points that are a millionth of the edge apart,
/// or as close to one of its ends.
double offset_along_edge(const SearchMesh& mesh, const SurfacePoint& source, const SurfacePoint& target,
                         std::int32_t h) {
  const EdgeFrame& frame = mesh.frames[h];
  const std::int32_t twin = mesh.mesh->twin(h);
  const EdgeFrame& behind = mesh.frames[twin];
  Eigen::Vector3d behind_barycentric = source.barycentric;  // coordinates in the face behind the edge
  if (TriangleMesh::face_of(twin) != index(source.face)) {
    // The source lies on another side of that face, and its coordinates are those in the face beyond that side.
    const std::int32_t side = 3 * index(source.face) + side_of(source);
    const std::int32_t other = mesh.mesh->twin(side);
    behind_barycentric.setZero();
    behind_barycentric[other % 3] = source.barycentric[(side + 1) % 3];
    behind_barycentric[(other + 1) % 3] = source.barycentric[side % 3];
  }
  const double source_head = behind_barycentric[twin % 3];
  const double source_apex = behind_barycentric[(twin + 2) % 3];
  const double target_head = target.barycentric[(h + 1) % 3];
  const double target_apex = target.barycentric[(h + 2) % 3];
  if (source_head > 0.5) {
    // Near the head the offset is measured from the head, where the coordinates are small.
    const double source_tail = behind_barycentric[(twin + 1) % 3];
    const double target_tail = target.barycentric[h % 3];
    return frame.length * (target_tail - source_tail) - source_apex * behind.apex_x() + target_apex * frame.right_x();
  }
  return frame.length * (source_head - target_head) + source_apex * behind.right_x() - target_apex * frame.apex_x();
}

/// A bend within this fraction of the edge from one of its ends is taken to be at the vertex there.
constexpr double bend_at_vertex_tolerance = 1e-9;

/// The end of the edge at which its vertex bends a path; none if the path passes no end, or the vertex cannot bend
/// paths.
enum class BentAt { none, tail, head };
BentAt bent_at(const SearchMesh& mesh, const EdgeFrame& frame, const Arrival& arrival) {
  if (arrival.rank == 0) return BentAt::none;
  if (arrival.crossing <= bend_at_vertex_tolerance * frame.length)
    return mesh.pins(frame.tail) ? BentAt::tail : BentAt::none;
  const bool at_head = arrival.crossing >= (1 - bend_at_vertex_tolerance) * frame.length;
  return at_head && mesh.pins(frame.head) ? BentAt::head : BentAt::none;
}

/// Arrivals longer than this do not change the target.
double max_useful_length(const SearchTarget& target) {
  return std::max(target.best.length * (1 + drop_tolerance), target.competing_length);
}

/// Arrival::rank of the path to (x, y): 0 if the straight line from the window's source passes the interval up to
/// rounding, else 2.
int rank_of(const Window& window, double x, double y) {
  const double total = window.depth + y;
  if (!(total > 0)) return 0;
  const double crossing = window.source_x + (x - window.source_x) * (window.depth / total);
  const double tolerance = straight_tolerance * (std::abs(x) + std::abs(window.source_x));
  return crossing >= window.b0 - tolerance && crossing <= window.b1 + tolerance ? 0 : 2;
}

Eigen::Vector2d polar_image(const SearchMesh& mesh, std::int32_t vertex, double angle, double length) {
  const double turn = mesh.turn_of_images(vertex) / mesh.mesh->vertex_angle(vertex);
  return {length * std::cos(angle * turn), length * std::sin(angle * turn)};
}

double angle_at_apex(const EdgeFrame& frame, double source_x, double depth) {
  const double to_tail_x = -frame.apex_x();
  const double to_tail_y = -frame.apex_y;
  const double to_source_x = source_x - frame.apex_x();
  const double to_source_y = -depth - frame.apex_y;
  return std::atan2(to_tail_x * to_source_y - to_tail_y * to_source_x,
                    to_tail_x * to_source_x + to_tail_y * to_source_y);
}

}  // namespace

std::int32_t nearest_corner(const TriangleMesh& mesh, const SurfacePoint& point) {
  int corner = 0;
  point.barycentric.maxCoeff(&corner);
  return mesh.faces()[index(point.face)][corner];
}

Eigen::Vector3d offset_from(const TriangleMesh& mesh, const SurfacePoint& point, std::int32_t vertex) {
  const Triangle& corners = mesh.faces()[index(point.face)];
  const Eigen::Vector3d& origin = mesh.positions()[vertex];
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) offset += point.barycentric[i] * (mesh.positions()[corners[i]] - origin);
  return offset;
}

SurfacePoint rounded_to_vertex(const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i) {
    if (point.barycentric[(i + 1) % 3] < at_vertex_tolerance && point.barycentric[(i + 2) % 3] < at_vertex_tolerance) {
      return {point.face, Eigen::Vector3d::Unit(i)};
    }
  }
  return point;
}

SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& given) {
  const SurfacePoint point = rounded_to_vertex(given);
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

double last_segment_length(const SearchMesh& mesh, const VertexRecord& record) {
  if (record.along >= 0) return mesh.mesh->edge_length(record.along);
  const EdgeFrame& frame = mesh.frames[record.halfedge];
  return hypotenuse(record.source_x - frame.apex_x(), record.depth + frame.apex_y);
}

void update_target(SearchTarget& target, const Arrival& arrival) {
  const Arrival previous = target.best;
  const double tie = drop_tolerance * arrival.length;
  bool wins = arrival.length < previous.length;
  if (std::abs(arrival.length - previous.length) <= tie) {
    // Among paths of equal length and rank, the one with the longest last segment is taken. The vertices on it then do
    // not seem to pin the path.
    wins = arrival.rank != previous.rank
               ? arrival.rank < previous.rank
               : arrival.image.squaredNorm() > previous.image.squaredNorm() * (1 + drop_tolerance);
    wins = wins || previous.kind == Arrival::Kind::none;
  }
  if (wins) target.best = arrival;
  if (previous.kind == Arrival::Kind::none) return;
  if (wins) target.best.length = std::min(arrival.length, previous.length);
  const Arrival& other = wins ? previous : arrival;
  if (!same_path(target.best, other)) {
    // A new best path has only the previous one as a competitor: earlier competitors may come from its own direction.
    target.competing_length = wins ? other.length : std::min(target.competing_length, other.length);
  }
}

void update_by_window(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target,
                      std::int32_t h, const Window& window) {
  Arrival arrival;
  arrival.kind = Arrival::Kind::window;
  arrival.halfedge = h;
  arrival.origin = window.origin;
  arrival.trail = window.trail;
  if (target.vertex < 0) {
    const int side = h % 3;
    const Eigen::Vector2d& p = target.planar[side];
    arrival.length = length_to(window, p.x(), p.y(), arrival.crossing);
    if (arrival.length > max_useful_length(target)) return;
    arrival.rank = rank_of(window, p.x(), p.y());
    Eigen::Vector2d relative(window.source_x - p.x(), -window.depth - p.y());
    if (window.trail.at_start() && window.origin < 0) {
      relative.x() = offset_along_edge(mesh, sources[-1 - window.origin], target.point, h);
      if (arrival.rank == 0) arrival.length = window.sigma + relative.norm();
    }
    arrival.image = in_frame_of_side_zero(mesh, target, side, relative);
    if (const BentAt bend = bent_at(mesh, mesh.frames[h], arrival); bend != BentAt::none) {
      const Eigen::Vector2d vertex(bend == BentAt::head ? mesh.frames[h].length : 0, 0);
      arrival.bend = in_frame_of_side_zero(mesh, target, side, vertex - p);
    }
  } else {
    const EdgeFrame& frame = mesh.frames[h];
    if (frame.apex != target.vertex) return;
    arrival.length = length_to(window, frame.apex_x(), frame.apex_y, arrival.crossing);
    if (arrival.length > max_useful_length(target)) return;
    arrival.rank = rank_of(window, frame.apex_x(), frame.apex_y);
    const double corner = mesh.polar_angle(TriangleMesh::previous(h));
    const double angle = corner + angle_at_apex(frame, window.source_x, window.depth);
    arrival.image = polar_image(mesh, target.vertex, angle,
                                hypotenuse(window.source_x - frame.apex_x(), window.depth + frame.apex_y));
    if (const BentAt bend = bent_at(mesh, frame, arrival); bend != BentAt::none) {
      const double turn = bend == BentAt::head ? mesh.mesh->corner_angle(TriangleMesh::previous(h)) : 0;
      const double reach = bend == BentAt::head ? frame.right_length : frame.left_length;
      arrival.bend = polar_image(mesh, target.vertex, corner + turn, reach);
    }
  }
  update_target(target, arrival);
}

void update_by_direct_path(const SearchMesh& mesh, SearchTarget& target, const SurfacePoint& source, int source_index) {
  // Sources and targets at vertices are treated by the records of these vertices.
  if (target.vertex >= 0 || corner_of(source) >= 0) return;
  const std::int32_t face = index(target.point.face);
  Arrival arrival;
  arrival.kind = Arrival::Kind::direct;
  arrival.source = source_index;
  if (index(source.face) == face) {
    // Differences of barycentric coordinates keep the relative accuracy of points that are close to each other.
    arrival.image =
        planar_point(mesh.frames[3 * face], barycentric_difference(source.barycentric, target.point.barycentric), 0);
  } else {
    const int side = side_of(source);
    if (side < 0) return;
    const std::int32_t across = mesh.mesh->twin(3 * index(source.face) + side);
    if (across < 0 || TriangleMesh::face_of(across) != face) return;
    Eigen::Vector3d here = Eigen::Vector3d::Zero();
    here[across % 3] = source.barycentric[(side + 1) % 3];
    here[(across + 1) % 3] = source.barycentric[side];
    arrival.image = planar_point(mesh.frames[3 * face], barycentric_difference(here, target.point.barycentric), 0);
  }
  arrival.length = arrival.image.norm();
  update_target(target, arrival);
}

bool arrive_near_vertex(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target) {
  if (target.vertex >= 0) return false;
  Arrival best;
  double competing_length = infinity;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::optional<NearVertexPath> path = path_near_vertex(mesh, sources[i], target.point);
    if (!path || path->length >= best.length) continue;
    // The right-hand side is a lower bound of the target's distance from sources that are not near the vertex.
    if (sources.size() > 1 && path->length > path->near_radius - path->to.norm()) continue;
    best.kind = Arrival::Kind::near_vertex;
    best.length = path->length;
    best.vertex = path->vertex;
    best.source = static_cast<std::int32_t>(i);
    best.image = in_frame_of_side_zero(mesh, target, path->to_corner % 3, -path->arrival);
    competing_length = path->competing_length;
  }
  if (best.kind == Arrival::Kind::none) return false;
  target.best = best;
  target.competing_length = competing_length;
  return true;
}

void update_by_vertex(const SearchMesh& mesh, SearchTarget& target, int corner, double distance,
                      const VertexRecord& record) {
  const std::int32_t v = mesh.mesh->faces()[index(target.point.face)][corner];
  Arrival arrival;
  arrival.kind = Arrival::Kind::vertex;
  arrival.vertex = v;
  if (target.vertex >= 0) {
    if (target.vertex != v) return;
    arrival.length = distance;
    if (!(arrival.length < infinity)) return;
    arrival.rank = 0;  // the record describes the path, straight or not
    if (record.along >= 0 || record.halfedge >= 0) {
      arrival.image = polar_image(mesh, v, arrival_angle(mesh, record, v), last_segment_length(mesh, record));
    }
  } else {
    // In the frame of side `corner`, this corner is the origin.
    const Eigen::Vector2d relative = -target.planar[corner];
    arrival.length = distance + relative.norm();
    if (!(arrival.length < infinity)) return;
    const bool bends = mesh.pins(v) || distance == 0;
    // Up to rounding, a path by a vertex that cannot bend paths is not shorter than those of the windows beside it. It
    // counts only where they leave a gap.
    arrival.rank = bends ? 1 : 3;
    if (!bends && arrival.length >= target.best.length * (1 - drop_tolerance)) return;
    arrival.image = in_frame_of_side_zero(mesh, target, corner, relative);
  }
  update_target(target, arrival);
}

}  // namespace supple::surface
