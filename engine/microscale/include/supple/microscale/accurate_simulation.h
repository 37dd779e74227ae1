#pragma once

#include <optional>

#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// The mesh whose states are extrapolated unless a caller wants another one: sides of a beam width, and of a twentieth
/// of that at corners. Extrapolated from it, stress errs by less than half a per cent, in about one and a half times
/// the time of the data sets' mesh at the median (see docs/bench/simulations-discretization.md). With longer sides
/// single designs err by more than that, and with shorter ones the time grows faster than the error falls.
tiling::MeshOptions extrapolated_mesh();

/// Options for simulations whose results are meant to be true, rather than comparable with a data set:
/// `extrapolated_mesh`, extrapolated.
SimulationOptions accurate_options(const Material& material = {});

/// The estimated error of an extrapolated response over how much it differs from that of the mesh itself.
double extrapolation_error_share();

/// A simulation and the mesh that it was made on.
struct AccurateSimulation {
  Simulator simulator;
  SimulationResult result;
  tiling::MeshOptions mesh;
};

/// Simulates on meshes that become finer until the estimated error of the stress, `discretization_error`, is at most
/// `accepted` (relative, > 0), or until no finer mesh is possible: then the last result stands, and its estimate says
/// so. `options` gives everything but the size and the grading of the mesh; its refinement must not be off.
///
/// The first mesh is that which usually suffices. Costs as many simulations as meshes are needed, of which each has
/// more nodes than the one before. Throws what Simulator throws.
AccurateSimulation simulate_within(const tiling::Structure& structure, const Load& load,
                                   const SimulationOptions& options, double accepted, const Execution& execution = {});

}  // namespace supple::microscale
