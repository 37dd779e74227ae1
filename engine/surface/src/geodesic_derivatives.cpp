#include "supple/surface/geodesic_derivatives.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "halfedge_frame.h"
#include "path_strip.h"
#include "planar_cross.h"

namespace supple::surface {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Frame = Eigen::Matrix<double, 3, 2>;

/// The tangent frame of the point's face, unfolded into the face of `h`, which is one of faces_around(point).
Frame unfolded_frame(const TriangleMesh& mesh, const SurfacePoint& point, std::int32_t h) {
  Frame frame = tangent_frame(mesh, point.face);
  const std::int32_t face = index(point.face);
  if (TriangleMesh::face_of(h) == face) return frame;
  const int corner = corner_of(point);
  const std::int32_t base = 3 * face + (corner >= 0 ? corner : side_of(point));
  const Vector3d axis = mesh.positions()[mesh.head(base)] - mesh.positions()[mesh.tail(base)];
  const Vector2d d = frame.transpose() * axis;
  double turn = std::atan2(d.y(), d.x());  // angle of the base halfedge in its own face's frame
  Frame other_frame = halfedge_frame(mesh, h);
  if (corner < 0) {
    other_frame = -other_frame;  // the twin has the opposite direction
  } else {
    double fan_angle = 0;
    std::int32_t k = base;
    for (; k >= 0 && k != h; k = mesh.rotate(k)) fan_angle += mesh.corner_angle(k);
    const double total = mesh.vertex_angle(mesh.tail(base));
    if (k < 0) {
      fan_angle = 0;  // the fan ends at a boundary before h, which is found clockwise instead
      for (std::int32_t c = h; c >= 0 && c != base; c = mesh.rotate(c)) fan_angle -= mesh.corner_angle(c);
    } else if (!mesh.is_boundary(mesh.tail(base)) && fan_angle > 0.5 * total) {
      fan_angle -= total;
    }
    turn += fan_angle;
  }
  Matrix2d rotation;
  rotation << std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn);
  return other_frame * rotation;
}

/// A point of the path as a function of its own crossing parameter. Vertices and ends have none.
struct Node {
  Vector3d position;
  Vector3d edge = Vector3d::Zero();
  bool is_crossing = false;
};

Node crossing_node(const TriangleMesh& mesh, const PathPoint& point) {
  Node node{point.position};
  if (!crosses_edge(point)) return node;
  const std::int32_t h = 3 * index(point.point.face) + side_of(point.point);
  node.edge = mesh.positions()[mesh.head(h)] - mesh.positions()[mesh.tail(h)];
  node.is_crossing = true;
  return node;
}

using Jacobian = Eigen::Matrix<double, 2, 4>;  // of a point of the plane with respect to both ends' tangent coordinates
using Row = Eigen::RowVector4d;

/// The derivative of cross(a, b) if only a depends on the ends, or only b.
Row derivative_of_cross(const Jacobian& a, const Vector2d& b) { return a.row(0) * b.y() - a.row(1) * b.x(); }
Row derivative_of_cross(const Vector2d& a, const Jacobian& b) { return a.x() * b.row(1) - a.y() * b.row(0); }

/// A straight section of a path, from one end or vertex to the next, with its faces unfolded into one plane.
struct StraightSection {
  struct Crossing {
    Vector2d tail, head;  ///< ends of the edge
    double t;             ///< barycentric coordinate of its head
  };
  Vector2d begin, end;
  Jacobian begin_jacobian = Jacobian::Zero(), end_jacobian = Jacobian::Zero();
  std::vector<Crossing> crossings;
};

