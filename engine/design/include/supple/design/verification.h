#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/microscale/simulation.h"

namespace supple::design {

/// The profile of a structure by simulation at its native scale: equilibria of a periodic patch under a uniaxial load
/// along a direction of the material, each path from rest. An entry for each sample, NaN where the simulation did not
/// get there. Stress over strain is one path on either side of rest; stiffness and Poisson's ratio are one path for
/// each direction, computed in parallel. Throws "model.invalid_load" and what microscale::Simulator throws. Bills the
/// effect "verification" and the stages of the simulations.
Eigen::VectorXd simulate_profile(const tiling::Structure& structure, const ProfileSamples& samples,
                                 const microscale::SimulationOptions& options, const Execution& execution = {});

/// Root mean square of model - simulated over that of `simulated`, where the simulation got to; none where it got
/// nowhere or its values are zero.
std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model);

/// At most `count` of the samples, evenly spaced, the first (and over strain the last) among them.
ProfileSamples thinned(const ProfileSamples& samples, int count);

}  // namespace supple::design
