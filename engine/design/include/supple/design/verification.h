#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"

namespace supple::design {

/// How structures are simulated that prove or correct a design: as by POST /v1/simulations by default, so that a design
/// that keeps to its target here does so there. The mesh's error is extrapolated away, because it would be larger than
/// what a design may deviate, and would vary from one design to the next.
microscale::SimulationOptions verification_options(const microscale::Material& material = {});

/// Simulates the profile of a structure at its native scale: the equilibria of a periodic patch under a uniaxial load
/// along a direction of the material, each path from rest. The result has one entry for each sample, and NaN where the
/// simulation did not get there. Stress over strain takes one path on either side of rest. Stiffness and Poisson's
/// ratio take one path for each direction, and these are computed in parallel. Throws "model.invalid_load" and what
/// microscale::Simulator throws. Bills the effect "verification" and the stages of the simulations.
Eigen::VectorXd simulate_profile(const tiling::Structure& structure, const ProfileSamples& samples,
                                 const microscale::SimulationOptions& options, const Execution& execution = {});

/// A function that simulates structures of the family. The family must outlive it.
SimulateProfile simulation_of(const tiling::Family& family, const microscale::SimulationOptions& options);

/// How structures of one family are simulated.
struct FamilySimulation {
  SimulateProfile simulate;
  SimulateProfile coarser;  ///< on a coarser mesh, to estimate the discretization error; empty if it is not wanted
  /// The share of the response's change on the coarser mesh that is the estimate.
  double error_share = 1;
};

/// Both simulations by `verification_options`: extrapolated, and those of the mesh from which it is extrapolated.
FamilySimulation verification_of(const tiling::Family& family, const microscale::Material& material);

/// The root mean square of model - simulated, divided by that of `simulated`, over the samples to which the simulation
/// got. None if it got to no sample or if its values are zero.
std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model);

}  // namespace supple::design
