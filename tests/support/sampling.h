#pragma once

#include <vector>

#include "supple/base/random.h"
#include "supple/surface/surface_point.h"

namespace supple::testing {

/// Draws points of a mesh, uniform by area, in O(log faces) each. The mesh must outlive it.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(const surface::TriangleMesh& mesh);
  surface::SurfacePoint point(RandomStream& stream) const;

 private:
  std::vector<double> cumulative_areas_;
};

/// A point uniform by area. O(faces); SurfaceSampler draws many.
surface::SurfacePoint random_point(const surface::TriangleMesh& mesh, RandomStream& stream);
/// A point exactly on a random edge, not at its ends, written in either face of the edge.
surface::SurfacePoint random_edge_point(const surface::TriangleMesh& mesh, RandomStream& stream);
/// A point exactly on a random used vertex, written in a random face of it.
surface::SurfacePoint random_vertex_point(const surface::TriangleMesh& mesh, RandomStream& stream);

}  // namespace supple::testing
