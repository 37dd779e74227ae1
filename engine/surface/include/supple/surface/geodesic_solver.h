#pragma once

#include <memory>
#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/geodesic_field.h"
#include "supple/surface/tangent_geodesic.h"

namespace supple::surface {

/// What is already known of a pair and spares the search work. Never changes the answer.
struct PairHints {
  /// A path between the same ends: its length bounds the search.
  const std::vector<PathPoint>* known_path = nullptr;
  /// An exact field from a point near the second end, and the distance between that point and the second end (or more).
  /// By the triangle inequality it tells how far the second end is from every vertex; on shapes that wind, where
  /// straight distances tell little, a search then looks at a strip round the path instead of half the surface.
  const GeodesicField* landmark = nullptr;
  double landmark_distance = 0;
};

/// Two points whose geodesic is asked for.
struct PointPair {
  SurfacePoint from;
  SurfacePoint to;
  const std::vector<PathPoint>* known_path = nullptr;  ///< see PairHints
};

/// Exact geodesics of one mesh. Keeps what depends on the mesh alone and a pool of search states, so that a local query
/// costs nothing that grows with the mesh. All members may be called from several threads at once.
///
/// Memory: about 270 bytes per face, and 100 bytes per face for each search that runs at the same time. Both stay; what
/// a search needs besides, for the windows that wait at its front, is given back when it ends but for some megabytes.
class GeodesicSolver {
 public:
  explicit GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh);
  ~GeodesicSolver();
  GeodesicSolver(const GeodesicSolver&) = delete;
  GeodesicSolver& operator=(const GeodesicSolver&) = delete;

  const TriangleMesh& mesh() const;
  const std::shared_ptr<const TriangleMesh>& shared_mesh() const;

  /// What the solver holds besides the mesh: what it has computed of the mesh, and the searches that are idle now.
  std::int64_t memory_bytes() const;

  /// Length of the shortest path; infinity where there is none. Goal-directed: the work grows with the windows near the
  /// path. The points must be valid (checked_point).
  double distance(const SurfacePoint& from, const SurfacePoint& to, const Execution& execution = {}) const;

  /// The shortest path with what `options` asks for.
  Geodesic geodesic(const SurfacePoint& from, const SurfacePoint& to, const GeodesicOptions& options = {},
                    const Execution& execution = {}, const PairHints& hints = {}) const;

  /// One search for many targets, stopped once all are certain.
  std::vector<Geodesic> geodesics(const SurfacePoint& from, std::span<const SurfacePoint> to,
                                  const GeodesicOptions& options = {}, const Execution& execution = {}) const;

  /// Many pairs, in parallel, into memory that the caller owns: results[i] is that of pairs[i]. Pairs with the same
  /// first point share a search where that is less work than one for each. Throws what `geodesic` throws.
  void pairs(std::span<const PointPair> pairs, std::span<Geodesic> results, const GeodesicOptions& options = {},
             const Execution& execution = {}) const;

  /// Many pairs again and again while their points move a little, in parallel, into memory that the caller owns: what
  /// springs between them need. found[i].strip, where `strips_known`, is the strip of pairs[i] before its ends moved:
  /// it is unfolded and kept where no other path can be as short, which takes a fraction of a search. Never changes
  /// the answer. A few numbers for each pair that was not searched: about 0.3 microseconds. With `paths`, one for each
  /// pair, these receive the paths themselves, and every pair between two faces is searched; that of ends in one place
  /// is empty. Throws what `geodesic` throws.
  PathsFound tangent_geodesics(std::span<const PointPair> pairs, std::span<TangentGeodesic> found, bool strips_known,
                               const Execution& execution = {}, std::span<std::vector<PathPoint>> paths = {}) const;

  /// Distances from one or several sources to every vertex, and, if `options.keep_windows`, to every point.
  GeodesicField field(std::span<const SurfacePoint> sources, const FieldOptions& options = {},
                      const Execution& execution = {}) const;

  struct Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::surface
