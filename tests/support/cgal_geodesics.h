#pragma once

#include <memory>
#include <vector>

#include "supple/surface/surface_point.h"

namespace supple::testing {

/// Geodesic distances by CGAL's Surface_mesh_shortest_path (exact predicates, inexact constructions): the oracle of the
/// tests and the peer of the benchmarks. CGAL's headers stay in the source file.
///
/// CGAL 5.5 mirrors a point that lies exactly on an edge along that edge, as a source and as a target, so that its
/// distances are off by up to the edge's length: such a point is moved into its face by 1e-12 of its coordinates. Not
/// for use by several threads.
class CgalGeodesics {
 public:
  explicit CgalGeodesics(const surface::TriangleMesh& mesh);
  ~CgalGeodesics();
  CgalGeodesics(const CgalGeodesics&) = delete;
  CgalGeodesics& operator=(const CgalGeodesics&) = delete;

  /// Forgets the last source and its sequence tree.
  void set_source(const surface::SurfacePoint& source);
  /// Builds the source's sequence tree: CGAL's search from one point to all.
  void search();
  /// Distance from the source to a point; infinity where unreachable. Needs search().
  double distance(const surface::SurfacePoint& point) const;
  /// Distance from the source to every vertex. Needs search().
  std::vector<double> vertex_distances() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::testing
