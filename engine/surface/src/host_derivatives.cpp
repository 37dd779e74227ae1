#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "edge_frames.h"
#include "halfedge_frame.h"
#include "path_strip.h"
#include "planar_cross.h"
#include "supple/surface/geodesic_derivatives.h"

namespace supple::surface {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Of two ways past a vertex on which a path is straight, the left one is taken unless the right one is closer to
/// straight by this, in radians: paths along edges then pass all their vertices on one side.
constexpr double kSideTolerance = 1e-6;

/// A part of a path between ends and bends, with the edges that it crosses.
struct Stretch {
  struct Crossing {
    std::int32_t over;  ///< halfedge of the face before
    double t;           ///< barycentric coordinate of its head
  };
  std::size_t first, last;  ///< points of the path
  std::int32_t entered;     ///< a halfedge of the first face
  std::vector<Crossing> crossings;

  std::int32_t face_before(const TriangleMesh& mesh, std::size_t crossing) const {
    return TriangleMesh::face_of(crossing == 0 ? entered : mesh.twin(crossings[crossing - 1].over));
  }
};

/// The corner halfedges at `vertex` of the faces that hold both it and the point, counterclockwise: two where the point
/// lies on an edge of the vertex.
std::vector<std::int32_t> corners_towards(const TriangleMesh& mesh, const SurfacePoint& vertex,
                                          const SurfacePoint& point) {
  std::vector<std::int32_t> found;
  const std::vector<std::int32_t> faces = faces_around(mesh, point);
  for (const std::int32_t corner : faces_around(mesh, vertex)) {
    if (std::any_of(faces.begin(), faces.end(),
                    [&](std::int32_t h) { return TriangleMesh::face_of(h) == TriangleMesh::face_of(corner); })) {
      found.push_back(corner);
    }
  }
  if (found.size() > 1 && mesh.rotate(found.front()) != found.back()) std::swap(found.front(), found.back());
  return found;
}

/// The angle at tail(corner) from the halfedge `corner` to the point.
double angle_in_corner(const TriangleMesh& mesh, std::int32_t corner, const Vector3d& point) {
  const Eigen::Matrix<double, 3, 2> frame = halfedge_frame(mesh, corner);
  const Vector2d d = frame.transpose() * (point - mesh.positions()[mesh.tail(corner)]);
  return std::atan2(d.y(), d.x());
}

/// The way past a vertex through its faces, from the corner where the path comes to the one where it leaves.
struct WayPast {
  std::int32_t from = -1, to = -1;
  std::vector<std::int32_t> over;  ///< edges of the vertex, as halfedges of the face before
  double angle = std::numeric_limits<double>::infinity();
};

/// On the left of the path the faces are passed clockwise.
WayPast way_past(const TriangleMesh& mesh, const PathPoint& before, const PathPoint& at, const PathPoint& after,
                 bool left) {
  WayPast way;
  const std::vector<std::int32_t> in = corners_towards(mesh, at.point, before.point);
  const std::vector<std::int32_t> out = corners_towards(mesh, at.point, after.point);
  if (in.empty() || out.empty()) return way;
  way.from = left ? in.front() : in.back();
  way.to = left ? out.back() : out.front();
  const double in_angle = angle_in_corner(mesh, way.from, before.position);
  const double out_angle = angle_in_corner(mesh, way.to, after.position);
  double angle = left ? in_angle - out_angle : out_angle - in_angle;
  std::int32_t corner = way.from;
  do {
    const std::int32_t edge = left ? corner : TriangleMesh::previous(corner);
    if (mesh.twin(edge) < 0) return way;
    way.over.push_back(edge);
    if (!left) angle += mesh.corner_angle(corner);
    corner = left ? TriangleMesh::next(mesh.twin(edge)) : mesh.twin(edge);
    if (left) angle += mesh.corner_angle(corner);
  } while (corner != way.to && corner != way.from);
  if (corner == way.to) way.angle = angle;
  return way;
}

std::vector<Stretch> stretches_of(const TriangleMesh& mesh, const std::vector<PathPoint>& path) {
  std::vector<Stretch> stretches;
  std::int32_t face = -1;  // a halfedge of the one that the path runs through
  const auto begin = [&](std::size_t k) {
    face = common_face(mesh, path[k].point, path[k + 1].point);
    if (face < 0) face = 3 * index(path[k].point.face);
    stretches.push_back({k, k, face, {}});
  };
  begin(0);
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    Stretch& stretch = stretches.back();
    if (crosses_edge(path[k])) {
      const int side = side_of(path[k].point);
      std::int32_t over = 3 * index(path[k].point.face) + side;
      double t = path[k].point.barycentric[(side + 1) % 3];
      if (TriangleMesh::face_of(over) != TriangleMesh::face_of(face)) {
        over = mesh.twin(over);
        t = 1 - t;
      }
      stretch.crossings.push_back({over, t});
      face = mesh.twin(over);
      continue;
    }
    const std::int32_t v = index(path[k].vertex);
    if (v >= 0 && !bends_paths(mesh, v)) {
      const WayPast left = way_past(mesh, path[k - 1], path[k], path[k + 1], true);
      const WayPast right = way_past(mesh, path[k - 1], path[k], path[k + 1], false);
      const double off_left = std::abs(left.angle - std::numbers::pi);
      const double off_right = std::abs(right.angle - std::numbers::pi);
      const WayPast& way = off_right < off_left - kSideTolerance ? right : left;
      if (way.angle < std::numeric_limits<double>::infinity()) {
        if (stretch.crossings.empty()) stretch.entered = way.from;
        for (const std::int32_t over : way.over) stretch.crossings.push_back({over, mesh.head(over) == v ? 1.0 : 0.0});
        face = way.to;
        continue;
      }
    }
    stretch.last = k;
    begin(k);
  }
  stretches.back().last = path.size() - 1;
  return stretches;
}

