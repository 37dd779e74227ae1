#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "supple/base/execution.h"
#include "weave_system.h"

namespace supple::weave {

/// The state of a spatial model, and the conversion of a planar model's state to it. Both models are of the same weave
/// with the same anchors and segments.
struct SpatialState {
  Eigen::VectorXd q;
  Chart chart;
};
SpatialState lift(const RodModel& planar, const Eigen::VectorXd& q, const RodModel& spatial);

/// The fixed degrees of freedom of the spatial model, where `fixed` are those of the planar one: the same in the plane,
/// and the gauges out of it. The caller may add others.
std::vector<bool> lift_fixed(const RodModel& planar, const std::vector<bool>& fixed, const RodModel& spatial);

/// The least stable mode out of the plane of a planar equilibrium, in all degrees of freedom of the spatial model;
/// nothing if the equilibrium is stable against all such modes. It comes from the Hessian by heights, edge angles and
/// tilts of joints, which at a planar state is decoupled from the other degrees of freedom. Takes one spatial assembly
/// and factorization, and about thirty solves more if the equilibrium is unstable.
std::optional<Eigen::VectorXd> out_of_plane_mode(const RodModel& spatial, const SpatialState& state,
                                                 const std::vector<bool>& fixed, const EnergyOptions& options,
                                                 const Execution& execution);

}  // namespace supple::weave
