#pragma once

#include <vector>

#include "cell_system.h"
#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// A load as the deformation gradients of its states, and the directions of F that stay free on the path to them.
struct LoadTargets {
  std::vector<Eigen::Matrix2d> gradients;  ///< deformation gradients; free components are those without lateral strain
  FreeStrains free;                        ///< orthonormal directions, as (xx, xy, yx, yy)
};

/// Throws "simulation.invalid_load" if there are no states or too many, if a number is not finite, or if a principal
/// stretch is out of range. Each fault is named with its place in the list.
LoadTargets targets_of(const Load& load);

}  // namespace supple::microscale
