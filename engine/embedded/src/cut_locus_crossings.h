#pragma once

#include <vector>

#include "elastic_network.h"
#include "network_state.h"
#include "supple/numerics/nonsmooth_search.h"

namespace supple::embedded {

/// Candidates that keep paths under compression at cut loci which the trial steps crossed: at most four that each move
/// to one crossing, those first at which the energy falls short of the prediction most, and one that keeps all paths
/// whose ends are at a cut locus already. On hosts that keep their shape, without the mollifier.
std::vector<numerics::NonsmoothCandidate<NetworkState>> cut_locus_candidates(const ElasticNetwork& network,
                                                                             const NetworkState& current,
                                                                             const std::vector<NetworkState>& trials);

}  // namespace supple::embedded
