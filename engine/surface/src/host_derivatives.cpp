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

/// A path that runs straight through a vertex passes it on the left, unless the angle on the right is closer to pi by
/// this amount (radians). Paths along edges then pass all vertices on one side.
constexpr double side_tolerance = 1e-6;

/// A straight section of a path, between ends of the path or vertices that bend it, with the edges that it crosses.
struct StraightSection {
  struct Crossing {
    std::int32_t over;  ///< halfedge of the face before
    double t;           ///< barycentric coordinate of the head of `over`
  };
  std::size_t first, last;  ///< indices of its ends in the path
  std::int32_t entered;     ///< a halfedge of the first face
  std::vector<Crossing> crossings;

  std::int32_t face_before(const TriangleMesh& mesh, std::size_t crossing) const {
    return TriangleMesh::face_of(crossing == 0 ? entered : mesh.twin(crossings[crossing - 1].over));
  }
};

/// The corners at `vertex` of the faces that contain both it and the point, as outgoing halfedges in counterclockwise
/// order. There are two if the point lies on an edge of the vertex.
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

/// The angle at tail(corner) from halfedge `corner` to the point; radians.
double angle_in_corner(const TriangleMesh& mesh, std::int32_t corner, const Vector3d& point) {
  const Eigen::Matrix<double, 3, 2> frame = halfedge_frame(mesh, corner);
  const Vector2d d = frame.transpose() * (point - mesh.positions()[mesh.tail(corner)]);
  return std::atan2(d.y(), d.x());
}

/// The faces around a vertex on one side of a path that passes it.
struct VertexBypass {
  std::int32_t from = -1, to = -1;  ///< corners by which the path arrives and leaves
  std::vector<std::int32_t> over;   ///< edges of the vertex in between, as halfedges of the face before
  /// Angle between both parts of the path, in radians; infinity if the boundary lies in between.
  double angle = std::numeric_limits<double>::infinity();
};

/// The faces on the left side of the path are passed clockwise, those on the right side counterclockwise.
VertexBypass bypass_of(const TriangleMesh& mesh, const PathPoint& before, const PathPoint& at, const PathPoint& after,
                       bool left) {
  VertexBypass bypass;
  const std::vector<std::int32_t> in = corners_towards(mesh, at.point, before.point);
  const std::vector<std::int32_t> out = corners_towards(mesh, at.point, after.point);
  if (in.empty() || out.empty()) return bypass;
  bypass.from = left ? in.front() : in.back();
  bypass.to = left ? out.back() : out.front();
  const double in_angle = angle_in_corner(mesh, bypass.from, before.position);
  const double out_angle = angle_in_corner(mesh, bypass.to, after.position);
  double angle = left ? in_angle - out_angle : out_angle - in_angle;
  std::int32_t corner = bypass.from;
  do {
    const std::int32_t edge = left ? corner : TriangleMesh::previous(corner);
    if (mesh.twin(edge) < 0) return bypass;
    bypass.over.push_back(edge);
    if (!left) angle += mesh.corner_angle(corner);
    corner = left ? TriangleMesh::next(mesh.twin(edge)) : mesh.twin(edge);
    if (left) angle += mesh.corner_angle(corner);
  } while (corner != bypass.to && corner != bypass.from);
  if (corner == bypass.to) bypass.angle = angle;
  return bypass;
}

