#pragma once

#include <optional>

#include "supple/microscale/part_simulation.h"

namespace supple::microscale {

/// The estimated errors that the mesh makes along the path of a part, relative, as root mean squares over its states.
struct PartMeshError {
  double force = 0;   ///< error of the supports' forces over the forces
  double energy = 0;  ///< error of the energy over the energy
};

/// Estimates the errors of `result` by its difference from `coarse`, the same path on a mesh of twice the size. Where
/// halving the triangles divides the error by 2.8, as in periodic simulations (docs/bench/simulations.md), 0.55 of the
/// difference is left. The difference itself is therefore mostly an upper bound. Only states that converged count. None
/// if no state converged, if the coarse path did not converge in all of these, or if only the coarse part has forces.
std::optional<PartMeshError> part_mesh_error(const PartSimulationResult& result, const PartSimulationResult& coarse);

}  // namespace supple::microscale
