#pragma once

#include <memory>
#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/geodesic_field.h"
#include "supple/surface/tangent_geodesic.h"

namespace supple::surface {

/// What is known about a pair before the search. It saves work and never changes the answer.
struct PairHints {
  /// A path between the same ends: its length bounds the search.
  const std::vector<PathPoint>* known_path = nullptr;
  /// An exact field from a point near the second end, and the distance between that point and the second end (or more).
  /// By the triangle inequality, the field bounds the second end's distance from every vertex. On winding shapes these
  /// bounds are much better than straight distances: the search covers a strip around the path instead of half the
  /// surface.
  const GeodesicField* landmark = nullptr;
  double landmark_distance = 0;
};

/// Two points whose geodesic is asked for.
struct PointPair {
  SurfacePoint from;
  SurfacePoint to;
  const std::vector<PathPoint>* known_path = nullptr;  ///< see PairHints
};

/// Computes exact geodesics of one mesh. It keeps what depends on the mesh alone and a pool of search states, so that
/// the cost of a local query does not grow with the mesh. All members may be called from several threads at once.
///
/// Memory: about 270 bytes per face, and 100 bytes per face for each search that runs at the same time. Both are
/// retained. What a search needs in addition, for the windows at its front, is freed when it ends, except for some
/// megabytes.
class GeodesicSolver {
 public:
  explicit GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh);
  /// O(faces), at most half a microsecond each. It checks for a stop request every few milliseconds.
  GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh, const Execution& execution);
  ~GeodesicSolver();
  GeodesicSolver(const GeodesicSolver&) = delete;
  GeodesicSolver& operator=(const GeodesicSolver&) = delete;

  const TriangleMesh& mesh() const;
  const std::shared_ptr<const TriangleMesh>& shared_mesh() const;

  /// The memory in bytes that the solver uses in addition to the mesh: what it has computed from the mesh, and idle
  /// searches.
  std::int64_t memory_bytes() const;

  /// The length of the shortest path, or infinity if there is none. The search is directed at its goal: the work grows
  /// with the number of windows near the path. The points must be valid (checked_point).
  double distance(const SurfacePoint& from, const SurfacePoint& to, const Execution& execution = {}) const;

  /// The shortest path, with everything that `options` asks for.
  Geodesic geodesic(const SurfacePoint& from, const SurfacePoint& to, const GeodesicOptions& options = {},
                    const Execution& execution = {}, const PairHints& hints = {}) const;

  /// The shortest paths to many targets, by one search that stops when all of them are certain.
  std::vector<Geodesic> geodesics(const SurfacePoint& from, std::span<const SurfacePoint> to,
                                  const GeodesicOptions& options = {}, const Execution& execution = {}) const;

  /// The shortest paths of many pairs, computed in parallel into memory that the caller owns: results[i] belongs to
  /// pairs[i]. Pairs with the same first point share a search if that is less work than one search for each. Throws
  /// what `geodesic` throws.
  void pairs(std::span<const PointPair> pairs, std::span<Geodesic> results, const GeodesicOptions& options = {},
             const Execution& execution = {}) const;

  /// The shortest paths of many pairs whose points move a little from call to call, computed in parallel into memory
  /// that the caller owns. This is what springs between the points need. If `strips_known`, found[i].strip is the strip
  /// of pairs[i] before its ends moved. The strip is unfolded, and it is the answer if no other path can be as short.
  /// This takes a fraction of a search (about 0.3 microseconds for each pair) and never changes the answer. `paths`, if
  /// given, has one entry for each pair and receives the paths themselves; every pair between two faces is then
  /// searched for. The path of two coincident ends is empty. Throws what `geodesic` throws.
  PathCounts tangent_geodesics(std::span<const PointPair> pairs, std::span<TangentGeodesic> found, bool strips_known,
                               const Execution& execution = {}, std::span<std::vector<PathPoint>> paths = {}) const;

  /// Distances from one or several sources to every vertex, and, if `options.keep_windows`, to every point.
  GeodesicField field(std::span<const SurfacePoint> sources, const FieldOptions& options = {},
                      const Execution& execution = {}) const;

  struct Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::surface
