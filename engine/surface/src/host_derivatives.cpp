#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "end_motion.h"
#include "path_sections.h"
#include "path_strip.h"
#include "supple/surface/geodesic_derivatives.h"

namespace supple::surface {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// The length of a path and its derivatives by the ends' barycentric coordinates and the vertices of the faces crossed.
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
    for (const PathSection& section : sections_) add(section);
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
    for (const PathSection& section : sections_) {
      for (std::size_t i = 0; i <= section.crossings.size(); ++i) add_face(section.face_before(mesh_, i));
    }
    const std::size_t last = sections_.back().crossings.size();
    for (const std::int32_t face : faces_between(mesh_, path_.front().point, sections_.front().face_before(mesh_, 0))) {
      add_face(face);
    }
    for (const std::int32_t face :
         faces_between(mesh_, path_.back().point, sections_.back().face_before(mesh_, last))) {
      add_face(face);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }

  Motion crossing_motion(const PathSection::Crossing& crossing) const {
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

  /// A straight section in the plane of its unfolded faces.
  struct UnfoldedSection {
    std::vector<Eigen::Matrix<double, 2, 3>> into_plane;  ///< for each face
    Vector2d begin = Vector2d::Zero();
    std::vector<Vector2d> crossings;  ///< the points at which the section crosses edges
    Vector2d direction = Vector2d::Zero();
    double length = 0;

    /// The direction of the section in space, in one of its faces.
    Vector3d along(std::size_t segment) const { return into_plane[segment].transpose() * direction; }
    Vector3d across(std::size_t segment) const {
      return into_plane[segment].transpose() * Vector2d(-direction.y(), direction.x());
    }
  };

  UnfoldedSection unfolded(const PathSection& section) const {
    UnfoldedSection result;
    UnfoldedStrip strip(mesh_, section.entered);
    result.into_plane = {strip.into_plane()};
    result.begin = strip.in_plane(path_[section.first].position);
    for (const auto& [over, t] : section.crossings) {
      const UnfoldedStrip::Edge edge = strip.unfold_across(over);
      result.crossings.push_back(t <= 0.5 ? Vector2d(edge.tail + t * (edge.head - edge.tail))
                                          : Vector2d(edge.head - (1 - t) * (edge.head - edge.tail)));
      result.into_plane.push_back(strip.into_plane());
    }
    const Vector2d displacement = strip.in_plane(path_[section.last].position) - result.begin;
    result.length = displacement.norm();
    if (result.length > 0) result.direction = displacement / result.length;
    return result;
  }

  /// The motions of the section's ends and crossings, in order.
  std::vector<Motion> motions_of(const PathSection& section, const UnfoldedSection& plane) {
    const std::size_t crossings = section.crossings.size();
    std::vector<Motion> motions;
    motions.push_back(section.first == 0 ? motion_of_end(0, section.face_before(mesh_, 0), -plane.along(0))
                                         : bend_motion(section.first));
    for (const PathSection::Crossing& crossing : section.crossings) motions.push_back(crossing_motion(crossing));
    motions.push_back(section.last + 1 == path_.size()
                          ? motion_of_end(1, section.face_before(mesh_, crossings), plane.along(crossings))
                          : bend_motion(section.last));
    return motions;
  }

  /// The motion of an end. The second derivatives of its position mix barycentric coordinates and vertices. Times
  /// `force`, the gradient by the position, they are added to the Hessian.
  Motion motion_of_end(int which, std::int32_t face, const Vector3d& force) {
    const PathPoint& end = which == 0 ? path_.front() : path_.back();
    const EndMotion result = end_motion(mesh_, end, which, face, force);
    if (order_ < 2) return result.motion;
    const Triangle& corners = mesh_.faces()[index(end.point.face)];
    for (int i = 0; i < 3; ++i) {
      const Eigen::Index row = 3 * which + i;
      for (const auto& [vertex, along] : result.corners[i].terms) {
        result_.hessian.block<3, 1>(column(vertex), row) += along;
      }
      for (int j = 0; j < 3; ++j) {
        result_.hessian.block<3, 1>(column(corners[j]), row) -= end.point.barycentric[j] * force;
      }
    }
    return result.motion;
  }

  void add(const PathSection& section) {
    const UnfoldedSection plane = unfolded(section);
    result_.length += plane.length;
    if (plane.length == 0) return;
    const std::vector<Motion> motions = motions_of(section, plane);
    // The length is stationary in the crossings' parameters t, which therefore count as constant [Thesis, eq. A.5].
    for (std::size_t k = 0; k < motions.size(); ++k) {
      Vector3d force = Vector3d::Zero();
      if (k > 0) force += plane.along(k - 1);
      if (k + 1 < motions.size()) force -= plane.along(k);
      add_along(force, motions[k], result_.gradient);
    }
    if (order_ < 2) return;
    const std::size_t crossings = section.crossings.size();
    std::vector<double> arc(crossings + 2, 0);
    for (std::size_t k = 0; k < crossings; ++k) {
      arc[k + 1] = std::clamp(plane.direction.dot(plane.crossings[k] - plane.begin), arc[k], plane.length);
    }
    arc[crossings + 1] = plane.length;
    // Segments rotate out of the faces' planes with the vertices alone: a crossing that moves along its edge stays in
    // the planes of both faces.
    for (std::size_t i = 0; i <= crossings; ++i) {
      if (arc[i + 1] > arc[i]) add_out_of_plane(plane.into_plane[i], motions[i], motions[i + 1], arc[i + 1] - arc[i]);
    }
    add_within_plane(section, plane, motions, arc);
  }

  /// Adds the second variation of the length within the unfolded faces, which is
  ///   1/2 sum (a_i + y_{i+1} - y_i)^2 / l_i + sum f_k y_k.
  /// y_k is the motion of crossing k across the path due to its t. a_i is the relative motion across the path of the
  /// ends of segment i due to the variables, l_i its length. f_k is the force on y_k due to the motion of the edge
  /// (d2x/dt dv). The minimum over y is
  ///   1/2 (A + F)^2 / L - sum f_k (B_k + 1/2 W_k),
  /// with A = sum a_i, B_k = sum_{i < k} a_i, F = sum p_k f_k, W_k = sum_j min(p_j, p_k) f_j, and the arc lengths p_k.
  /// `arc` are the arc lengths of the section's ends and crossings.
  void add_within_plane(const PathSection& section, const UnfoldedSection& plane, const std::vector<Motion>& motions,
                        const std::vector<double>& arc) {
    const std::size_t crossings = section.crossings.size();
    VectorXd total = VectorXd::Zero(size());             // A + F
    VectorXd following_forces = VectorXd::Zero(size());  // sum of the f_k of the crossings that follow
    std::vector<std::array<Eigen::Index, 2>> columns(crossings);
    std::vector<Vector3d> forces(crossings);
    for (std::size_t k = 0; k < crossings; ++k) {
      const std::int32_t over = section.crossings[k].over;
      const std::int32_t tail = mesh_.tail(over), head = mesh_.head(over);
      const Vector3d edge = position_of(head) - position_of(tail);
      forces[k] = edge.cross(normal_in(plane.into_plane[k]) - normal_in(plane.into_plane[k + 1])) / edge.squaredNorm();
      columns[k] = {column(tail), column(head)};
      following_forces.segment<3>(columns[k][0]) -= forces[k];
      following_forces.segment<3>(columns[k][1]) += forces[k];
      total.segment<3>(columns[k][0]) -= arc[k + 1] * forces[k];
      total.segment<3>(columns[k][1]) += arc[k + 1] * forces[k];
    }
    VectorXd b_plus_half_w = VectorXd::Zero(size());  // B_k + W_k / 2
    for (std::size_t i = 0; i <= crossings; ++i) {
      VectorXd motion = VectorXd::Zero(size());
      const Vector3d normal = plane.across(i);
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
      const double factor = total[*column] / plane.length;
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
  std::vector<PathSection> sections_;
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