/// The section of the path between its points `first` and `last`, between which there are crossings only.
StraightSection unfolded_section(const TriangleMesh& mesh, const std::vector<PathPoint>& path, std::size_t first,
                                 std::size_t last) {
  StraightSection section;
  const std::int32_t entered = common_face(mesh, path[first].point, path[first + 1].point);
  UnfoldedStrip strip(mesh, entered >= 0 ? entered : 3 * index(path[first].point.face));
  section.begin = strip.in_plane(path[first].position);
  if (first == 0)
    section.begin_jacobian.leftCols<2>() =
        strip.into_plane() * unfolded_frame(mesh, path[first].point, strip.halfedge());
  for (std::size_t k = first + 1; k < last; ++k) {
    const int side = side_of(path[k].point);
    std::int32_t over = 3 * index(path[k].point.face) + side;
    double t = path[k].point.barycentric[(side + 1) % 3];
    if (TriangleMesh::face_of(over) != TriangleMesh::face_of(strip.halfedge())) {
      over = mesh.twin(over);
      t = 1 - t;
    }
    const UnfoldedStrip::Edge edge = strip.unfold_across(over);
    section.crossings.push_back({edge.tail, edge.head, t});
  }
  section.end = strip.in_plane(path[last].position);
  if (last + 1 == path.size()) {
    std::int32_t last_halfedge = common_face(mesh, path[last].point, path[last - 1].point);
    for (const std::int32_t k : faces_around(mesh, path[last].point)) {
      if (TriangleMesh::face_of(k) == TriangleMesh::face_of(strip.halfedge())) last_halfedge = k;
    }
    section.end_jacobian.rightCols<2>() =
        strip.into_plane() * (last_halfedge >= 0 ? unfolded_frame(mesh, path[last].point, last_halfedge)
                                                 : tangent_frame(mesh, path[last].point.face));
  }
  return section;
}

/// A point of the plane as a function of both ends' tangent coordinates, to second order.
struct MovingPoint {
  Vector2d origin, offset;  ///< the point is their sum; the origin of a crossing is the nearer end of its edge
  Jacobian jacobian;
  /// The Hessians of both coordinates.
  std::array<Eigen::Matrix4d, 2> curvature{Eigen::Matrix4d::Zero(), Eigen::Matrix4d::Zero()};
};

/// An end of the path whose barycentric coordinates are mollified, as a function of its tangent coordinates. Vectors
/// are in the frame of its face, relative to the given end.
struct MollifiedEnd {
  Vector2d offset;
  Matrix2d jacobian;
  std::array<Matrix2d, 2> curvature{Matrix2d::Zero(), Matrix2d::Zero()};
};

MollifiedEnd mollified_end(const TriangleMesh& mesh, const SurfacePoint& end, double epsilon) {
  const Triangle& corners = mesh.faces()[index(end.face)];
  const Frame frame = tangent_frame(mesh, end.face);
  const Vector3d center = position(mesh, end);
  Eigen::Matrix<double, 2, 3> corner_offsets;
  for (int i = 0; i < 3; ++i) corner_offsets.col(i) = frame.transpose() * (mesh.positions()[corners[i]] - center);
  // The barycentric coordinate of a corner grows from 0 on the opposite side to 1 at the corner.
  Eigen::Matrix<double, 3, 2> weight_gradients;
  for (int i = 0; i < 3; ++i) {
    const Vector2d side = corner_offsets.col((i + 2) % 3) - corner_offsets.col((i + 1) % 3);
    const Vector2d inward(-side.y(), side.x());
    weight_gradients.row(i) =
        inward.transpose() / inward.dot(Vector2d(corner_offsets.col(i) - corner_offsets.col((i + 1) % 3)));
  }
  std::array<Mollified, 3> m;
  double sum = 0;
  MollifiedEnd result{Vector2d::Zero(), Matrix2d::Zero()};
  for (int i = 0; i < 3; ++i) {
    m[i] = mollify(end.barycentric[i], epsilon);
    sum += m[i].value;
    // The given coordinates have offset 0, so that their differences suffice.
    result.offset += (m[i].value - end.barycentric[i]) * corner_offsets.col(i);
  }
  result.offset /= sum;
  Eigen::RowVector2d sum_gradient = Eigen::RowVector2d::Zero();
  for (int i = 0; i < 3; ++i) {
    sum_gradient += m[i].slope * weight_gradients.row(i);
    result.jacobian += (corner_offsets.col(i) - result.offset) * (m[i].slope / sum) * weight_gradients.row(i);
  }
  for (int axis = 0; axis < 2; ++axis) {
    for (int i = 0; i < 3; ++i) {
      result.curvature[axis] += (corner_offsets(axis, i) - result.offset[axis]) * (m[i].curvature / sum) *
                                weight_gradients.row(i).transpose() * weight_gradients.row(i);
    }
    const Matrix2d mixed = sum_gradient.transpose() * result.jacobian.row(axis) / sum;
    result.curvature[axis] -= mixed + mixed.transpose();
  }
  return result;
}

