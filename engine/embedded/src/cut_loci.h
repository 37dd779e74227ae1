#pragma once

#include <Eigen/Core>
#include <vector>

#include "network_state.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

/// What is needed of a surface and a network to look for cut loci.
struct CutLocusContext {
  const surface::GeodesicSolver& solver;
  const std::vector<bool>& held;  ///< points that do not move
};

/// The sides of shortest paths between two points: where each of them is the only one, by the coordinates of the ends
/// that are free to move. Empty where two of them cannot be told apart so.
std::vector<Eigen::Vector4d> sides_of(const std::vector<surface::TangentGeodesic>& paths, const CutLocus& locus,
                                      const std::vector<bool>& held);

/// Moves the ends of paths that are kept at cut loci by as little as possible so that each is at its own, all at once
/// (Gauss and Newton), and returns the shortest paths of each. The state forgets those for which there is none near by.
/// A few searches for each of the paths.
std::vector<EqualPaths> keep_at_cut_loci(const CutLocusContext& context, NetworkState& state);

/// Lets go of paths at cut loci that are longer than the shortest, which `shortest` has for every path: seen from too
/// far away, other paths can seem to be equally long.
void let_go_of_longer(NetworkState& state, std::vector<EqualPaths>& equal,
                      const std::vector<surface::TangentGeodesic>& shortest);

/// Lets go of cut loci of paths that do not push: at rest a path may be shorter than at the cut locus that its ends
/// were pushed across, and has a ridge there and no valley. `pulls` are the energy's derivatives by the lengths of all
/// paths.
void let_go_of_pulling(NetworkState& state, std::vector<EqualPaths>& equal, const std::vector<double>& pulls);

/// Divides the force at each cut locus among its shortest paths, so that the least gradient is left. Shares are at
/// least 0, and their sum is 1. `gradient` holds the energy's derivatives by all tangent coordinates when the first
/// path of each cut locus has the whole force, `pulls` the energy's derivatives by the lengths. Paths without a share
/// are let go, in the state too.
void share_forces(NetworkState& state, std::vector<EqualPaths>& equal, const Eigen::VectorXd& gradient,
                  const std::vector<double>& pulls, const std::vector<bool>& held);

}  // namespace supple::embedded
