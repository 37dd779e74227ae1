#pragma once

#include <optional>

#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// The default mesh for extrapolation. Sides have the length of a beam width, and of a twentieth of that at corners.
/// The extrapolated stress has an error of less than half a per cent, in a median of one and a half times the time of
/// the data sets' mesh (see docs/bench/simulations.md). With longer sides, the error of some designs is
/// larger. With shorter ones, the time grows faster than the error decreases.
tiling::MeshOptions extrapolated_mesh();

/// Options for simulations whose results are to be accurate rather than comparable with a data set. States are
/// extrapolated from `extrapolated_mesh`.
SimulationOptions accurate_options(const Material& material = {});

/// The ratio of the estimated error of an extrapolated response to its difference from the response of the mesh itself.
double extrapolation_error_ratio();

/// A simulation and the options of its mesh.
struct AccurateSimulation {
  Simulator simulator;
  SimulationResult result;
  tiling::MeshOptions mesh;
};

/// Simulates on meshes that become finer until the estimated error of the stress, `discretization_error`, is at most
/// `max_error` (relative, > 0), or until no finer mesh is possible. Then the last result is returned with its larger
/// estimate. `options` gives everything but the size and the grading of the mesh; its refinement must not be off.
///
/// The first mesh is one that usually suffices. Takes one simulation for each mesh, each of which has more nodes than
/// the one before. Throws what Simulator throws.
AccurateSimulation simulate_within(const tiling::Structure& structure, const Load& load,
                                   const SimulationOptions& options, double max_error, const Execution& execution = {});

}  // namespace supple::microscale
