#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "elastic_network.h"
#include "network_energy.h"
#include "network_state.h"
#include "path_cache.h"
#include "supple/numerics/nonsmooth_search.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

/// Finds states where the energy of a network is not smooth and may be lower than after any step for all points
/// (NetworkEnergy says where):
/// - states with one more path kept at a cut locus that a step crossed;
/// - states with points at vertices;
/// - trial states in which the points that keep the step from lowering the energy were moved to their own minima, one
///   after the other, while all other points have taken the whole step.
class NetworkSearch : public numerics::NonsmoothSearch<NetworkState> {
 public:
  struct Options {
    PathCacheOptions paths{};
    bool keeps_cut_loci = true;
  };
  /// `solver` outlives the search and is that of the surface as it is at first; a deformable host brings its own.
  NetworkSearch(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network, Options options);

  std::vector<numerics::NonsmoothCandidate<NetworkState>> candidates(const NetworkState& current,
                                                                     const std::vector<NetworkState>& trials,
                                                                     double reach) const override;

 private:
  using Candidate = numerics::NonsmoothCandidate<NetworkState>;

  const surface::GeodesicSolver& solver_of(const NetworkState& state) const {
    return state.surface() ? *state.surface() : solver_;
  }
  /// One candidate for each vertex near a point and its trial places at which the point would rest.
  std::vector<Candidate> vertices_near(std::size_t point, const NetworkState& current,
                                       const std::vector<NetworkState>& trials) const;
  /// The state with all points at a vertex that only rounding separates from it. The directions of their paths mean
  /// nothing so close to the vertex; from there they leave by the steepest descent.
  std::optional<Candidate> points_put_at_vertices(const NetworkState& current) const;
  /// Points whose elements exceed the quadratic model of the step to a trial state, the worst first.
  std::vector<std::size_t> points_exceeding_quadratic_model(const NetworkState& current,
                                                            const NetworkState& trial) const;
  /// Moves points one after the other from their places in `starts` to where their own elements come to rest, with all
  /// others fixed.
  void minimize_points(NetworkState& state, const std::vector<std::size_t>& points, const NetworkState& starts) const;

  const surface::GeodesicSolver& solver_;
  std::shared_ptr<const ElasticNetwork> network_;
  Options options_;
};

/// The energy of a network as a term of a system, and the search that the system uses with it.
struct NetworkTerm {
  std::shared_ptr<NetworkEnergy> energy;
  std::shared_ptr<const NetworkSearch> search;
};
/// `solver` outlives both.
NetworkTerm network_term(const surface::GeodesicSolver& solver, const std::shared_ptr<const ElasticNetwork>& network,
                         const NetworkSearch::Options& options = {});
/// The same for a checked network with an entry of `fixed` for each point.
NetworkTerm network_term(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> fixed,
                         const NetworkSearch::Options& options = {});

}  // namespace supple::embedded
