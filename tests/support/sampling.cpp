#include "support/sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple::testing {

using surface::SurfacePoint;
using surface::TriangleMesh;

SurfaceSampler::SurfaceSampler(const TriangleMesh& mesh) {
  const auto& p = mesh.positions();
  double total = 0;
  for (const auto& [a, b, c] : mesh.faces()) {
    total += 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    cumulative_areas_.push_back(total);
  }
}

SurfacePoint SurfaceSampler::point(RandomStream& stream) const {
  const double at = stream.uniform() * cumulative_areas_.back();
  const auto found = std::upper_bound(cumulative_areas_.begin(), cumulative_areas_.end() - 1, at);
  const double root = std::sqrt(stream.uniform()), v = stream.uniform();
  const Eigen::Vector3d barycentric(1 - root, root * (1 - v), root * v);
  return {FaceId(static_cast<std::int32_t>(found - cumulative_areas_.begin())), barycentric / barycentric.sum()};
}

SurfacePoint random_point(const TriangleMesh& mesh, RandomStream& stream) { return SurfaceSampler(mesh).point(stream); }

SurfacePoint random_edge_point(const TriangleMesh& mesh, RandomStream& stream) {
  const int h = stream.below(mesh.halfedge_count());
  const double t = stream.uniform(0.001, 0.999);
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  barycentric[h % 3] = 1 - t;
  barycentric[(h + 1) % 3] = t;
  return {FaceId(h / 3), barycentric};
}

SurfacePoint random_vertex_point(const TriangleMesh& mesh, RandomStream& stream) {
  const int h = stream.below(mesh.halfedge_count());
  return {FaceId(h / 3), Eigen::Vector3d::Unit(h % 3)};
}

}  // namespace supple::testing