/// A mollified end of a path in the plane of its section. `rotation` maps the frame of the end's face to that plane.
template <int first_column>
MovingPoint mollified_point(const Vector2d& origin, const Matrix2d& rotation, const MollifiedEnd& end) {
  MovingPoint point{origin, rotation * end.offset, Jacobian::Zero()};
  point.jacobian.template middleCols<2>(first_column) = rotation * end.jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    point.curvature[axis].template block<2, 2>(first_column, first_column) =
        rotation(axis, 0) * end.curvature[0] + rotation(axis, 1) * end.curvature[1];
  }
  return point;
}

/// The mollified crossing of an edge by the straight line of its section. Before mollification its parameter is
/// t = n / w. n is the distance of the edge's tail from the line, w the sum of the distances of tail and head, both
/// times the line's length. They are bilinear in the ends.
MovingPoint mollified_crossing(const StraightSection& section, const StraightSection::Crossing& crossing,
                               double epsilon) {
  const Vector2d edge = crossing.head - crossing.tail;
  const Mollified m = mollify(crossing.t, epsilon);
  const bool near_tail = crossing.t <= 0.5;
  MovingPoint point{near_tail ? crossing.tail : crossing.head,
                    near_tail ? Vector2d(m.value * edge) : Vector2d(-mollify(1 - crossing.t, epsilon).value * edge),
                    Jacobian::Zero()};
  const Vector2d line = section.end - section.begin;
  const Jacobian line_jacobian = section.end_jacobian - section.begin_jacobian;
  const double w = -cross(line, edge);
  if (w == 0) return point;
  const Row w1 = -derivative_of_cross(line_jacobian, edge);
  const Row n1 = derivative_of_cross(line_jacobian, Vector2d(crossing.tail - section.begin)) -
                 derivative_of_cross(line, section.begin_jacobian);
  const Row t1 = (n1 - crossing.t * w1) / w;
  const Eigen::Matrix4d n2 = line_jacobian.row(1).transpose() * section.begin_jacobian.row(0) -
                             line_jacobian.row(0).transpose() * section.begin_jacobian.row(1);
  const Eigen::Matrix4d mixed = t1.transpose() * w1;
  const Eigen::Matrix4d t2 = (n2 + n2.transpose() - mixed - mixed.transpose()) / w;
  point.jacobian = edge * (m.slope * t1);
  const Eigen::Matrix4d along = m.curvature * t1.transpose() * t1 + m.slope * t2;
  point.curvature = {along * edge.x(), along * edge.y()};
  return point;
}

/// Adds the length of a segment and its derivatives to `sum`.
void add_segment(const MovingPoint& from, const MovingPoint& to, PathLength& sum) {
  const Vector2d segment = (to.origin - from.origin) + (to.offset - from.offset);
  const double length = segment.norm();
  if (length == 0) return;
  const Vector2d u = segment / length;
  const Jacobian segment_jacobian = to.jacobian - from.jacobian;
  const Row transverse = derivative_of_cross(u, segment_jacobian);
  sum.length += length;
  sum.derivatives.tangent_gradient += segment_jacobian.transpose() * u;
  sum.derivatives.tangent_hessian += transverse.transpose() * transverse / length +
                                     u.x() * (to.curvature[0] - from.curvature[0]) +
                                     u.y() * (to.curvature[1] - from.curvature[1]);
}

}  // namespace

