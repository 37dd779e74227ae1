#pragma once

#include <memory>
#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/geodesic_field.h"

namespace supple::surface {

/// Exact geodesics of one mesh. Keeps what depends on the mesh alone and a pool of search states, so that a local query
/// costs nothing that grows with the mesh. All members may be called from several threads at once.
///
/// Memory: about 250 bytes per face, and 60 bytes per face for each search that runs at the same time.
class GeodesicSolver {
 public:
  explicit GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh);
  ~GeodesicSolver();
  GeodesicSolver(const GeodesicSolver&) = delete;
  GeodesicSolver& operator=(const GeodesicSolver&) = delete;

  const TriangleMesh& mesh() const;
  const std::shared_ptr<const TriangleMesh>& shared_mesh() const;

  /// Length of the shortest path; infinity where there is none. Goal-directed: the work grows with the windows near the
  /// path. The points must be valid (checked_point).
  double distance(const SurfacePoint& from, const SurfacePoint& to, const Execution& execution = {}) const;

  /// The shortest path with what `options` asks for. `known_path`, a path between (nearly) the same ends, gives the
  /// search an upper bound to prune with.
  Geodesic geodesic(const SurfacePoint& from, const SurfacePoint& to, const GeodesicOptions& options = {},
                    const Execution& execution = {}, const std::vector<PathPoint>* known_path = nullptr) const;

  /// One search for many targets, stopped once all are certain.
  std::vector<Geodesic> geodesics(const SurfacePoint& from, std::span<const SurfacePoint> to,
                                  const GeodesicOptions& options = {}, const Execution& execution = {}) const;

  /// Distances from one or several sources to every vertex, and, if `options.keep_windows`, to every point.
  GeodesicField field(std::span<const SurfacePoint> sources, const FieldOptions& options = {},
                      const Execution& execution = {}) const;

  struct Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::surface
