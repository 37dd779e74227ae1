#pragma once

#include <Eigen/Core>
#include <vector>

#include "part_supports.h"

namespace supple::microscale {

/// What the supports exert at an equilibrium x. `gradient` is that of the energy with respect to all degrees of
/// freedom, MPa mm: where a support holds a displacement, it is the support's force per mm of thickness. Forces are
/// those of `thickness` (mm), and the pressure of a plate is averaged over intervals of `pressure_length` (mm).
std::vector<SupportState> support_states(const PartSupports& supports, const Constraints& constraints,
                                         const Eigen::VectorXd& x, const Eigen::VectorXd& gradient, double fraction,
                                         double thickness, double pressure_length);

}  // namespace supple::microscale
