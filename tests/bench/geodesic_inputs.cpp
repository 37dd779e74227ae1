#include <cmath>
#include <numbers>

#include "geodesic_bench.h"
#include "supple/surface/exponential_map.h"
#include "support/sampling.h"

namespace supple::bench {

using surface::SurfacePoint;
using surface::TriangleMesh;

std::shared_ptr<const TriangleMesh> make_shared_mesh(const BenchMesh& mesh) {
  return std::make_shared<const TriangleMesh>(mesh.make());
}

std::vector<PointPair> far_pairs(const TriangleMesh& mesh, int n, std::uint64_t seed) {
  RandomStream stream("far pairs", seed);
  const testing::SurfaceSampler sampler(mesh);
  std::vector<PointPair> pairs;
  while (static_cast<int>(pairs.size()) < n) {
    const SurfacePoint from = sampler.point(stream), to = sampler.point(stream);
    if (mesh.component(index(from.face)) == mesh.component(index(to.face))) pairs.emplace_back(from, to);
  }
  return pairs;
}

std::vector<PointPair> near_pairs(const TriangleMesh& mesh, int n, double edges, std::uint64_t seed) {
  RandomStream stream("near pairs", seed);
  const testing::SurfaceSampler sampler(mesh);
  std::vector<PointPair> pairs;
  for (int i = 0; i < n; ++i) {
    const SurfacePoint from = sampler.point(stream);
    const double angle = stream.uniform(0, 2 * std::numbers::pi);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const Eigen::Vector3d tangent = edges * mesh.mean_edge_length() * (tangent_frame(mesh, from.face) * direction);
    pairs.emplace_back(from, exponential_map(mesh, from, tangent, {}, false).end);
  }
  return pairs;
}

}  // namespace supple::bench
