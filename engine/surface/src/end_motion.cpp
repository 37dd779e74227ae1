#include "end_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "halfedge_frame.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;

/// The corners around a vertex of an end's face from `face` to the end's own face, as outgoing halfedges; empty if
/// `face` is its own. `counterclockwise` receives their direction.
std::vector<std::int32_t> fan_between(const TriangleMesh& mesh, const SurfacePoint& end, std::int32_t face,
                                      bool& counterclockwise) {
  if (index(end.face) == face) return {};
  const int corner = corner_of(end);
  const int side = side_of(end);
  if (corner < 0 && side < 0) return {};
  const std::int32_t base = 3 * index(end.face) + (corner >= 0 ? corner : side);
  if (corner < 0) {
    counterclockwise = true;
    return {TriangleMesh::next(mesh.twin(base)), base};
  }
  std::vector<std::int32_t> fan;
  double angle = 0;
  std::int32_t h = base;
  do {  // counterclockwise from the end's own face
    fan.push_back(h);
    if (TriangleMesh::face_of(h) == face) break;
    angle += mesh.corner_angle(h);
    h = mesh.rotate(h);
  } while (h >= 0 && h != base);
  const bool found = TriangleMesh::face_of(fan.back()) == face;
  const std::int32_t v = mesh.tail(base);
  counterclockwise = !found || (!mesh.is_boundary(v) && angle > 0.5 * mesh.vertex_angle(v));
  if (counterclockwise) {
    fan.clear();
    h = base;
    do {
      fan.push_back(h);
      if (TriangleMesh::face_of(h) == face) break;
      h = mesh.twin(h) >= 0 ? TriangleMesh::next(mesh.twin(h)) : -1;
    } while (h >= 0 && h != base);
    if (TriangleMesh::face_of(fan.back()) != face) return {};
  }
  std::reverse(fan.begin(), fan.end());
  return fan;
}

Vector3d normal_of(const TriangleMesh& mesh, std::int32_t h) {
  const Eigen::Matrix<double, 3, 2> frame = halfedge_frame(mesh, h);
  return Vector3d(frame.col(0)).cross(Vector3d(frame.col(1)));
}

/// Rotates the corners of an end's face into the first face of the fan, about the vertex in its middle.
void unfold_corners(const TriangleMesh& mesh, const std::vector<std::int32_t>& fan, bool counterclockwise,
                    const Vector3d& center, const Vector3d& force, EndMotion& result) {
  const std::int32_t pivot = mesh.tail(fan.front());
  const Vector3d& at = mesh.positions()[pivot];
  const Vector3d normal = normal_of(mesh, fan.front());
  const auto near_of = [&](std::int32_t h) {
    return counterclockwise ? mesh.head(h) : mesh.tail(TriangleMesh::previous(h));
  };
  const auto far_of = [&](std::int32_t h) {
    return counterclockwise ? mesh.tail(TriangleMesh::previous(h)) : mesh.head(h);
  };
  // The change of the angle of rotation, as a linear form in the motions of vertices. Its parts are rotations of
  // edges within the planes of faces.
  std::vector<std::pair<std::int32_t, Vector3d>> turn;
  const auto add_turn = [&](double sign, std::int32_t h, std::int32_t vertex) {
    const Vector3d edge = mesh.positions()[vertex] - at;
    const Vector3d form = sign * normal_of(mesh, h).cross(edge) / edge.squaredNorm();
    turn.emplace_back(vertex, form);
    turn.emplace_back(pivot, -form);
  };
  const Vector3d axis = (mesh.positions()[far_of(fan.front())] - at).normalized();
  const Vector3d across = normal.cross(axis);
  add_turn(1, fan.front(), far_of(fan.front()));
  double angle = 0;
  const auto unfold = [&](std::int32_t vertex) {
    const auto i = std::find(result.motion.vertices.begin(), result.motion.vertices.end(), vertex) -
                   result.motion.vertices.begin();
    const Vector3d edge = mesh.positions()[vertex] - at;
    const double length = edge.norm();
    const Vector3d along = std::cos(angle) * axis + std::sin(angle) * across;
    result.motion.barycentric_jacobian.col(i) = at + length * along - center;
    const Vector3d stretching = force.dot(along) / length * edge;
    auto& terms = result.corners[i].terms;
    terms = {{pivot, force - stretching}, {vertex, stretching}};
    for (const auto& [other, form] : turn) terms.emplace_back(other, length * force.dot(normal.cross(along)) * form);
  };
  for (std::size_t k = 1; k < fan.size(); ++k) {
    const std::int32_t h = fan[k];
    const bool own = k + 1 == fan.size();
    if (own) unfold(near_of(h));
    add_turn(-1, h, near_of(h));
    add_turn(1, h, far_of(h));
    angle += (counterclockwise ? 1 : -1) * mesh.corner_angle(h);
    if (own) unfold(far_of(h));
  }
}

}  // namespace

EndMotion end_motion(const TriangleMesh& mesh, const PathPoint& end, int which, std::int32_t face,
                     const Vector3d& force) {
  const Triangle& corners = mesh.faces()[index(end.point.face)];
  EndMotion result;
  result.motion.end = which;
  for (int i = 0; i < 3; ++i) {
    result.motion.vertices[i] = corners[i];
    result.motion.weights[i] = end.point.barycentric[i];
    result.motion.barycentric_jacobian.col(i) = mesh.positions()[corners[i]] - end.position;
    result.corners[i].terms = {{corners[i], force}};
  }
  bool counterclockwise = false;
  const std::vector<std::int32_t> fan = fan_between(mesh, end.point, face, counterclockwise);
  if (!fan.empty()) unfold_corners(mesh, fan, counterclockwise, end.position, force, result);
  return result;
}

std::vector<std::int32_t> faces_between(const TriangleMesh& mesh, const SurfacePoint& end, std::int32_t face) {
  bool counterclockwise = false;
  std::vector<std::int32_t> faces{index(end.face)};
  for (const std::int32_t h : fan_between(mesh, end, face, counterclockwise)) faces.push_back(TriangleMesh::face_of(h));
  return faces;
}

}  // namespace supple::surface
