#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "network_state.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The length of a path on a host that gives way, by what it depends on: the two tangent coordinates of each end, then
/// the three coordinates of each vertex of the faces that it passes.
struct HostLength {
  double length = 0;
  std::vector<std::int32_t> rows{};  ///< of the degrees of freedom; each once
  Eigen::VectorXd gradient{};
  Eigen::MatrixXd hessian{};  ///< empty below order 2
};

/// From the derivatives by barycentric coordinates of the ends, which lie in these faces and belong to these points
/// (thesis eq. 3.21 and A.1 to A.19).
HostLength host_length(const NetworkState& state, const surface::HostDerivatives& by_barycentrics,
                       std::int32_t from_point, std::int32_t to_point, int order);

/// An element's share of the energy by all that it depends on.
struct HostElement {
  double value = 0;
  std::vector<std::int32_t> rows{};
  Eigen::VectorXd gradient{};
  Eigen::MatrixXd hessian{};

  void add_to(numerics::EnergySum& sum, int order) const;
  /// Takes the motion of a point along a unit vector away: a wall stands there.
  void hold(std::int32_t point, const Eigen::Vector2d& along);
  /// Takes a point's rows away: what happens at a tip is added by itself.
  void take_out(std::int32_t point);
};

/// E(l_1, ..., l_n) of lengths that have derivatives, where E has these. `convex`: with a positive semidefinite matrix
/// near the Hessian, where the lengths' second derivatives are such matrices; paths that push add none.
HostElement element_of_lengths(double value, const Eigen::VectorXd& first, const Eigen::MatrixXd& second,
                               std::span<const HostLength> lengths, int order, bool convex);

}  // namespace supple::embedded
