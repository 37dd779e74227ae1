#include "path_assembly.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "near_vertex.h"
#include "supple/surface/geodesic_derivatives.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A crossing within this fraction of the edge from a vertex is replaced by the vertex.
constexpr double vertex_merge_tolerance = 1e-12;
/// Paths whose lengths differ by less than this relative amount both count as shortest.
constexpr double uniqueness_tolerance = 1e-9;
/// Two arrivals at a vertex whose directions differ by less than this angle (radians) count as one path. A path with
/// such a bend is no other shortest path: a chord past the bend is shorter by more than uniqueness_tolerance.
constexpr double same_path_angle = 1e-4;
/// Number of points of short paths, for which memory is reserved in advance.
constexpr std::size_t short_path_points = 10;

Vector2d rotated(const Vector2d& v, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// Unit direction of halfedge h in the tangent frame of its face.
Vector2d side_direction(const SearchMesh& mesh, std::int32_t h) {
  const EdgeFrame& frame = mesh.frames[h - h % 3];
  const Vector2d apex(frame.apex_x(), frame.apex_y);
  if (h % 3 == 0) return {1, 0};
  if (h % 3 == 1) return Vector2d(-frame.right_x(), frame.apex_y) / frame.right_length;
  return -apex / frame.left_length;
}

/// The vector v, given in the frame of halfedge h, in the tangent frame of its face.
Vector2d to_face(const SearchMesh& mesh, std::int32_t h, const Vector2d& v) {
  const Vector2d d = side_direction(mesh, h);
  return {v.x() * d.x() - v.y() * d.y(), v.x() * d.y() + v.y() * d.x()};
}

/// Unit direction of polar angle `angle` at the tail of halfedge c, in the tangent frame of c's face. Faces in between
/// are unfolded on the side of the vertex with the smaller angle.
Vector2d direction_at_vertex(const SearchMesh& mesh, std::int32_t c, double angle) {
  const TriangleMesh& m = *mesh.mesh;
  double turn = angle - mesh.polar_angle(c);
  const std::int32_t v = m.tail(c);
  const double total = m.vertex_angle(v);
  const double middle = 0.5 * m.corner_angle(c);
  if (!m.is_boundary(v)) {
    while (turn - middle > 0.5 * total) turn -= total;
    while (turn - middle < -0.5 * total) turn += total;
  }
  return rotated(side_direction(mesh, c), turn);
}

std::int32_t corner_halfedge(const SurfacePoint& point, int corner) { return 3 * index(point.face) + corner; }

/// Follows a path back from its target to its source.
class Backtrace {
 public:
  Backtrace(const SearchState& state, bool record_points)
      : state_(state), mesh_(*state.mesh), records_points_(record_points) {
    if (records_points_) points_.reserve(short_path_points);
  }

  void from_target(const SearchTarget& target) {
    const Arrival& best = target.best;
    add_point({target.point, target.position, target.vertex >= 0 ? VertexId(target.vertex) : VertexId::none});
    switch (best.kind) {
      case Arrival::Kind::none:
        return;
      case Arrival::Kind::direct:
        source_ = best.source;
        first_length_ = best.image.norm();
        reach_source_directly(target);
        return;
      case Arrival::Kind::near_vertex:
        source_ = best.source;
        follow_fan(target);
        return;
      case Arrival::Kind::vertex:
        if (best.vertex == target.vertex) {
          follow_record(best.vertex, true);
        } else {
          const Vector2d& p = target.planar[corner_of_vertex(target.point, best.vertex)];
          departure_ = Departure{corner_halfedge(target.point, corner_of_vertex(target.point, best.vertex)), p};
          arrive_at_vertex(best.vertex, p.norm());
        }
        return;
      case Arrival::Kind::window: {
        Vector2d end = target.planar[best.halfedge % 3];
        if (target.vertex >= 0) {
          const EdgeFrame& frame = mesh_.frames[best.halfedge];
          end = {frame.apex_x(), frame.apex_y};
        }
        follow_window(best.halfedge, best.trail, best.origin, end, best.crossing);
      }
    }
  }

  int source() const { return source_; }
  const std::vector<std::int32_t>& pins() const { return pins_; }
  std::vector<PathPoint>& points() { return points_; }
  double first_length() const { return first_length_; }

  /// If the source is a vertex, the polar angle at which the path leaves it; else NaN.
  double from_angle() const {
    if (!departure_ || corner_of(state_.sources[source_]) < 0) return std::numeric_limits<double>::quiet_NaN();
    // The departure is in the frame of an outgoing halfedge of the vertex.
    const std::int32_t h = departure_->halfedge;
    const double angle = mesh_.polar_angle(h) + std::atan2(departure_->vector.y(), departure_->vector.x());
    // At an interior vertex, rounding may put a path along the fan's first edge on either side of it.
    return angle < 0 && !mesh_.mesh->is_boundary(mesh_.mesh->tail(h))
               ? angle + mesh_.mesh->vertex_angle(mesh_.mesh->tail(h))
               : std::max(0.0, angle);
  }

  /// Unit direction of travel at the source in the tangent frame of the source point's face.
  Vector2d from_direction() const {
    const SurfacePoint& source = state_.sources[source_];
    if (!departure_) return direct_;
    const std::int32_t h = departure_->halfedge;
    const Vector2d unit = departure_->vector.normalized();
    if (const int corner = corner_of(source); corner >= 0) {
      // At a vertex the departure is in the frame of an outgoing halfedge of that vertex.
      const double angle = mesh_.polar_angle(h) + std::atan2(departure_->vector.y(), departure_->vector.x());
      return direction_at_vertex(mesh_, corner_halfedge(source, corner), angle);
    }
    if (TriangleMesh::face_of(h) == index(source.face)) return to_face(mesh_, h, unit);
    // The source lies on an edge and the path leaves through the other face, which is unfolded about that edge.
    const std::int32_t side = 3 * index(source.face) + side_of(source);
    const std::int32_t across = mesh_.mesh->twin(side);
    const Vector2d in_face = to_face(mesh_, h, unit);
    const Vector2d along = side_direction(mesh_, across);
    const Vector2d in_edge(in_face.dot(along), -in_face.x() * along.y() + in_face.y() * along.x());
    return to_face(mesh_, side, -in_edge);
  }

 private:
  /// The first straight segment of the path as a vector in the frame of a halfedge of the face in which it starts.
  struct Departure {
    std::int32_t halfedge;
    Vector2d vector;
  };

  int corner_of_vertex(const SurfacePoint& point, std::int32_t v) const {
    const Triangle& corners = mesh_.mesh->faces()[index(point.face)];
    return corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
  }

  void add_point(const PathPoint& point) {
    if (!records_points_) return;
    if (point.vertex != VertexId::none && !points_.empty() && points_.back().vertex == point.vertex) return;
    points_.push_back(point);
  }

  void add_crossing(std::int32_t h, double x) {
    if (!records_points_) return;
    const EdgeFrame& frame = mesh_.frames[h];
    double head = std::clamp(x / frame.length, 0.0, 1.0);
    if (head < vertex_merge_tolerance) return add_vertex(frame.tail);
    if (head > 1 - vertex_merge_tolerance) return add_vertex(frame.head);
    add_point(crossing_point(h, head));
  }

  /// The point of h whose barycentric coordinate with respect to the head of h is `head`.
  PathPoint crossing_point(std::int32_t h, double head) const {
    PathPoint point;
    point.point.face = FaceId(TriangleMesh::face_of(h));
    point.point.barycentric[h % 3] = 1 - head;
    point.point.barycentric[(h + 1) % 3] = head;
    point.position = position(*mesh_.mesh, point.point);
    return point;
  }

  void add_vertex(std::int32_t v) {
    add_point({vertex_point(*mesh_.mesh, VertexId(v)), mesh_.mesh->positions()[v], VertexId(v)});
  }

  void reach_source_directly(const SearchTarget& target) {
    const SurfacePoint& source = state_.sources[source_];
    const std::int32_t face = index(target.point.face);
    const Vector2d travel = -target.best.image;  // in the tangent frame of the target's face
    if (index(source.face) == face) {
      direct_ = travel.normalized();
    } else {
      departure_ = Departure{3 * face, travel};
    }
    finish();
  }

  void follow_fan(const SearchTarget& target) {
    const std::optional<NearVertexPath> path = path_near_vertex(mesh_, state_.sources[source_], target.point);
    departure_ = Departure{path->from_corner, path->departure};
    first_length_ = path->departure.norm();
    if (path->through_vertex()) {
      if (mesh_.pins(path->vertex)) pins_.push_back(path->vertex);
      add_vertex(path->vertex);
    } else {
      const std::vector<FanCrossing> crossings = fan_crossings(mesh_, *path);
      for (auto crossing = crossings.rbegin(); crossing != crossings.rend(); ++crossing) {
        add_point(crossing_point(crossing->halfedge, crossing->x / mesh_.mesh->edge_length(crossing->halfedge)));
      }
    }
    finish();
  }

  /// The edge by which a window has left its face, in the frame of the edge by which it had entered: the origin of the
  /// next window's coordinates, and the unit direction of the edge.
  struct Exit {
    Exit() = default;
    Exit(const EdgeFrame& frame, bool left)
        : origin(left ? Vector2d(0, 0) : Vector2d(frame.apex_x(), frame.apex_y)),
          direction(left ? Vector2d(Vector2d(frame.apex_x(), frame.apex_y) / frame.left_length)
                         : Vector2d(Vector2d(frame.right_x(), -frame.apex_y) / frame.right_length)) {}
    Vector2d origin, direction;
  };

  /// A window on the straight segment that is followed back, with its source unfolded into its frame.
  struct UnfoldedWindow {
    std::int32_t halfedge;
    bool left;  ///< whether it left its face by the left edge, `exit`
    Exit exit;
    WindowSource source;
  };

  /// Calls visit(h, left) for each window before the one that arrived at `h`, back to the (pseudo-)source: with the
  /// halfedge at which the window arrived, and whether it left by the left edge.
  template <typename Visit>
  void visit_windows_backwards(std::int32_t h, Trail trail, Visit&& visit) {
    for (;; trail = state_.trails[trail.earlier()]) {
      for (std::uint32_t turns = trail.turns(); turns > 1; turns >>= 1) {
        // After a right turn, h is the twin of the edge from apex to head, which is next() of the halfedge before.
        const bool left = (turns & 1) == 0;
        const std::int32_t edge = mesh_.mesh->twin(h);
        h = left ? TriangleMesh::next(edge) : TriangleMesh::previous(edge);
        visit(h, left);
      }
      if (trail.earlier() < 0) return;
    }
  }

  /// Adds the crossings of the windows before one that has crossed its edge at x, the latest first. `first` is their
  /// common source in the frame of the first of them.
  void add_crossings(std::span<UnfoldedWindow> windows, const WindowSource& first, double x) {
    // The sources are computed from the first window on, as in the search, so that rounding is the same.
    WindowSource source = first;
    for (std::size_t i = windows.size(); i-- > 0;) {
      windows[i].source = source;
      const EdgeFrame& frame = mesh_.frames[windows[i].halfedge];
      const EdgeFrame::Direction u = windows[i].left ? frame.left_direction() : frame.right_direction();
      source = windows[i].left ? source_across_left(source, u.x, u.y)
                               : source_across_right(source, frame.apex_x(), frame.apex_y, u.x, u.y);
    }
    for (const UnfoldedWindow& w : windows) {
      const Vector2d on_edge = w.exit.origin + x * w.exit.direction;
      // The interval of the window before is not known. The whole edge takes its place, because the rays of a window
      // have come through that interval up to rounding.
      const Window before{0, mesh_.frames[w.halfedge].length, w.source.x, w.source.depth, 0, Trail::none(), -1, -1};
      length_to(before, on_edge.x(), std::max(0.0, on_edge.y()), x);
      add_crossing(w.halfedge, x);
    }
  }

  /// A buffer for all windows of a trail but the last one. It allocates no memory for short trails.
  std::span<UnfoldedWindow> window_buffer(Trail trail) {
    std::size_t windows = trail.turn_count();
    for (std::int32_t i = trail.earlier(); i >= 0; i = state_.trails[i].earlier())
      windows += state_.trails[i].turn_count();
    if (windows <= short_buffer_.size()) return {short_buffer_.data(), windows};
    long_buffer_.resize(windows);
    return long_buffer_;
  }

  /// Follows the straight segment of a window that arrived at halfedge h back from its end, given in the frame of h.
  /// The segment crosses that edge at x.
  void follow_window(std::int32_t h, Trail trail, std::int32_t window_origin, Vector2d end, double x) {
    // If the end lies on the edge that the window crosses, it is the crossing itself.
    if (end.y() > vertex_merge_tolerance * mesh_.frames[h].length) add_crossing(h, x);
    std::span<UnfoldedWindow> windows;
    if (records_points_) {
      windows = window_buffer(trail);
      const std::size_t points = points_.size() + windows.size() + 2;
      if (points_.capacity() < points) points_.reserve(std::max(points, 2 * points_.capacity()));
    }
    std::int32_t first_halfedge = h;
    std::size_t place = 0;
    visit_windows_backwards(h, trail, [&](std::int32_t before, bool left) {
      const Exit exit(mesh_.frames[before], left);
      const Vector2d normal(-exit.direction.y(), exit.direction.x());
      end = exit.origin + end.x() * exit.direction + end.y() * normal;
      first_halfedge = before;
      if (records_points_) windows[place++] = {before, left, exit, {}};
    });
    const WindowSource first = first_source(mesh_, state_.sources, window_origin, first_halfedge);
    if (records_points_) add_crossings(windows, first, x);
    const Vector2d vector = end - Vector2d(first.x, -first.depth);
    // The departure is in the frame of the edge's other side, whose face contains the (pseudo-)source.
    const std::int32_t behind = mesh_.mesh->twin(first_halfedge);
    departure_ = Departure{behind, -vector};
    if (window_origin < 0) {
      source_ = -1 - window_origin;
      first_length_ = vector.norm();
      finish();
    } else {
      // The vertex is the apex of `behind`. The vector is rotated into the frame of its outgoing halfedge.
      const std::int32_t outgoing = TriangleMesh::previous(behind);
      const Vector2d in_face = to_face(mesh_, behind, -vector);
      const Vector2d along = side_direction(mesh_, outgoing);
      departure_ = Departure{outgoing, {in_face.dot(along), -in_face.x() * along.y() + in_face.y() * along.x()}};
      arrive_at_vertex(window_origin, vector.norm());
    }
  }

  /// Continues at vertex v, the beginning of the segment that was followed last. `departure_` starts at v.
  void arrive_at_vertex(std::int32_t v, double segment_length) {
    const VertexRecord& record = state_.records[v];
    if (record.halfedge < 0 && record.along < 0) {
      source_ = -1 - record.origin;
      first_length_ = segment_length;
      finish();
      return;
    }
    pins_.push_back(v);
    follow_record(v, false);
  }

  /// Follows the recorded path to vertex v. `is_target` says that v is the end of the whole path.
  void follow_record(std::int32_t v, bool is_target) {
    const VertexRecord& record = state_.records[v];
    if (!is_target) add_vertex(v);
    if (record.along >= 0) {
      const TriangleMesh& m = *mesh_.mesh;
      const bool outward = m.tail(record.along) == record.origin;
      const double length = m.edge_length(record.along);
      if (outward) {
        departure_ = Departure{record.along, {length, 0}};
      } else {
        // The halfedge ends at the origin. The next one leaves it, and the edge is one corner angle further.
        const std::int32_t outgoing = TriangleMesh::next(record.along);
        departure_ = Departure{outgoing, rotated({length, 0}, m.corner_angle(outgoing))};
      }
      arrive_at_vertex(record.origin, length);
    } else if (record.trail.known()) {
      const EdgeFrame& frame = mesh_.frames[record.halfedge];
      follow_window(record.halfedge, record.trail, record.origin, {frame.apex_x(), frame.apex_y}, record.crossing);
    } else if (record.halfedge >= 0) {
      const EdgeFrame& frame = mesh_.frames[record.halfedge];
      const Vector2d vector(frame.apex_x() - record.source_x, frame.apex_y + record.depth);
      source_ = -1 - record.origin;
      first_length_ = vector.norm();
      departure_ = Departure{record.halfedge, vector};
      finish();
    } else {
      source_ = -1 - record.origin;
      first_length_ = 0;
    }
  }

  void finish() {
    if (!records_points_) return;
    const SurfacePoint& source = state_.sources[source_];
    const int corner = corner_of(source);
    add_point({source, position(*mesh_.mesh, source),
               corner >= 0 ? VertexId(mesh_.mesh->faces()[index(source.face)][corner]) : VertexId::none});
  }

  const SearchState& state_;
  const SearchMesh& mesh_;
  bool records_points_;
  int source_ = -1;
  double first_length_ = 0;
  std::optional<Departure> departure_;
  Vector2d direct_ = Vector2d::Zero();
  std::vector<std::int32_t> pins_;
  std::vector<PathPoint> points_;
  std::array<UnfoldedWindow, short_path_points> short_buffer_;
  std::vector<UnfoldedWindow> long_buffer_;
};

Vector2d arrival_direction(const SearchState& state, const SearchTarget& target) {
  const SearchMesh& mesh = *state.mesh;
  if (target.vertex < 0) return -target.best.image.normalized();
  const double whole = mesh.turn_of_images(target.vertex);
  const double turn = mesh.mesh->vertex_angle(target.vertex) / whole;
  double angle = std::atan2(target.best.image.y(), target.best.image.x());
  // At a boundary, images cover half of the full turn only. An angle just below 0 is 0 up to rounding, and not the
  // other side of the boundary.
  if (angle < -0.5 * (2 * std::numbers::pi - whole)) angle += 2 * std::numbers::pi;
  return -direction_at_vertex(mesh, corner_halfedge(target.point, corner_of(target.point)), angle * turn);
}

/// Length by which the best path to a vertex from another direction exceeds the recorded path; infinity if no path of
/// about that length has arrived.
double competing_excess_at(const SearchState& state, std::int32_t v) {
  const SearchMesh& mesh = *state.mesh;
  const VertexRecord& record = state.records[v];
  double min_excess = infinity;
  if (record.ties < 0) return min_excess;
  const double angle = arrival_angle(mesh, record, v);
  const double total = mesh.mesh->is_boundary(v) ? infinity : mesh.mesh->vertex_angle(v);
  const double length = record.sigma + last_segment_length(mesh, record);
  for (std::int32_t i = record.ties; i >= 0; i = state.ties[i].next) {
    const double turn = std::abs(state.ties[i].angle - angle);
    if (std::min(turn, total - turn) < same_path_angle) continue;
    // A path that tied with an earlier record, which has been improved since, may be too long now.
    const double excess = std::max(0.0, state.ties[i].length - length);
    if (excess <= uniqueness_tolerance * length) min_excess = std::min(min_excess, excess);
  }
  return min_excess;
}

}  // namespace

