#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "network_state.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// A small stiffness of every point that is added to Newton's matrix and not to the energy, so that equilibria are the
/// same with and without it. A network that can spin or drift freely has a direction without stiffness, in which
/// rounding alone could move it across half of the host. In all other directions Newton's method converges linearly, by
/// a factor of about a millionth in each step, instead of quadratically (the proximal point method, [Rockafellar1976]).
class PointDamping : public numerics::Term<NetworkState> {
 public:
  /// `stiffness` is ConstrainedPoints::stiffness: one for each point, energy per squared mesh unit.
  explicit PointDamping(std::vector<double> stiffness) : stiffness_(std::move(stiffness)) {}

  std::string_view name() const override { return "point_damping"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState&, int order, numerics::EnergySum& sum) const override {
    if (order < 2) return;
    for (std::size_t i = 0; i < stiffness_.size(); ++i)
      for (int k = 0; k < 2; ++k) {
        const auto row = static_cast<Eigen::Index>(2 * i) + k;
        sum.hessian.add(row, row, damping_ratio * stiffness_[i]);
      }
  }
  /// The bill leaves it out, because it has no energy and takes next to no time.
  void bill(CostLedger&, double) const override {}

 private:
  static constexpr double damping_ratio = 1e-6;  ///< damping over each point's own stiffness

  std::vector<double> stiffness_;
};

}  // namespace supple::embedded
