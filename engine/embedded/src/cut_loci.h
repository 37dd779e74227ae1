#pragma once

#include <Eigen/Core>
#include <vector>

#include "network_state.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

/// The surface and the fixed points of a network, for the functions below.
struct CutLocusContext {
  const surface::GeodesicSolver& solver;
  const std::vector<bool>& fixed;  ///< for each point
};

/// For each of several equally short paths a unit change of the free ends after which it is the only shortest one.
/// Empty where two of the paths cannot be told apart in this way.
std::vector<Eigen::Vector4d> sides_of(const std::vector<surface::TangentGeodesic>& paths, const CutLocus& locus,
                                      const std::vector<bool>& fixed);

/// Moves the ends of the paths that a state keeps at cut loci back to these, all at once and by as little as possible
/// (Gauss-Newton method for equal lengths), and returns the shortest paths of each. The state forgets the cut loci that
/// are not found nearby. A few searches for each of the paths.
std::vector<EqualPaths> return_to_cut_loci(const CutLocusContext& context, NetworkState& state);

/// Forgets cut loci whose paths are not the shortest ones: from too far away, other paths can seem to be equally long.
/// `shortest` has the shortest path for every path of the network.
void drop_non_shortest(NetworkState& state, std::vector<EqualPaths>& equal,
                       const std::vector<surface::TangentGeodesic>& shortest);

/// Forgets cut loci of paths that are not under compression: their energy has a ridge there instead of a valley.
/// `forces` are those of all paths.
void drop_uncompressed(NetworkState& state, std::vector<EqualPaths>& equal, const std::vector<double>& forces);

/// Divides the force at each cut locus among its shortest paths so that the least gradient is left. The fractions are
/// not negative and have the sum 1. `gradient` holds the energy's derivatives by all tangent coordinates while the
/// first path of each cut locus has the whole force, `forces` those of all paths. Paths without force are forgotten, in
/// the state, too.
void distribute_path_forces(NetworkState& state, std::vector<EqualPaths>& equal, const Eigen::VectorXd& gradient,
                            const std::vector<double>& forces, const std::vector<bool>& fixed);

}  // namespace supple::embedded
