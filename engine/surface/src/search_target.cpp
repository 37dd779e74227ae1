#include <numbers>

#include "near_vertex.h"
#include "window_search.h"

namespace supple::surface {
namespace {

/// Closer to a vertex than this, relative to the face, a point cannot be told from it: its coordinates in the frames of
/// other faces are the vertex's own, up to rounding.
constexpr double kAtVertex = 1e-14;
/// Arrivals whose directions differ by less (radians) are one path, or as good as one.
constexpr double kSameDirection = 1e-6;
/// An arrival bent at a window's end stands for a straight one that another window has displaced before it came here,
/// if it comes from well elsewhere (radians); from nearby it only hugs the best path.
constexpr double kElsewhere = 0.1;

/// How far outside its window, relative to the coordinates, a straight line may cross and still count as straight.
constexpr double kStraightTolerance = 1e-13;

bool same_direction(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance) {
  const double scale = a.norm() * b.norm();
  return scale == 0 || (a.dot(b) > 0 && std::abs(a.x() * b.y() - a.y() * b.x()) < tolerance * scale);
}

/// Whether both are one path, or as good as one.
bool same_path(const Arrival& a, const Arrival& b) {
  if (same_direction(a.image, b.image, std::max(a.rank, b.rank) > 1 ? kElsewhere : kSameDirection)) return true;
  // A path that is bent at a vertex is the one that the vertex offers, if it is as long: a vertex that holds the path
  // is an end of windows that come by it. If it is longer, it stands for another one.
  const auto last = [](const Arrival& x) { return x.bend.isZero(0) ? x.image : x.bend; };
  return !(a.bend.isZero(0) && b.bend.isZero(0)) && std::abs(a.length - b.length) <= kTieTolerance * a.length &&
         same_direction(last(a), last(b), kSameDirection);
}

Eigen::Vector2d to_side_zero(const SearchMesh& mesh, const SearchTarget& target, int side,
                             const Eigen::Vector2d& relative) {
  if (side == 0) return relative;
  // The frame of side s is turned against that of side 0 by the direction of halfedge s in the frame of side 0.
  const EdgeFrame& frame = mesh.frames[3 * index(target.point.face)];
  const Eigen::Vector2d apex(frame.apex_x(), frame.apex_y);
  const Eigen::Vector2d direction =
      side == 1 ? Eigen::Vector2d(Eigen::Vector2d(-frame.right_x(), frame.apex_y) / frame.right_length)
                : Eigen::Vector2d(-apex / frame.left_length);
  return {relative.x() * direction.x() - relative.y() * direction.y(),
          relative.x() * direction.y() + relative.y() * direction.x()};
}

/// a - b for barycentric coordinates of one face. The largest coordinates have the fewest digits after the point, so
/// that their difference is taken from the other two.
Eigen::Vector3d difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d d = a - b;
  int largest = 0;
  a.cwiseMax(b).maxCoeff(&largest);
  d[largest] = -(d[(largest + 1) % 3] + d[(largest + 2) % 3]);
  return d;
}

/// Offset along h, which leads from the source's face into the target's, from the target to the source. From
/// differences of barycentrics: points a millionth of the edge apart keep their relative accuracy, and so do points as
/// close to one of its ends.
double across_edge(const SearchMesh& mesh, const SurfacePoint& source, const SurfacePoint& target, std::int32_t h) {
  const EdgeFrame& frame = mesh.frames[h];
  const std::int32_t twin = mesh.mesh->twin(h);
  const EdgeFrame& behind = mesh.frames[twin];
  Eigen::Vector3d seen = source.barycentric;  // in the face behind the edge
  if (TriangleMesh::face_of(twin) != index(source.face)) {
    // The source lies on another side of that face and is written in the face beyond.
    const std::int32_t side = 3 * index(source.face) + side_of(source);
    const std::int32_t other = mesh.mesh->twin(side);
    seen.setZero();
    seen[other % 3] = source.barycentric[(side + 1) % 3];
    seen[(other + 1) % 3] = source.barycentric[side % 3];
  }
  const double source_head = seen[twin % 3];
  const double source_apex = seen[(twin + 2) % 3];
  const double target_head = target.barycentric[(h + 1) % 3];
  const double target_apex = target.barycentric[(h + 2) % 3];
  if (source_head > 0.5) {
    // Counted from the head, as everything that is small there.
    const double source_tail = seen[(twin + 1) % 3];
    const double target_tail = target.barycentric[h % 3];
    return frame.length * (target_tail - source_tail) - source_apex * behind.apex_x() + target_apex * frame.right_x();
  }
  return frame.length * (source_head - target_head) + source_apex * behind.right_x() - target_apex * frame.apex_x();
}

/// A bend this close to an end of the edge, relative to it, is the vertex there.
constexpr double kBentAtVertex = 1e-9;

/// Whether a path through a window's end is bent at a vertex that can hold it: at the edge's tail, at its head, or
/// (none) at neither.
enum class BentAt { none, tail, head };
BentAt bent_at(const SearchMesh& mesh, const EdgeFrame& frame, const Arrival& arrival) {
  if (arrival.rank == 0) return BentAt::none;
  if (arrival.crossing <= kBentAtVertex * frame.length) return mesh.pins(frame.tail) ? BentAt::tail : BentAt::none;
  const bool at_head = arrival.crossing >= (1 - kBentAtVertex) * frame.length;
  return at_head && mesh.pins(frame.head) ? BentAt::head : BentAt::none;
}

/// Arrivals longer than this change nothing.
double worst_of_use(const SearchTarget& target) {
  return std::max(target.best.length * (1 + kDropTolerance), target.competing_length);
}

/// 0 where the straight line from the window's source to (x, y) passes its interval, up to rounding, else 2.
int rank_of(const Window& window, double x, double y) {
  const double total = window.depth + y;
  if (!(total > 0)) return 0;
  const double crossing = window.source_x + (x - window.source_x) * (window.depth / total);
  const double tolerance = kStraightTolerance * (std::abs(x) + std::abs(window.source_x));
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

SurfacePoint snapped(const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i) {
    if (point.barycentric[(i + 1) % 3] < kAtVertex && point.barycentric[(i + 2) % 3] < kAtVertex) {
      return {point.face, Eigen::Vector3d::Unit(i)};
    }
  }
  return point;
}

SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& given) {
  const SurfacePoint point = snapped(given);
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

double last_piece(const SearchMesh& mesh, const VertexRecord& record) {
  if (record.along >= 0) return mesh.mesh->edge_length(record.along);
  const EdgeFrame& frame = mesh.frames[record.halfedge];
  return hypotenuse(record.source_x - frame.apex_x(), record.depth + frame.apex_y);
}

void offer(SearchTarget& target, const Arrival& arrival) {
  const Arrival previous = target.best;
  const double tie = kDropTolerance * arrival.length;
  bool wins = arrival.length < previous.length;
  if (std::abs(arrival.length - previous.length) <= tie) {
    // Of ways of equal length and rank, the one whose last piece is longest passes vertices that pin nothing.
    wins = arrival.rank != previous.rank
               ? arrival.rank < previous.rank
               : arrival.image.squaredNorm() > previous.image.squaredNorm() * (1 + kDropTolerance);
    wins = wins || previous.kind == Arrival::Kind::none;
  }
  if (wins) target.best = arrival;
  if (previous.kind == Arrival::Kind::none) return;
  if (wins) target.best.length = std::min(arrival.length, previous.length);
  const Arrival& other = wins ? previous : arrival;
  if (!same_path(target.best, other)) {
    // A displaced best may come from where the new one comes from, and then says nothing of competitors.
    target.competing_length = wins ? other.length : std::min(target.competing_length, other.length);
  }
}

void offer_window(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target, std::int32_t h,
                  const Window& window) {
  Arrival arrival;
  arrival.kind = Arrival::Kind::window;
  arrival.halfedge = h;
  arrival.origin = window.origin;
  arrival.trail = window.trail;
  if (target.vertex < 0) {
    const int side = h % 3;
    const Eigen::Vector2d& p = target.planar[side];
    arrival.length = length_to(window, p.x(), p.y(), arrival.crossing);
    if (arrival.length > worst_of_use(target)) return;
    arrival.rank = rank_of(window, p.x(), p.y());
    Eigen::Vector2d relative(window.source_x - p.x(), -window.depth - p.y());
    if (window.trail.at_start() && window.origin < 0) {
      relative.x() = across_edge(mesh, sources[-1 - window.origin], target.point, h);
      if (arrival.rank == 0) arrival.length = window.sigma + relative.norm();
    }
    arrival.image = to_side_zero(mesh, target, side, relative);
    if (const BentAt bend = bent_at(mesh, mesh.frames[h], arrival); bend != BentAt::none) {
      const Eigen::Vector2d vertex(bend == BentAt::head ? mesh.frames[h].length : 0, 0);
      arrival.bend = to_side_zero(mesh, target, side, vertex - p);
    }
  } else {
    const EdgeFrame& frame = mesh.frames[h];
    if (frame.apex != target.vertex) return;
    arrival.length = length_to(window, frame.apex_x(), frame.apex_y, arrival.crossing);
    if (arrival.length > worst_of_use(target)) return;
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
    arrival.image = planar_point(mesh.frames[3 * face], difference(source.barycentric, target.point.barycentric), 0);
  } else {
    const int side = side_of(source);
    if (side < 0) return;
    const std::int32_t across = mesh.mesh->twin(3 * index(source.face) + side);
    if (across < 0 || TriangleMesh::face_of(across) != face) return;
    Eigen::Vector3d here = Eigen::Vector3d::Zero();
    here[across % 3] = source.barycentric[(side + 1) % 3];
    here[(across + 1) % 3] = source.barycentric[side];
    arrival.image = planar_point(mesh.frames[3 * face], difference(here, target.point.barycentric), 0);
  }
  arrival.length = arrival.image.norm();
  offer(target, arrival);
}

bool arrive_near_vertex(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target) {
  if (target.vertex >= 0) return false;
  Arrival best;
  double competing_length = kInfinity;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::optional<NearVertexPath> path = path_near_vertex(mesh, sources[i], target.point);
    if (!path || path->length >= best.length) continue;
    // Sources that are not near the vertex are at least this far from the target.
    if (sources.size() > 1 && path->length > path->reach - path->to.norm()) continue;
    best.kind = Arrival::Kind::near_vertex;
    best.length = path->length;
    best.vertex = path->vertex;
    best.source = static_cast<std::int32_t>(i);
    best.image = to_side_zero(mesh, target, path->to_corner % 3, -path->arrival);
    competing_length = path->competing_length;
  }
  if (best.kind == Arrival::Kind::none) return false;
  target.best = best;
  target.competing_length = competing_length;
  return true;
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
    arrival.rank = 0;  // whatever its last piece is, the record has it
    if (record.along >= 0 || record.halfedge >= 0) {
      arrival.image = polar_image(mesh, v, arrival_angle(mesh, record, v), last_piece(mesh, record));
    }
  } else {
    // In the frame of side `corner` this corner is the origin.
    const Eigen::Vector2d relative = -target.planar[corner];
    arrival.length = distance + relative.norm();
    if (!(arrival.length < kInfinity)) return;
    const bool bends = mesh.pins(v) || distance == 0;
    // Paths by other vertices are longer than the window beside them, up to rounding: they count only to fill a gap.
    arrival.rank = bends ? 1 : 3;
    if (!bends && arrival.length >= target.best.length * (1 - kDropTolerance)) return;
    arrival.image = to_side_zero(mesh, target, corner, relative);
  }
  offer(target, arrival);
}

}  // namespace supple::surface