Mollified mollify(double t, double epsilon) {
  if (t < epsilon) {
    const double s = t / epsilon;
    return {epsilon * s * s * (2 - s), s * (4 - 3 * s), (4 - 6 * s) / epsilon};
  }
  if (t > 1 - epsilon) {
    // The mirror image 1 - mollified(1 - t).
    const Mollified mirrored = mollify(1 - t, epsilon);
    return {1 - mirrored.value, mirrored.slope, -mirrored.curvature};
  }
  return {t, 1, 0};
}

PathLength mollified_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path, double epsilon, bool ends) {
  PathLength result;
  for (std::size_t first = 0; first + 1 < path.size();) {
    std::size_t last = first + 1;
    while (last + 1 < path.size() && crosses_edge(path[last])) ++last;
    const StraightSection section = unfolded_section(mesh, path, first, last);
    MovingPoint previous{section.begin, Vector2d::Zero(), section.begin_jacobian};
    if (ends && first == 0) {
      previous = mollified_point<0>(section.begin, section.begin_jacobian.leftCols<2>(),
                                    mollified_end(mesh, path.front().point, epsilon));
    }
    for (const StraightSection::Crossing& crossing : section.crossings) {
      const MovingPoint point = mollified_crossing(section, crossing, epsilon);
      add_segment(previous, point, result);
      previous = point;
    }
    MovingPoint reached{section.end, Vector2d::Zero(), section.end_jacobian};
    if (ends && last + 1 == path.size()) {
      reached = mollified_point<2>(section.end, section.end_jacobian.rightCols<2>(),
                                   mollified_end(mesh, path.back().point, epsilon));
    }
    add_segment(previous, reached, result);
    first = last;
  }
  if (result.length > 0) express_in_barycentrics(mesh, path.front().point, path.back().point, result.derivatives);
  return result;
}