int source_of(const SearchState& state, const SearchTarget& target) {
  if (target.best.kind == Arrival::Kind::none) return -1;
  Backtrace trace(state, false);
  trace.from_target(target);
  return trace.source();
}

PathStart start_of(const SearchState& state, const SearchTarget& target) {
  PathStart start;
  if (target.best.kind == Arrival::Kind::none) return start;
  Backtrace trace(state, false);
  trace.from_target(target);
  start.direction = trace.from_direction();
  start.angle = trace.from_angle();
  return start;
}

Geodesic assemble(const SearchState& state, const SearchTarget& target, const GeodesicOptions& options) {
  Geodesic result;
  const Arrival& best = target.best;
  if (best.kind == Arrival::Kind::none) return result;
  result.unreachable = false;
  result.distance = best.length;
  result.competing_excess = std::max(0.0, target.competing_length - best.length);
  const bool is_mollified = options.mollifier > 0 && options.derivatives > 0;
  Backtrace trace(state, options.path || is_mollified);
  trace.from_target(target);
  for (const std::int32_t v : trace.pins()) {
    result.pinned_at.push_back(VertexId(v));
    // Two paths may be different up to a vertex and the same from there to the target.
    if (state.records) result.competing_excess = std::min(result.competing_excess, competing_excess_at(state, v));
  }
  result.unique = result.competing_excess > uniqueness_tolerance * best.length;
  std::reverse(result.pinned_at.begin(), result.pinned_at.end());
  std::reverse(trace.points().begin(), trace.points().end());
  if (best.length > 0 && options.derivatives > 0) {
    const SurfacePoint& from = state.sources[trace.source()];
    if (is_mollified) {
      PathLength mollified =
          mollified_length(*state.mesh->mesh, trace.points(), options.mollifier, options.mollified_ends);
      result.mollified_distance = mollified.length;
      result.derivatives = mollified.derivatives;
    } else {
      PathEnds ends;
      ends.from_direction = trace.from_direction();
      ends.to_direction = arrival_direction(state, target);
      ends.first_length = trace.first_length();
      ends.pinned = !result.pinned_at.empty();
      ends.last_length = ends.pinned ? best.image.norm() : best.length;
      if (!ends.pinned) ends.first_length = best.length;
      result.derivatives = end_derivatives(*state.mesh->mesh, from, target.point, ends, options.derivatives);
    }
  }
  if (options.path) result.path = std::move(trace.points());
  return result;
}

GeodesicDerivatives end_derivatives(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                    const PathEnds& ends, int order) {
  GeodesicDerivatives result;
  result.tangent_gradient << -ends.from_direction, ends.to_direction;
  if (order > 1) {
    // The second derivatives of a straight segment's length L are n n^T / L at its ends, with the normal n in the face.
    const Vector2d n0(-ends.from_direction.y(), ends.from_direction.x());
    const Vector2d n1(-ends.to_direction.y(), ends.to_direction.x());
    result.tangent_hessian.topLeftCorner<2, 2>() = n0 * n0.transpose() / ends.first_length;
    result.tangent_hessian.bottomRightCorner<2, 2>() = n1 * n1.transpose() / ends.last_length;
    if (!ends.pinned) {
      result.tangent_hessian.topRightCorner<2, 2>() = -n0 * n1.transpose() / ends.first_length;
      result.tangent_hessian.bottomLeftCorner<2, 2>() = -n1 * n0.transpose() / ends.first_length;
    }
  }
  express_in_barycentrics(mesh, from, to, result);
  return result;
}

}  // namespace supple::surface
