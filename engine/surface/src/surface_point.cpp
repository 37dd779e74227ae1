#include "supple/surface/surface_point.h"

#include <cmath>
#include <limits>

#include "halfedge_frame.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"

namespace supple::surface {
namespace {

/// Tolerance of barycentric coordinates. It accepts those computed in single precision or printed with six digits.
constexpr double barycentric_tolerance = 1e-5;

std::string text(const Eigen::Vector3d& b) {
  return "[" + number_text(b[0]) + ", " + number_text(b[1]) + ", " + number_text(b[2]) + "]";
}

}  // namespace

SurfacePoint vertex_point(const TriangleMesh& mesh, VertexId v) {
  const std::int32_t i = index(v);
  if (i < 0 || i >= mesh.vertex_count()) {
    throw PointError("point.vertex_out_of_range", "A point names a vertex that the mesh does not have.",
                     {{"vertex", std::to_string(i) + " is not in 0 to " + std::to_string(mesh.vertex_count() - 1)}});
  }
  const std::int32_t h = mesh.outgoing(i);
  if (h < 0) {
    throw PointError("point.isolated_vertex", "A point names a vertex that belongs to no face.",
                     {{"vertex", std::to_string(i) + " belongs to no face"}});
  }
  return {FaceId(TriangleMesh::face_of(h)), Eigen::Vector3d::Unit(h % 3)};
}

SurfacePoint checked_point(const TriangleMesh& mesh, const SurfacePoint& point, const std::string& where) {
  const std::int32_t f = index(point.face);
  if (f < 0 || f >= mesh.face_count()) {
    throw PointError(
        "point.face_out_of_range", "A point names a face that the mesh does not have.",
        {{where + "/face", std::to_string(f) + " is not in 0 to " + std::to_string(mesh.face_count() - 1)}});
  }
  const std::string coordinates = where + "/barycentric";
  if (!point.barycentric.allFinite()) {
    throw PointError("point.non_finite", "A point has a barycentric coordinate that is not finite.",
                     {{coordinates, "must be three finite numbers"}});
  }
  if (point.barycentric.minCoeff() < -barycentric_tolerance ||
      !(std::abs(point.barycentric.sum() - 1) <= barycentric_tolerance)) {
    throw PointError("point.outside_face", "A point lies outside its face.",
                     {{coordinates, text(point.barycentric) + " must be nonnegative and of sum 1, within 1e-5"}});
  }
  Eigen::Vector3d b = point.barycentric.cwiseMax(0.0);
  if (std::abs(b.sum() - 1) > 4 * std::numeric_limits<double>::epsilon()) b /= b.sum();
  // The largest coordinate absorbs the rounding of the sum, so that small ones keep all their digits.
  int largest = 0;
  b.maxCoeff(&largest);
  b[largest] = 1 - (b[(largest + 1) % 3] + b[(largest + 2) % 3]);
  return {point.face, b};
}

Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Triangle& face = mesh.faces()[index(point.face)];
  const auto& p = mesh.positions();
  return point.barycentric[0] * p[face[0]] + point.barycentric[1] * p[face[1]] + point.barycentric[2] * p[face[2]];
}

int corner_of(const SurfacePoint& point) {
  const Eigen::Vector3d& b = point.barycentric;
  for (int i = 0; i < 3; ++i) {
    if (b[(i + 1) % 3] == 0 && b[(i + 2) % 3] == 0) return i;
  }
  return -1;
}

int side_of(const SurfacePoint& point) {
  const Eigen::Vector3d& b = point.barycentric;
  for (int i = 0; i < 3; ++i) {
    if (b[(i + 2) % 3] == 0 && b[i] != 0 && b[(i + 1) % 3] != 0) return i;
  }
  return -1;
}

Eigen::Matrix<double, 3, 2> tangent_frame(const TriangleMesh& mesh, FaceId face) {
  return halfedge_frame(mesh, 3 * index(face));
}

}  // namespace supple::surface
