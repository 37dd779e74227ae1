#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "network_state.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// A small stiffness of every point in Newton's matrix that the energy does not have, so that equilibria are the same
/// with and without it. Where an equilibrium is followed, it keeps a network that can spin or drift freely in its
/// place: in a direction without stiffness rounding alone would move it by half the host. In all other directions
/// Newton's method converges by a factor of about a millionth in each step instead of quadratically (the proximal point
/// method, Rockafellar 1976).
class PointDamping : public numerics::Term<NetworkState> {
 public:
  /// For each point the stiffness that its elements hold it with (ConstrainedPoints::stiffness).
  explicit PointDamping(std::vector<double> stiffness) : stiffness_(std::move(stiffness)) {}

  std::string_view name() const override { return "point_damping"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState&, int order, numerics::EnergySum& sum) const override {
    if (order < 2) return;
    for (std::size_t i = 0; i < stiffness_.size(); ++i)
      for (int k = 0; k < 2; ++k) {
        const auto row = static_cast<Eigen::Index>(2 * i) + k;
        sum.hessian.add(row, row, damping * stiffness_[i]);
      }
  }
  /// It takes no time to speak of and has no energy: the bill leaves it out.
  void bill(CostLedger&, double) const override {}

 private:
  static constexpr double damping = 1e-6;  ///< share of each point's own stiffness

  std::vector<double> stiffness_;
};

}  // namespace supple::embedded