/// A point of the path to first order in the variables, seen from the face of one of its segments.
struct Motion {
  std::array<std::int32_t, 3> vertices{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};  ///< the point moves by the vertices' motions times these
  int end = -1;                            ///< 0 or 1 for an end of the path
  Matrix3d spokes = Matrix3d::Zero();      ///< its motions with its barycentric coordinates, in columns
};

/// How far a corner of an end's face, unfolded about `pivot` into a neighbouring face, moves along a vector of that
/// face: a linear form of the motions of vertices.
struct CornerMotion {
  std::vector<std::pair<std::int32_t, Vector3d>> terms;
};

class HostLength {
 public:
  HostLength(const TriangleMesh& mesh, const std::vector<PathPoint>& path, int order)
      : mesh_(mesh), path_(path), order_(order), stretches_(stretches_of(mesh, path)) {
    number_vertices();
    result_.gradient = VectorXd::Zero(size());
    if (order > 1) result_.hessian = Eigen::MatrixXd::Zero(size(), size());
  }

  HostDerivatives derivatives() {
    for (const Stretch& stretch : stretches_) add(stretch);
    if (order_ > 1) {
      result_.hessian.triangularView<Eigen::StrictlyUpper>() = result_.hessian.transpose();
    }
    return std::move(result_);
  }

 private:
  Eigen::Index size() const { return 6 + 3 * static_cast<Eigen::Index>(result_.vertices.size()); }
  Eigen::Index column(std::int32_t vertex) const {
    const auto at = std::lower_bound(result_.vertices.begin(), result_.vertices.end(), vertex);
    return 6 + 3 * (at - result_.vertices.begin());
  }
  const Vector3d& position_of(std::int32_t vertex) const { return mesh_.positions()[vertex]; }

