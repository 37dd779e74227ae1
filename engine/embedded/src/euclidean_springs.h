#pragma once

#include <string_view>
#include <vector>

#include "network_state.h"
#include "supple/embedded/network.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// E = sum weight (|x_i - x_j| - rest_length)^2 with lengths through space. E is smooth within faces. Its slope jumps
/// across edges, where points stick although the surface would let them slide on [Thesis, fig. 3.12].
class EuclideanSprings : public numerics::Term<NetworkState> {
 public:
  explicit EuclideanSprings(const Network& network) : springs_(network.springs) {}

  std::string_view name() const override { return "euclidean_springs"; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  std::vector<Spring> springs_;
};

}  // namespace supple::embedded
