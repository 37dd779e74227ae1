#pragma once

#include <vector>

#include "cell_system.h"
#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// A load as deformation gradients to reach and the directions of F that stay free on the way.
struct LoadTargets {
  std::vector<Eigen::Matrix2d> gradients;  ///< free components as they would be without lateral strain
  FreeStrains free;                        ///< orthonormal, as (xx, xy, yx, yy)
};

/// Throws "simulation.invalid_load": no states, too many, numbers that are not finite, stretches or strains for which F
/// is singular or beyond the named limits, each with its place in the list.
LoadTargets targets_of(const Load& load);

}  // namespace supple::microscale
