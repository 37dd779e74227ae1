#include "supple/surface/nearest_point.h"

#include <array>
#include <limits>

#include "face_tree.h"
#include "triangle_area.h"

namespace supple::surface {
namespace {

/// Barycentric coordinates of the point of a triangle that is nearest to p.
Eigen::Vector3d nearest_in_triangle(const Eigen::Vector3d& p, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d normal = doubled_area(corners[0], corners[1], corners[2]);
  Eigen::Vector3d weights;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d &b = corners[(i + 1) % 3], &c = corners[(i + 2) % 3];
    weights[i] = normal.dot((c - b).cross(p - b));
  }
  if (weights.minCoeff() > 0) return weights / weights.sum();
  // Outside of the prism over the triangle, the nearest point lies on a side.
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % 3];
    const Eigen::Vector3d side = b - a;
    const double t = std::clamp(side.dot(p - a) / side.squaredNorm(), 0.0, 1.0);
    const double squared = (a + t * side - p).squaredNorm();
    if (!(squared < smallest)) continue;
    smallest = squared;
    weights.setZero();
    weights[i] = 1 - t;
    weights[(i + 1) % 3] = t;
  }
  return weights;
}

}  // namespace

struct NearestPointSearch::Implementation {
  Implementation(const TriangleMesh& searched_mesh, const Execution& execution)
      : mesh(searched_mesh), tree(searched_mesh.positions(), searched_mesh.faces(), execution) {}
  const TriangleMesh& mesh;
  FaceTree tree;
};

NearestPointSearch::NearestPointSearch(const TriangleMesh& mesh, const Execution& execution)
    : implementation_(std::make_unique<const Implementation>(mesh, execution)) {}
NearestPointSearch::NearestPointSearch(NearestPointSearch&&) noexcept = default;
NearestPointSearch::~NearestPointSearch() = default;

NearestPoint NearestPointSearch::find(const Eigen::Vector3d& p) const {
  const TriangleMesh& mesh = implementation_->mesh;
  NearestPoint nearest;
  implementation_->tree.visit_nearest(p, [&](std::int32_t f, double& limit) {
    const Triangle& face = mesh.faces()[f];
    const std::array<Eigen::Vector3d, 3> corners{mesh.positions()[face[0]], mesh.positions()[face[1]],
                                                 mesh.positions()[face[2]]};
    const SurfacePoint candidate{FaceId(f), nearest_in_triangle(p, corners)};
    const Eigen::Vector3d at = position(mesh, candidate);
    const double squared = (at - p).squaredNorm();
    if (squared > limit || (squared == limit && f > index(nearest.point.face))) return;
    limit = squared;
    nearest = {candidate, at, 0};
  });
  nearest.distance = (nearest.position - p).norm();
  return nearest;
}

}  // namespace supple::surface
