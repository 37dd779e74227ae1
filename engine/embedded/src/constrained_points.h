#pragma once

#include <cstdint>
#include <vector>

#include "supple/embedded/network.h"

namespace supple::embedded {

/// Tells which points of a network can move, and how stiffly the elements at each point hold it in the first state.
struct ConstrainedPoints {
  std::vector<bool> held;           ///< for each point whether it is fixed or loose
  std::vector<std::int32_t> loose;  ///< points that no element holds; they stay where they are
  /// For each point twice the sum of its springs' weights; a triangle counts as springs of Young's modulus times
  /// thickness, by which its energy bends over its lengths. Energy per squared mesh unit.
  std::vector<double> stiffness;
  double largest_stiffness = 0;  ///< of one point
};

/// O(points + elements).
ConstrainedPoints constrained_points(const Network& network);

/// Two entries for each point, one for each of its tangent coordinates.
std::vector<bool> held_coordinates(const std::vector<bool>& held_points);

}  // namespace supple::embedded