std::vector<StraightSection> sections_of(const TriangleMesh& mesh, const std::vector<PathPoint>& path) {
  std::vector<StraightSection> sections;
  std::int32_t face = -1;  // a halfedge of the face through which the path runs
  const auto begin = [&](std::size_t k) {
    face = common_face(mesh, path[k].point, path[k + 1].point);
    if (face < 0) face = 3 * index(path[k].point.face);
    sections.push_back({k, k, face, {}});
  };
  begin(0);
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    StraightSection& section = sections.back();
    if (crosses_edge(path[k])) {
      const int side = side_of(path[k].point);
      std::int32_t over = 3 * index(path[k].point.face) + side;
      double t = path[k].point.barycentric[(side + 1) % 3];
      if (TriangleMesh::face_of(over) != TriangleMesh::face_of(face)) {
        over = mesh.twin(over);
        t = 1 - t;
      }
      section.crossings.push_back({over, t});
      face = mesh.twin(over);
      continue;
    }
    const std::int32_t v = index(path[k].vertex);
    if (v >= 0 && !bends_paths(mesh, v)) {
      const VertexBypass left = bypass_of(mesh, path[k - 1], path[k], path[k + 1], true);
      const VertexBypass right = bypass_of(mesh, path[k - 1], path[k], path[k + 1], false);
      const double off_left = std::abs(left.angle - std::numbers::pi);
      const double off_right = std::abs(right.angle - std::numbers::pi);
      const VertexBypass& bypass = off_right < off_left - side_tolerance ? right : left;
      if (bypass.angle < std::numeric_limits<double>::infinity()) {
        if (section.crossings.empty()) section.entered = bypass.from;
        for (const std::int32_t over : bypass.over)
          section.crossings.push_back({over, mesh.head(over) == v ? 1.0 : 0.0});
        face = bypass.to;
        continue;
      }
    }
    section.last = k;
    begin(k);
  }
  sections.back().last = path.size() - 1;
  return sections;
}

/// The motion of a point of the path to first order in the variables, in the unfolded face of one of its segments.
struct Motion {
  std::array<std::int32_t, 3> vertices{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};  ///< the point's motion is the sum of the vertices' motions times these
  int end = -1;                            ///< 0 or 1 for an end of the path, -1 for other points
  Matrix3d barycentric_jacobian = Matrix3d::Zero();  ///< derivatives by the end's barycentric coordinates, in columns
};

/// The component along a vector of the motion of a corner of an end's face, which is unfolded about a vertex into
/// another face. It is a linear form in the motions of vertices: a sum of dot products.
struct CornerMotion {
  std::vector<std::pair<std::int32_t, Vector3d>> terms;
};

class HostLength {
 public:
  HostLength(const TriangleMesh& mesh, const std::vector<PathPoint>& path, int order)
      : mesh_(mesh), path_(path), order_(order), sections_(sections_of(mesh, path)) {
    number_vertices();
    result_.gradient = VectorXd::Zero(size());
    if (order < 2) return;
    result_.hessian = Eigen::MatrixXd::Zero(size(), size());
    mixed_ = Eigen::MatrixXd::Zero(size(), size());
  }