  void number_vertices() {
    std::vector<std::int32_t>& vertices = result_.vertices;
    const auto add_face = [&](std::int32_t face) {
      const Triangle& corners = mesh_.faces()[face];
      vertices.insert(vertices.end(), corners.begin(), corners.end());
    };
    for (const Stretch& stretch : stretches_) {
      for (std::size_t i = 0; i <= stretch.crossings.size(); ++i) add_face(stretch.face_before(mesh_, i));
    }
    const std::size_t last = stretches_.back().crossings.size();
    for (const std::int32_t face : faces_between(path_.front().point, stretches_.front().face_before(mesh_, 0))) {
      add_face(face);
    }
    for (const std::int32_t face : faces_between(path_.back().point, stretches_.back().face_before(mesh_, last))) {
      add_face(face);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }

  /// The corner halfedges of the fan about a vertex of an end's face, from `face`, which is not of it, to its own face:
  /// empty if `face` is its own.
  std::vector<std::int32_t> fan_between(const SurfacePoint& end, std::int32_t face, bool& counterclockwise) const {
    if (index(end.face) == face) return {};
    const int corner = corner_of(end);
    const int side = side_of(end);
    if (corner < 0 && side < 0) return {};
    const std::int32_t base = 3 * index(end.face) + (corner >= 0 ? corner : side);
    if (corner < 0) {
      counterclockwise = true;
      return {TriangleMesh::next(mesh_.twin(base)), base};
    }
    std::vector<std::int32_t> fan;
    double angle = 0;
    std::int32_t h = base;
    do {  // counterclockwise from the end's own face
      fan.push_back(h);
      if (TriangleMesh::face_of(h) == face) break;
      angle += mesh_.corner_angle(h);
      h = mesh_.rotate(h);
    } while (h >= 0 && h != base);
    const bool found = TriangleMesh::face_of(fan.back()) == face;
    const std::int32_t v = mesh_.tail(base);
    counterclockwise = !found || (!mesh_.is_boundary(v) && angle > 0.5 * mesh_.vertex_angle(v));
    if (counterclockwise) {
      fan.clear();
      h = base;
      do {
        fan.push_back(h);
        if (TriangleMesh::face_of(h) == face) break;
        h = mesh_.twin(h) >= 0 ? TriangleMesh::next(mesh_.twin(h)) : -1;
      } while (h >= 0 && h != base);
      if (TriangleMesh::face_of(fan.back()) != face) return {};
    }
    std::reverse(fan.begin(), fan.end());
    return fan;
  }

  std::vector<std::int32_t> faces_between(const SurfacePoint& end, std::int32_t face) const {
    bool counterclockwise = false;
    std::vector<std::int32_t> faces{index(end.face)};
    for (const std::int32_t h : fan_between(end, face, counterclockwise)) faces.push_back(TriangleMesh::face_of(h));
    return faces;
  }

  Vector3d normal_of(std::int32_t h) const {
    const Eigen::Matrix<double, 3, 2> frame = halfedge_frame(mesh_, h);
    return Vector3d(frame.col(0)).cross(Vector3d(frame.col(1)));
  }

  /// The first end or the second, seen from `face`; with what its gradient `force` makes of the second derivatives of
  /// its position, which mix barycentric coordinates and vertices.
  Motion end_motion(int which, std::int32_t face, const Vector3d& force) {
    const SurfacePoint& end = which == 0 ? path_.front().point : path_.back().point;
    const Vector3d& center = which == 0 ? path_.front().position : path_.back().position;
    const Triangle& corners = mesh_.faces()[index(end.face)];
    Motion motion;
    motion.end = which;
    std::array<CornerMotion, 3> corner_motions;
    for (int i = 0; i < 3; ++i) {
      motion.vertices[i] = corners[i];
      motion.weights[i] = end.barycentric[i];
      motion.spokes.col(i) = position_of(corners[i]) - center;
      corner_motions[i].terms = {{corners[i], force}};
    }
    bool counterclockwise = false;
    const std::vector<std::int32_t> fan = fan_between(end, face, counterclockwise);
    if (!fan.empty()) unfold_corners(fan, counterclockwise, center, force, motion, corner_motions);
    if (order_ < 2) return motion;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Index row = 3 * which + i;
      for (const auto& [vertex, along] : corner_motions[i].terms) {
        result_.hessian.block<3, 1>(column(vertex), row) += along;
      }
      for (int j = 0; j < 3; ++j) {
        result_.hessian.block<3, 1>(column(corners[j]), row) -= end.barycentric[j] * force;
      }
    }
    return motion;
  }

