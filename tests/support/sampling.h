#pragma once

#include <vector>

#include "supple/base/random.h"
#include "supple/surface/surface_point.h"

namespace supple::testing {

/// Draws random points of a mesh, uniform by area, in O(log faces) each. The mesh must outlive the sampler.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(const surface::TriangleMesh& mesh);
  surface::SurfacePoint point(RandomStream& stream) const;

 private:
  std::vector<double> cumulative_areas_;
};

/// A random point, uniform by area. O(faces); SurfaceSampler is faster for many points.
surface::SurfacePoint random_point(const surface::TriangleMesh& mesh, RandomStream& stream);
/// A point exactly on a random edge, not at its ends, given in either face of the edge.
surface::SurfacePoint random_edge_point(const surface::TriangleMesh& mesh, RandomStream& stream);
/// A point exactly on a random used vertex, given in a random face of that vertex.
surface::SurfacePoint random_vertex_point(const surface::TriangleMesh& mesh, RandomStream& stream);

}  // namespace supple::testing
