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
  /// Finer than its data set's mesh, whose stresses are a per cent or two too large and shake by a tenth of that from
  /// one design to the next, more than a design is to deviate. Where beams are slender, longer triangles are as good:
  /// IH21 and IH28 have twice the size of the others.
  tiling::MeshOptions mesh;
  /// So much coarser that errors about double or more: a response that differs by d between the two errs by less than
  /// d on the finer one (62 of 63 designs and tasks, docs/bench/designs-discretization.md).
  tiling::MeshOptions coarser;
};
VerificationMeshes verification_meshes(std::string_view family);

/// The profile of a structure by simulation at its native scale: equilibria of a periodic patch under a uniaxial load
/// along a direction of the material, each path from rest. An entry for each sample, NaN where the simulation did not
/// get there. Stress over strain is one path on either side of rest; stiffness and Poisson's ratio are one path for
/// each direction, computed in parallel. Throws "model.invalid_load" and what microscale::Simulator throws. Bills the
/// effect "verification" and the stages of the simulations.
Eigen::VectorXd simulate_profile(const tiling::Structure& structure, const ProfileSamples& samples,
                                 const microscale::SimulationOptions& options, const Execution& execution = {});

/// Simulates structures of the family. The family outlives it.
SimulateProfile simulation_of(const tiling::Family& family, const microscale::SimulationOptions& options);

/// How structures of one family are simulated.
struct FamilySimulation {
  SimulateProfile simulate;
  SimulateProfile coarser;  ///< on a coarser mesh, to estimate the discretization error; empty: nobody asks
};

/// Both on the family's verification meshes.
FamilySimulation verification_of(const tiling::Family& family, const microscale::Material& material);

/// Root mean square of model - simulated over that of `simulated`, where the simulation got to; none where it got
/// nowhere or its values are zero.
std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model);

}  // namespace supple::design