  /// Turns the corners of an end's face into the first face of the fan, about the vertex in its middle.
  void unfold_corners(const std::vector<std::int32_t>& fan, bool counterclockwise, const Vector3d& center,
                      const Vector3d& force, Motion& motion, std::array<CornerMotion, 3>& corner_motions) const {
    const std::int32_t pivot = mesh_.tail(fan.front());
    const Vector3d& at = position_of(pivot);
    const Vector3d normal = normal_of(fan.front());
    const auto near_of = [&](std::int32_t h) {
      return counterclockwise ? mesh_.head(h) : mesh_.tail(TriangleMesh::previous(h));
    };
    const auto far_of = [&](std::int32_t h) {
      return counterclockwise ? mesh_.tail(TriangleMesh::previous(h)) : mesh_.head(h);
    };
    // How an edge of the vertex turns within the plane of a face: the linear form of its far end's motion.
    std::vector<std::pair<std::int32_t, Vector3d>> turn;
    const auto add_turn = [&](double sign, std::int32_t h, std::int32_t vertex) {
      const Vector3d edge = position_of(vertex) - at;
      const Vector3d form = sign * normal_of(h).cross(edge) / edge.squaredNorm();
      turn.emplace_back(vertex, form);
      turn.emplace_back(pivot, -form);
    };
    const Vector3d axis = (position_of(far_of(fan.front())) - at).normalized();
    const Vector3d across = normal.cross(axis);
    add_turn(1, fan.front(), far_of(fan.front()));
    double angle = 0;
    const auto unfold = [&](std::int32_t vertex) {
      const auto i = std::find(motion.vertices.begin(), motion.vertices.end(), vertex) - motion.vertices.begin();
      const Vector3d edge = position_of(vertex) - at;
      const double length = edge.norm();
      const Vector3d along = std::cos(angle) * axis + std::sin(angle) * across;
      motion.spokes.col(i) = at + length * along - center;
      const Vector3d stretch = force.dot(along) / length * edge;
      auto& terms = corner_motions[i].terms;
      terms = {{pivot, force - stretch}, {vertex, stretch}};
      for (const auto& [other, form] : turn) terms.emplace_back(other, length * force.dot(normal.cross(along)) * form);
    };
    for (std::size_t k = 1; k < fan.size(); ++k) {
      const std::int32_t h = fan[k];
      const bool own = k + 1 == fan.size();
      if (own) unfold(near_of(h));
      add_turn(-1, h, near_of(h));
      add_turn(1, h, far_of(h));
      angle += (counterclockwise ? 1 : -1) * mesh_.corner_angle(h);
      if (own) unfold(far_of(h));
    }
  }

  Motion crossing_motion(const Stretch::Crossing& crossing) const {
    Motion motion;
    motion.vertices = {mesh_.tail(crossing.over), mesh_.head(crossing.over), -1};
    motion.weights = {1 - crossing.t, crossing.t, 0};
    return motion;
  }

  Motion bend_motion(std::size_t point) const {
    Motion motion;
    motion.vertices[0] = index(path_[point].vertex);
    motion.weights[0] = 1;
    return motion;
  }

  /// form += the motion along a vector
  template <typename Form>
  void add_along(const Vector3d& vector, const Motion& motion, Form& form) const {
    for (int i = 0; i < 3; ++i) {
      if (motion.weights[i] != 0) form.template segment<3>(column(motion.vertices[i])) += motion.weights[i] * vector;
    }
    if (motion.end >= 0) form.template segment<3>(3 * motion.end) += motion.spokes.transpose() * vector;
  }

