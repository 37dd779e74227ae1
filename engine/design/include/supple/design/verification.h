#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/beam_width_sensitivity.h"
#include "supple/design/profile.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"

namespace supple::design {

/// Options of the simulations that verify or correct a design. They are the defaults of POST /v1/simulations, so that a
/// design that keeps to its target here does so there. The discretization error is extrapolated away. Without
/// extrapolation it would be larger than the allowed deviation of a design, and would vary from one design to the next.
microscale::SimulationOptions verification_options(const microscale::Material& material = {});

/// Simulates the profile of a structure at its native scale: the equilibria of a periodic patch under a uniaxial load
/// along a direction of the material, each path from rest. The result has one entry for each sample, and NaN at samples
/// that the simulation does not reach. Stress over strain takes one path in tension and one in compression. Stiffness
/// and Poisson's ratio take one path for each direction. Paths are computed in parallel. Throws "model.invalid_load"
/// and what microscale::Simulator throws. Bills the effect "verification" and the stages of the simulations.
Eigen::VectorXd simulate_profile(const tiling::Structure& structure, const ProfileSamples& samples,
                                 const microscale::SimulationOptions& options, const Execution& execution = {});

/// Simulates structures of the family.
SimulateProfile simulation_of(const tiling::Family& family, const microscale::SimulationOptions& options);

/// The simulations of one family's structures.
struct FamilySimulation {
  SimulateProfile simulate;
  /// On a coarser mesh, to estimate the discretization error; empty if no estimate is wanted.
  SimulateProfile coarser;
  /// Estimated discretization error, divided by the difference of the two simulations.
  double error_ratio = 1;
  RestTangent rest_tangent{};  ///< of structures with other beams; empty if their sensitivity is not wanted
};

/// The tangent at rest of the family's structures, on the mesh of the data sets, whose error hardly changes with the
/// beam width. A call takes some tens of milliseconds.
RestTangent rest_tangent_of(const tiling::Family& family, const microscale::Material& material);

/// The simulation with `verification_options`, which extrapolates, and the one on the mesh from which it extrapolates.
FamilySimulation verification_of(const tiling::Family& family, const microscale::Material& material);

/// The root mean square of model - simulated, divided by that of `simulated`, over the samples that the simulation
/// reaches. None if it reaches no sample or if its values are zero.
std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model);

}  // namespace supple::design