PathLength path_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path) {
  PathLength result;
  if (path.size() < 2) return result;
  std::vector<Node> nodes;
  nodes.push_back(Node{path.front().position});
  for (std::size_t i = 1; i + 1 < path.size(); ++i) nodes.push_back(crossing_node(mesh, path[i]));
  nodes.push_back(Node{path.back().position});
  const std::size_t last = nodes.size() - 1;

  std::vector<Vector3d> directions(last);
  std::vector<Matrix3d> curvatures(last);  // Hessian of each segment's length: (I - u u^T) / l
  for (std::size_t i = 0; i < last; ++i) {
    const Vector3d segment = nodes[i + 1].position - nodes[i].position;
    const double length = segment.norm();
    result.length += length;
    directions[i] = length > 0 ? Vector3d(segment / length) : Vector3d(Vector3d::Zero());
    curvatures[i] = length > 0 ? Matrix3d((Matrix3d::Identity() - directions[i] * directions[i].transpose()) / length)
                               : Matrix3d(Matrix3d::Zero());
  }
  if (result.length == 0) return result;

  const SurfacePoint& from = path.front().point;
  const SurfacePoint& to = path.back().point;
  Eigen::Matrix<double, 3, 4> ends;  // derivatives of both ends' positions with respect to their tangent coordinates
  const std::int32_t first_face = common_face(mesh, from, path[1].point);
  const std::int32_t last_face = common_face(mesh, to, path[path.size() - 2].point);
  ends.leftCols<2>() = first_face >= 0 ? unfolded_frame(mesh, from, first_face) : tangent_frame(mesh, from.face);
  ends.rightCols<2>() = last_face >= 0 ? unfolded_frame(mesh, to, last_face) : tangent_frame(mesh, to.face);

  GeodesicDerivatives& d = result.derivatives;
  d.tangent_gradient.head<2>() = -ends.leftCols<2>().transpose() * directions.front();
  d.tangent_gradient.tail<2>() = ends.rightCols<2>().transpose() * directions.back();
  d.tangent_hessian.topLeftCorner<2, 2>() = ends.leftCols<2>().transpose() * curvatures.front() * ends.leftCols<2>();
  d.tangent_hessian.bottomRightCorner<2, 2>() =
      ends.rightCols<2>().transpose() * curvatures.back() * ends.rightCols<2>();
  if (last == 1) {
    const Matrix2d mixed = -ends.leftCols<2>().transpose() * curvatures.front() * ends.rightCols<2>();
    d.tangent_hessian.topRightCorner<2, 2>() = mixed;
    d.tangent_hessian.bottomLeftCorner<2, 2>() = mixed.transpose();
    express_in_barycentrics(mesh, from, to, d);
    return result;
  }

  // The matrix d2g/dt2 is tridiagonal. The parameters t are eliminated by dt/dc = -(d2g/dt2)^-1 d2g/dt dc
  // [Thesis, eq. 3.9].
  const std::size_t m = last - 1;
  std::vector<double> diagonal(m, 1.0);
  std::vector<double> above(m, 0.0);
  std::vector<Eigen::RowVector4d> mixed(m, Eigen::RowVector4d::Zero());
  for (std::size_t k = 0; k < m; ++k) {
    const Node& node = nodes[k + 1];
    if (!node.is_crossing) continue;
    diagonal[k] = node.edge.dot((curvatures[k] + curvatures[k + 1]) * node.edge);
    if (k + 1 < m && nodes[k + 2].is_crossing) above[k] = -node.edge.dot(curvatures[k + 1] * nodes[k + 2].edge);
    if (k == 0) mixed[k].head<2>() -= node.edge.transpose() * curvatures.front() * ends.leftCols<2>();
    if (k + 1 == m) mixed[k].tail<2>() -= node.edge.transpose() * curvatures.back() * ends.rightCols<2>();
  }
  // Thomas's algorithm. If the path runs along an edge, the pivot of their crossing is zero, and the crossing stays.
  std::vector<Eigen::RowVector4d> solution = mixed;
  std::vector<double> pivot(m);
  for (std::size_t k = 0; k < m; ++k) {
    pivot[k] = diagonal[k];
    if (k > 0 && pivot[k - 1] != 0) {
      const double factor = above[k - 1] / pivot[k - 1];
      pivot[k] -= factor * above[k - 1];
      solution[k] -= factor * solution[k - 1];
    }
  }
  for (std::size_t k = m; k-- > 0;) {
    if (k + 1 < m) solution[k] -= above[k] * solution[k + 1];
    if (pivot[k] != 0)
      solution[k] /= pivot[k];
    else
      solution[k].setZero();
  }
  for (std::size_t k = 0; k < m; ++k) d.tangent_hessian -= mixed[k].transpose() * solution[k];
  express_in_barycentrics(mesh, from, to, d);
  return result;
}

void express_in_barycentrics(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                             GeodesicDerivatives& derivatives) {
  Eigen::Matrix<double, 4, 6> jacobian = Eigen::Matrix<double, 4, 6>::Zero();
  const SurfacePoint* points[2] = {&from, &to};
  for (int end = 0; end < 2; ++end) {
    const Frame frame = tangent_frame(mesh, points[end]->face);
    const Vector3d center = position(mesh, *points[end]);
    const Triangle& corners = mesh.faces()[index(points[end]->face)];
    for (int i = 0; i < 3; ++i) {
      jacobian.block<2, 1>(2 * end, 3 * end + i) = frame.transpose() * (mesh.positions()[corners[i]] - center);
    }
  }
  derivatives.gradient = jacobian.transpose() * derivatives.tangent_gradient;
  derivatives.hessian = jacobian.transpose() * derivatives.tangent_hessian * jacobian;
}

}  // namespace supple::surface