  void add(const Stretch& stretch) {
    // The stretch in one plane: places, arc lengths, and the frames that turn its direction back into each face.
    const std::size_t crossings = stretch.crossings.size();
    UnrolledStrip strip(mesh_, stretch.entered);
    std::vector<Eigen::Matrix<double, 2, 3>> into_plane{strip.into_plane()};
    const Vector2d begin = strip.place(path_[stretch.first].position);
    std::vector<Vector2d> places;
    for (const auto& [over, t] : stretch.crossings) {
      const UnrolledStrip::Edge edge = strip.cross(over);
      places.push_back(t <= 0.5 ? Vector2d(edge.tail + t * (edge.head - edge.tail))
                                : Vector2d(edge.head - (1 - t) * (edge.head - edge.tail)));
      into_plane.push_back(strip.into_plane());
    }
    const Vector2d way = strip.place(path_[stretch.last].position) - begin;
    const double length = way.norm();
    result_.length += length;
    if (length == 0) return;
    const Vector2d direction = way / length;
    const Vector2d across(-direction.y(), direction.x());

    const auto along = [&](std::size_t segment) -> Vector3d { return into_plane[segment].transpose() * direction; };
    const std::int32_t first_face = stretch.face_before(mesh_, 0);
    const std::int32_t last_face = stretch.face_before(mesh_, crossings);
    std::vector<Motion> motions;
    motions.push_back(stretch.first == 0 ? end_motion(0, first_face, -along(0)) : bend_motion(stretch.first));
    for (const Stretch::Crossing& crossing : stretch.crossings) motions.push_back(crossing_motion(crossing));
    motions.push_back(stretch.last + 1 == path_.size() ? end_motion(1, last_face, along(crossings))
                                                       : bend_motion(stretch.last));

    // By the conditions of a shortest path, crossings count as if they kept their t (eq. A.5).
    for (std::size_t k = 0; k < motions.size(); ++k) {
      Vector3d force = Vector3d::Zero();
      if (k > 0) force += along(k - 1);
      if (k + 1 < motions.size()) force -= along(k);
      add_along(force, motions[k], result_.gradient);
    }
    if (order_ < 2) return;

    std::vector<double> arc(crossings + 2, 0);
    for (std::size_t k = 0; k < crossings; ++k) {
      arc[k + 1] = std::clamp(direction.dot(places[k] - begin), arc[k], length);
    }
    arc[crossings + 1] = length;

    // Segments turn out of the faces' planes with the vertices alone: an edge moves in both of its faces.
    for (std::size_t i = 0; i <= crossings; ++i) {
      if (arc[i + 1] > arc[i]) add_out_of_plane(into_plane[i], motions[i], motions[i + 1], arc[i + 1] - arc[i]);
    }

    // Within the unrolled faces, with y the motions of crossings across the path, a the parts of the vertices in the
    // relative motions across of each segment's ends, and f the forces on y that moving edges cause (d2x/dt dv), the
    // second variation is  1/2 sum (a_i + y_i+1 - y_i)^2 / l_i + sum f_k y_k,  least over y:
    //   1/2 (A + F)^2 / L - sum f_k (B_k + 1/2 W_k),  A = sum a_i, B_k = sum_{i < k} a_i, F = sum p_k f_k,
    //   W_k = sum_j min(p_j, p_k) f_j,  with the arc lengths p.
    VectorXd total = VectorXd::Zero(size());
    VectorXd rest = VectorXd::Zero(size());  // of the f beyond
    std::vector<std::array<Eigen::Index, 2>> columns(crossings);
    std::vector<Vector3d> forces(crossings);
    for (std::size_t k = 0; k < crossings; ++k) {
      const std::int32_t over = stretch.crossings[k].over;
      const std::int32_t tail = mesh_.tail(over), head = mesh_.head(over);
      const Vector3d edge = position_of(head) - position_of(tail);
      forces[k] = edge.cross(normal_in(into_plane[k]) - normal_in(into_plane[k + 1])) / edge.squaredNorm();
      columns[k] = {column(tail), column(head)};
      rest.segment<3>(columns[k][0]) -= forces[k];
      rest.segment<3>(columns[k][1]) += forces[k];
      total.segment<3>(columns[k][0]) -= arc[k + 1] * forces[k];
      total.segment<3>(columns[k][1]) += arc[k + 1] * forces[k];
    }
    VectorXd before = VectorXd::Zero(size());  // B_k + W_k / 2
    for (std::size_t i = 0; i <= crossings; ++i) {
      VectorXd motion = VectorXd::Zero(size());
      const Vector3d normal = into_plane[i].transpose() * across;
      add_along(normal, motions[i + 1], motion);
      add_along(-normal, motions[i], motion);
      total += motion;
      if (i == crossings) break;
      before += motion + 0.5 * (arc[i + 1] - arc[i]) * rest;
      rest.segment<3>(columns[i][0]) += forces[i];
      rest.segment<3>(columns[i][1]) -= forces[i];
      for (int c = 0; c < 2; ++c) {
        const Vector3d f = c == 0 ? Vector3d(-forces[i]) : forces[i];
        add_symmetric(columns[i][c], f, before);
      }
    }
    result_.hessian.selfadjointView<Eigen::Lower>().rankUpdate(total, 1 / length);
  }

