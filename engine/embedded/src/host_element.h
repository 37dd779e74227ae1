#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "network_state.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The length of a path on a deformable host with its derivatives by two tangent coordinates of each end and by three
/// coordinates of each vertex of the faces that the path crosses, in this order.
struct HostLength {
  double length = 0;
  std::vector<std::int32_t> rows{};  ///< degrees of freedom, each once
  Eigen::VectorXd gradient{};
  Eigen::MatrixXd hessian{};  ///< empty below order 2
};

/// The same from the derivatives by the barycentric coordinates of the ends, which are these two points of the network
/// [Thesis, eq. 3.21 and A.1 to A.19].
HostLength host_length(const NetworkState& state, const surface::HostDerivatives& by_barycentrics,
                       std::int32_t from_point, std::int32_t to_point, int order);

/// Energy of one element and its derivatives by points and nodes.
struct HostElement {
  double value = 0;
  std::vector<std::int32_t> rows{};
  Eigen::VectorXd gradient{};
  Eigen::MatrixXd hessian{};

  void add_to(numerics::EnergySum& sum, int order) const;
  /// Removes the motion of a point along a unit vector; see PointsElement::project_out.
  void project_out(std::int32_t point, const Eigen::Vector2d& direction);
  /// Sets the derivatives by a point's coordinates to zero; see PointsElement::zero_point.
  void zero_point(std::int32_t point);
};

/// The element with the energy E(l_1, ..., l_n) of n lengths, given the value of E and its derivatives by the lengths.
/// With `convex` the Hessian is replaced by a positive semidefinite matrix near it: the second derivatives of lengths
/// have to be positive semidefinite then, and those of paths under compression are left out.
HostElement element_of_lengths(double value, const Eigen::VectorXd& first, const Eigen::MatrixXd& second,
                               std::span<const HostLength> lengths, int order, bool convex);

}  // namespace supple::embedded
