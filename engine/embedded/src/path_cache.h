#pragma once

#include <memory>
#include <vector>

#include "elastic_network.h"
#include "network_state.h"
#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

struct PathCacheOptions {
  /// Whether the strip of faces that a path crossed in the state before is unfolded first.
  bool reuses_strips = true;
  /// Length of the mollifier as a fraction of an edge [Thesis, eq. 3.12]; 0 leaves it out.
  double mollifier_length = 0;
};

/// Finds the shortest paths of a network at a state, and their derivatives by the nodes of a deformable host. It owns
/// the strips that the last search found, and memory of states that are gone, because new memory costs as much as a
/// search.
class PathCache {
 public:
  /// `solver` outlives the cache. It is that of the surface as it is at first; a deformable host brings its own.
  PathCache(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
            PathCacheOptions options);

  /// Goes on with the strips of a cache of the same network on the same mesh, which has moved since.
  void take_strips(const PathCache& other) { last_ = other.last_; }

  const surface::GeodesicSolver& solver_of(const NetworkState& state) const {
    return state.surface() ? *state.surface() : solver_;
  }

  /// The paths of a state, and the equally short ones of each path at a cut locus, still without their force fractions.
  struct Found {
    std::shared_ptr<FoundPaths> paths;
    std::vector<EqualPaths> equal;
  };
  /// Finds the paths and stores them in the state. Ends of paths that are kept at cut loci are moved back there first;
  /// the state forgets those cut loci that are not found again. Adds the stage "search" and the quantities of the
  /// search to the bill. Cost: a search for each path, or an unfolding where the strip is still the shortest.
  Found find(NetworkState& state, const Execution& execution);
  /// Computes the derivatives of all lengths by points and nodes of a deformable host, in parallel, and stores them in
  /// the state. O(m^2) for a path that crosses m faces.
  void find_host_lengths(NetworkState& state, int order, const Execution& execution) const;

 private:
  std::shared_ptr<FoundPaths> unused_paths();
  void find_mollified(FoundPaths& found, const Execution& execution) const;

  const surface::GeodesicSolver& solver_;
  std::shared_ptr<const ElasticNetwork> network_;
  PathCacheOptions options_;
  std::vector<surface::PointPair> pairs_;   ///< ends of the paths at the last state
  std::shared_ptr<const FoundPaths> last_;  ///< where strips are taken from
  std::vector<std::shared_ptr<FoundPaths>> allocated_;
};

}  // namespace supple::embedded