  HostDerivatives derivatives() {
    for (const StraightSection& section : sections_) add(section);
    if (order_ > 1) complete_hessian();
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
    for (const StraightSection& section : sections_) {
      for (std::size_t i = 0; i <= section.crossings.size(); ++i) add_face(section.face_before(mesh_, i));
    }
    const std::size_t last = sections_.back().crossings.size();
    for (const std::int32_t face : faces_between(path_.front().point, sections_.front().face_before(mesh_, 0))) {
      add_face(face);
    }
    for (const std::int32_t face : faces_between(path_.back().point, sections_.back().face_before(mesh_, last))) {
      add_face(face);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }

  /// The corners around a vertex of an end's face from `face` to the end's own face, as outgoing halfedges; empty if
  /// `face` is its own. `counterclockwise` receives their direction.
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

  /// The motion of the first or the second end (0 or 1) in the unfolded `face`. The second derivatives of its position
  /// mix barycentric coordinates and vertices. Times `force`, the gradient by the position, they are added to the
  /// Hessian.
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
      motion.barycentric_jacobian.col(i) = position_of(corners[i]) - center;
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

  /// Rotates the corners of an end's face into the first face of the fan, about the vertex in its middle.
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
    // The change of the angle of rotation, as a linear form in the motions of vertices. Its parts are rotations of
    // edges within the planes of faces.
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
      motion.barycentric_jacobian.col(i) = at + length * along - center;
      const Vector3d stretching = force.dot(along) / length * edge;
      auto& terms = corner_motions[i].terms;
      terms = {{pivot, force - stretching}, {vertex, stretching}};
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

  Motion crossing_motion(const StraightSection::Crossing& crossing) const {
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

  /// Adds the component of a motion along a vector to a linear form.
  template <typename Form>
  void add_along(const Vector3d& vector, const Motion& motion, Form& form) const {
    for (int i = 0; i < 3; ++i) {
      if (motion.weights[i] != 0) form.template segment<3>(column(motion.vertices[i])) += motion.weights[i] * vector;
    }
    if (motion.end >= 0) form.template segment<3>(3 * motion.end) += motion.barycentric_jacobian.transpose() * vector;
  }

  void add(const StraightSection& section) {
    // The section is unfolded into one plane, by `into_plane` for each face.
    const std::size_t crossings = section.crossings.size();
    UnfoldedStrip strip(mesh_, section.entered);
    std::vector<Eigen::Matrix<double, 2, 3>> into_plane{strip.into_plane()};
    const Vector2d begin = strip.in_plane(path_[section.first].position);
    std::vector<Vector2d> crossing_points;
    for (const auto& [over, t] : section.crossings) {
      const UnfoldedStrip::Edge edge = strip.unfold_across(over);
      crossing_points.push_back(t <= 0.5 ? Vector2d(edge.tail + t * (edge.head - edge.tail))
                                         : Vector2d(edge.head - (1 - t) * (edge.head - edge.tail)));
      into_plane.push_back(strip.into_plane());
    }
    const Vector2d displacement = strip.in_plane(path_[section.last].position) - begin;
    const double length = displacement.norm();
    result_.length += length;
    if (length == 0) return;
    const Vector2d direction = displacement / length;
    const Vector2d across(-direction.y(), direction.x());

    const auto along = [&](std::size_t segment) -> Vector3d { return into_plane[segment].transpose() * direction; };
    const std::int32_t first_face = section.face_before(mesh_, 0);
    const std::int32_t last_face = section.face_before(mesh_, crossings);
    std::vector<Motion> motions;
    motions.push_back(section.first == 0 ? end_motion(0, first_face, -along(0)) : bend_motion(section.first));
    for (const StraightSection::Crossing& crossing : section.crossings) motions.push_back(crossing_motion(crossing));
    motions.push_back(section.last + 1 == path_.size() ? end_motion(1, last_face, along(crossings))
                                                       : bend_motion(section.last));

    // The length is stationary in the crossings' parameters t, which therefore count as constant [Thesis, eq. A.5].
    for (std::size_t k = 0; k < motions.size(); ++k) {
      Vector3d force = Vector3d::Zero();
      if (k > 0) force += along(k - 1);
      if (k + 1 < motions.size()) force -= along(k);
      add_along(force, motions[k], result_.gradient);
    }
    if (order_ < 2) return;

    std::vector<double> arc(crossings + 2, 0);
    for (std::size_t k = 0; k < crossings; ++k) {
      arc[k + 1] = std::clamp(direction.dot(crossing_points[k] - begin), arc[k], length);
    }
    arc[crossings + 1] = length;

    // Segments rotate out of the faces' planes with the vertices alone: a crossing that moves along its edge stays in
    // the planes of both faces.
    for (std::size_t i = 0; i <= crossings; ++i) {
      if (arc[i + 1] > arc[i]) add_out_of_plane(into_plane[i], motions[i], motions[i + 1], arc[i + 1] - arc[i]);
    }

    // Within the unfolded faces, the second variation of the length is
    //   1/2 sum (a_i + y_{i+1} - y_i)^2 / l_i + sum f_k y_k.
    // y_k is the motion of crossing k across the path due to its t. a_i is the relative motion across the path of the
    // ends of segment i due to the variables, l_i its length. f_k is the force on y_k due to the motion of the edge
    // (d2x/dt dv). The minimum over y is
    //   1/2 (A + F)^2 / L - sum f_k (B_k + 1/2 W_k),
    // with A = sum a_i, B_k = sum_{i < k} a_i, F = sum p_k f_k, W_k = sum_j min(p_j, p_k) f_j, and the arc lengths p_k.
    VectorXd total = VectorXd::Zero(size());             // A + F
    VectorXd following_forces = VectorXd::Zero(size());  // sum of the f_k of the crossings that follow
    std::vector<std::array<Eigen::Index, 2>> columns(crossings);
    std::vector<Vector3d> forces(crossings);
    for (std::size_t k = 0; k < crossings; ++k) {
      const std::int32_t over = section.crossings[k].over;
      const std::int32_t tail = mesh_.tail(over), head = mesh_.head(over);
      const Vector3d edge = position_of(head) - position_of(tail);
      forces[k] = edge.cross(normal_in(into_plane[k]) - normal_in(into_plane[k + 1])) / edge.squaredNorm();
      columns[k] = {column(tail), column(head)};
      following_forces.segment<3>(columns[k][0]) -= forces[k];
      following_forces.segment<3>(columns[k][1]) += forces[k];
      total.segment<3>(columns[k][0]) -= arc[k + 1] * forces[k];
      total.segment<3>(columns[k][1]) += arc[k + 1] * forces[k];
    }
    VectorXd b_plus_half_w = VectorXd::Zero(size());  // B_k + W_k / 2
    for (std::size_t i = 0; i <= crossings; ++i) {
      VectorXd motion = VectorXd::Zero(size());
      const Vector3d normal = into_plane[i].transpose() * across;
      add_along(normal, motions[i + 1], motion);
      add_along(-normal, motions[i], motion);
      total += motion;
      if (i == crossings) break;
      b_plus_half_w += motion + 0.5 * (arc[i + 1] - arc[i]) * following_forces;
      following_forces.segment<3>(columns[i][0]) += forces[i];
      following_forces.segment<3>(columns[i][1]) -= forces[i];
      for (int axis = 0; axis < 3; ++axis) {
        mixed_.col(columns[i][0] + axis) -= forces[i][axis] * b_plus_half_w;
        mixed_.col(columns[i][1] + axis) += forces[i][axis] * b_plus_half_w;
      }
    }
    // The sections of a path with many bends are short, and each of them depends on few of the variables.
    std::vector<Eigen::Index> nonzero;
    for (Eigen::Index i = 0; i < size(); ++i) {
      if (total[i] != 0) nonzero.push_back(i);
    }
    for (auto column = nonzero.begin(); column != nonzero.end(); ++column) {
      const double factor = total[*column] / length;
      for (auto row = column; row != nonzero.end(); ++row) result_.hessian(*row, *column) += factor * total[*row];
    }
  }

  static Vector3d normal_in(const Eigen::Matrix<double, 2, 3>& into_plane) {
    return Vector3d(into_plane.row(0)).cross(Vector3d(into_plane.row(1)));
  }

  /// Subtracts mixed_ and its transpose, and fills the upper triangle. It works tile by tile, because rows of a large
  /// matrix lie far apart in memory.
  void complete_hessian() {
    constexpr Eigen::Index tile = 32;
    Eigen::MatrixXd& hessian = result_.hessian;
    for (Eigen::Index c = 0; c < size(); c += tile) {
      const Eigen::Index columns = std::min(tile, size() - c);
      for (Eigen::Index r = c; r < size(); r += tile) {
        const Eigen::Index rows = std::min(tile, size() - r);
        hessian.block(r, c, rows, columns) -=
            mixed_.block(r, c, rows, columns) + mixed_.block(c, r, columns, rows).transpose();
        if (r == c) {
          for (Eigen::Index i = 0; i < columns; ++i) {
            for (Eigen::Index j = 0; j < i; ++j) hessian(c + j, c + i) = hessian(c + i, c + j);
          }
        } else {
          hessian.block(c, r, columns, rows) = hessian.block(r, c, rows, columns).transpose();
        }
      }
    }
  }

  /// Adds the second variation of a segment's length that is due to its rotation out of the plane of its face.
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
  std::vector<StraightSection> sections_;
  HostDerivatives result_;
  Eigen::MatrixXd mixed_;  ///< to be subtracted from the Hessian together with its transpose
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
