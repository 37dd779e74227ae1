#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"
#include "supple/tiling/mesh.h"

namespace supple::design {

/// How finely structures of a family are meshed that prove or correct a design.
struct VerificationMeshes {
  /// This mesh is finer than that of the family's data set, whose stresses are a per cent or two too large and vary by
  /// a tenth of that from one design to the next. That is more than a design should deviate. Where beams are slender,
  /// longer triangles are as good: IH21 and IH28 have twice the size of the others.
  tiling::MeshOptions mesh;
  /// This mesh is so much coarser that errors about double or more. If the response differs by d between the two
  /// meshes, the finer one errs by less than d (in 62 of 63 designs and tasks, docs/bench/designs-discretization.md).
  tiling::MeshOptions coarser;
};
VerificationMeshes verification_meshes(std::string_view family);

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
};

/// Both simulations, on the family's verification meshes.
FamilySimulation verification_of(const tiling::Family& family, const microscale::Material& material);

/// The root mean square of model - simulated, divided by that of `simulated`, over the samples to which the simulation
/// got. None if it got to no sample or if its values are zero.
std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model);

}  // namespace supple::design
