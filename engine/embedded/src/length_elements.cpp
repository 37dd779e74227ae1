#include "length_elements.h"

#include <array>
#include <cmath>

namespace supple::embedded {

SpringElement RigidHostElements::spring(std::size_t i, int order) const {
  const Spring& own = network_.springs()[i];
  const surface::TangentGeodesic& geodesic = found_.geodesics[i];
  if (geodesic.coincident()) return spring_element_at_zero(own, geodesic.turn, i);
  return spring_element(own, found_.length_with_derivatives(i, order >= 2));
}

TriangleElement RigidHostElements::triangle(std::size_t t, int order) const {
  const ElasticNetwork::Triangle& own = network_.triangles()[t];
  TriangleElement element(own.given.corners);
  const TriangleEnergy::Value energy = own.energy.at(network_.side_lengths(found_, t));
  element.value = energy.energy;
  if (order < 1 || !std::isfinite(energy.energy)) return element;
  Eigen::Matrix<double, 6, 3> slopes = Eigen::Matrix<double, 6, 3>::Zero();
  for (int k = 0; k < 3; ++k) {
    const ElasticNetwork::Side& side = own.sides[static_cast<std::size_t>(k)];
    const LengthDerivatives length = found_.length_with_derivatives(side.path, order >= 2);
    const int from = 2 * side.from_corner;
    const int to = 2 * side.to_corner;
    slopes.block<2, 1>(from, k) = length.gradient.head<2>();
    slopes.block<2, 1>(to, k) = length.gradient.tail<2>();
    if (order < 2) continue;
    element.hessian.block<2, 2>(from, from) += energy.first[k] * length.hessian.topLeftCorner<2, 2>();
    element.hessian.block<2, 2>(from, to) += energy.first[k] * length.hessian.topRightCorner<2, 2>();
    element.hessian.block<2, 2>(to, from) += energy.first[k] * length.hessian.bottomLeftCorner<2, 2>();
    element.hessian.block<2, 2>(to, to) += energy.first[k] * length.hessian.bottomRightCorner<2, 2>();
  }
  element.gradient = slopes * energy.first;
  if (order >= 2) element.hessian += slopes * energy.second * slopes.transpose();
  return element;
}

HostLength DeformableHostElements::length(std::size_t path, int order) const {
  const surface::HostDerivatives& exact = state_.host_lengths()->lengths[path];
  const auto [from, to] = network_.paths()[path];
  const auto& points = state_.found()->paths[path];
  // The convex part divides by the distance between the ends, which rounding can make zero.
  if (!convex_ || points.empty() || points.front().position == points.back().position)
    return host_length(state_, exact, from, to, order);
  surface::HostDerivatives near = exact;
  near.hessian = surface::convex_host_hessian(state_.mesh(), points, exact.vertices);
  return host_length(state_, near, from, to, order);
}

HostElement DeformableHostElements::spring(std::size_t i, int order) const {
  const Spring& own = network_.springs()[i];
  const double excess = state_.found()->geodesics[i].distance - own.rest_length;
  if (order < 1) return {own.weight * excess * excess};
  const HostLength by_nodes = length(i, order);
  return element_of_lengths(own.weight * excess * excess, Eigen::VectorXd::Constant(1, 2 * own.weight * excess),
                            Eigen::MatrixXd::Constant(1, 1, 2 * own.weight), {&by_nodes, 1}, order, convex_);
}

HostElement DeformableHostElements::triangle(std::size_t t, int order) const {
  const ElasticNetwork::Triangle& own = network_.triangles()[t];
  const TriangleEnergy::Value energy = own.energy.at(network_.side_lengths(*state_.found(), t));
  if (order < 1 || !std::isfinite(energy.energy)) return {energy.energy};
  std::array<HostLength, 3> lengths;
  for (std::size_t k = 0; k < 3; ++k) lengths[k] = length(own.sides[k].path, order);
  return element_of_lengths(energy.energy, energy.first, energy.second, lengths, order, convex_);
}

}  // namespace supple::embedded
