#include "supple/microscale/accurate_simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/error.h"

namespace supple::microscale {
namespace {

/// The estimated error of `extrapolated_mesh` at the median, and how fast errors fall with the size of the mesh. They
/// only choose the first mesh and how much finer the next one is.
constexpr double usual_error = 0.003;
constexpr double rate = 1.7;
/// A next mesh aims at this share of the accepted error.
constexpr double aimed_share = 0.7;

/// Sizes over the beam width. Coarser ones leave one element across a beam, and finer ones take minutes.
constexpr double coarsest = 1.4;
constexpr double finest = 0.1;
/// From one mesh to the next.
constexpr double least_refinement = 0.8;
constexpr double most_refinement = 0.4;
constexpr int most_meshes = 5;

/// The size at which an error becomes another one.
double size_for(double size, double error, double wanted) { return size * std::pow(wanted / error, 1 / rate); }

}  // namespace

tiling::MeshOptions extrapolated_mesh() {
  tiling::MeshOptions mesh;
  mesh.mesh_size = 0.9;
  mesh.corner_size = 0.05;
  return mesh;
}

SimulationOptions accurate_options(const Material& material) {
  SimulationOptions options;
  options.material = material;
  options.mesh = extrapolated_mesh();
  options.refinement = Refinement::extrapolated;
  return options;
}

AccurateSimulation simulate_within(const tiling::Structure& structure, const Load& load,
                                   const SimulationOptions& options, double accepted, const Execution& execution) {
  SimulationOptions attempt = options;
  const tiling::MeshOptions usual = extrapolated_mesh();
  attempt.mesh.corner_size = usual.corner_size;
  attempt.mesh.mesh_size = std::clamp(size_for(usual.mesh_size, usual_error, accepted), finest, coarsest);
  std::optional<AccurateSimulation> best;
  for (int k = 0; k < most_meshes; ++k) {
    try {
      Simulator simulator(structure, attempt, execution);
      SimulationResult result = simulator.run(load, execution);
      best.emplace(AccurateSimulation{std::move(simulator), std::move(result), attempt.mesh});
    } catch (const Error& error) {
      // A finer mesh than the limit allows: what was found before stands.
      if (!best || error.code() != "tiling.mesh_too_large") throw;
      break;
    }
    const auto error = discretization_error(best->result.states);
    if (!error || error->stress <= accepted || attempt.mesh.mesh_size <= finest) break;
    const double size = attempt.mesh.mesh_size;
    attempt.mesh.mesh_size = std::max(finest, std::clamp(size_for(size, error->stress, aimed_share * accepted),
                                                         most_refinement * size, least_refinement * size));
  }
  return std::move(*best);
}

}  // namespace supple::microscale
