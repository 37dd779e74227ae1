#pragma once

#include <array>
#include <cstdint>

#include "network_state.h"
#include "supple/embedded/network.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// A spring's share of the energy, by the tangent coordinates of its two ends: 4 rows.
struct SpringElement {
  std::array<std::int32_t, 4> rows{};
  double value = 0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();

  void add_to(numerics::EnergySum& sum, int order) const;
};

/// weight (length - rest_length)^2 of a length that has derivatives (thesis eq. 3.13).
SpringElement spring_element(const Spring& spring, const SpringLengthDerivatives& length);

/// The same for ends in one place, whose coordinates differ by the rotation of `turn` radians. The squared distance is
/// differentiable there. With a rest length the energy has a peak: its slope is 2 weight rest_length whichever way the
/// ends part, and a direction, another for each spring, is chosen by its number.
SpringElement spring_element_at_zero(const Spring& spring, double turn, std::size_t number);

}  // namespace supple::embedded
