#pragma once

#include <cstdint>
#include <vector>

#include "supple/embedded/network.h"

namespace supple::embedded {

/// The points of a network that cannot move, and the stiffness of all points.
struct ConstrainedPoints {
  std::vector<bool> fixed;          ///< for each point whether it is fixed or loose
  std::vector<std::int32_t> loose;  ///< points without an elastic element; they stay in place
  /// For each point twice the sum of its springs' weights. A triangle counts as two springs of Young's modulus times
  /// thickness, which is about the second derivative of its energy by a length. Energy per squared mesh unit.
  std::vector<double> stiffness;
  double max_stiffness = 0;  ///< the largest of them
};

/// O(points + elements).
ConstrainedPoints constrained_points(const Network& network);

/// Two entries for each point, one for each of its tangent coordinates.
std::vector<bool> fixed_coordinates(const std::vector<bool>& fixed_points);

}  // namespace supple::embedded