  static Vector3d normal_in(const Eigen::Matrix<double, 2, 3>& into_plane) {
    return Vector3d(into_plane.row(0)).cross(Vector3d(into_plane.row(1)));
  }

  /// Subtracts f form^T + form f^T, where f is nonzero in three rows, from the lower triangle.
  void add_symmetric(Eigen::Index at, const Vector3d& f, const VectorXd& form) {
    for (int r = 0; r < 3; ++r) {
      const Eigen::Index row = at + r;
      result_.hessian.row(row).head(row + 1) -= f[r] * form.head(row + 1).transpose();
      result_.hessian.col(row).tail(size() - row) -= f[r] * form.tail(size() - row);
    }
  }

  void add_out_of_plane(const Eigen::Matrix<double, 2, 3>& into_plane, const Motion& from, const Motion& to,
                        double length) {
    std::array<std::int32_t, 6> vertices;
    std::array<double, 6> weights{};
    int count = 0;
    const auto gather = [&](const Motion& motion, double sign) {
      for (int i = 0; i < 3; ++i) {
        if (motion.weights[i] == 0) continue;
        const int at = static_cast<int>(std::find(vertices.begin(), vertices.begin() + count, motion.vertices[i]) -
                                        vertices.begin());
        if (at == count) vertices[count++] = motion.vertices[i];
        weights[at] += sign * motion.weights[i];
      }
    };
    gather(to, 1);
    gather(from, -1);
    const Vector3d normal = normal_in(into_plane);
    const Matrix3d stiffness = normal * normal.transpose() / length;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        if (vertices[j] > vertices[i]) continue;
        result_.hessian.block<3, 3>(column(vertices[i]), column(vertices[j])) += weights[i] * weights[j] * stiffness;
      }
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<PathPoint>& path_;
  int order_;
  std::vector<Stretch> stretches_;
  HostDerivatives result_;
};

}  // namespace

HostDerivatives host_derivatives(const TriangleMesh& mesh, const std::vector<PathPoint>& path, int order) {
  if (path.size() < 2) {
    HostDerivatives none;
    none.gradient = VectorXd::Zero(6);
    if (order > 1) none.hessian = Eigen::MatrixXd::Zero(6, 6);
    return none;
  }
  return HostLength(mesh, path, order).derivatives();
}

}  // namespace supple::surface
