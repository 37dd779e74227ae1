#pragma once

#include <memory>
#include <vector>

#include "supple/surface/surface_point.h"

namespace supple::testing {

/// Geodesic distances by CGAL's Surface_mesh_shortest_path (exact predicates, inexact constructions), as the oracle of
/// tests and the peer of benchmarks. Only the source file includes CGAL's headers.
///
/// CGAL 5.5 mirrors a source or target that lies exactly on an edge along that edge, so that distances are wrong by up
/// to the edge's length. Such a point is therefore moved into its face by 1e-12 of its coordinates. Not thread-safe.
class CgalGeodesics {
 public:
  explicit CgalGeodesics(const surface::TriangleMesh& mesh);
  ~CgalGeodesics();
  CgalGeodesics(const CgalGeodesics&) = delete;
  CgalGeodesics& operator=(const CgalGeodesics&) = delete;

  /// Sets the source and deletes the sequence tree of the previous one.
  void set_source(const surface::SurfacePoint& source);
  /// Builds the source's sequence tree, which is CGAL's search from one point to all others.
  void search();
  /// Distance from the source to a point; infinity if it is unreachable. Requires search().
  double distance(const surface::SurfacePoint& point) const;
  /// Distance from the source to every vertex. Requires search().
  std::vector<double> vertex_distances() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::testing
