#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "supple/base/execution.h"
#include "weave_system.h"

namespace supple::weave {

/// A planar model's state as one of the spatial model of the same weave, anchors and segments.
struct SpatialState {
  Eigen::VectorXd q;
  Chart chart;
};
SpatialState lift(const RodModel& planar, const Eigen::VectorXd& q, const RodModel& spatial);

/// What is held of the spatial model where `held` is of the planar one: the same in the plane; out of it the gauges,
/// and whatever else the caller adds.
std::vector<bool> lift_held(const RodModel& planar, const std::vector<bool>& held, const RodModel& spatial);

/// The least stable mode out of the plane of a planar equilibrium (all degrees of freedom of the spatial model), if it
/// is unstable: the Hessian by heights, angles and tilts alone, which in the plane is decoupled from the others. One
/// spatial assembly and factorization; about thirty solves more where it is unstable.
std::optional<Eigen::VectorXd> out_of_plane_mode(const RodModel& spatial, const SpatialState& state,
                                                 const std::vector<bool>& held, const EnergyOptions& options,
                                                 const Execution& execution);

}  // namespace supple::weave
