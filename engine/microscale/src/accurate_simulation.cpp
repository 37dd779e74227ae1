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
/// The next mesh has sides between these two multiples of the last one's.
constexpr double largest_next_size = 0.8;
constexpr double smallest_next_size = 0.4;
constexpr int max_meshes = 5;

/// Where a first mesh is too large, the next one has sides this many times as long.
constexpr double coarser = 1.4;

/// The mesh, if the one with every triangle divided in four keeps to the limit of nodes too. Throws the limit's error
/// if even the coarsest mesh is too large.
std::optional<tiling::PeriodicMesh> mesh_with_room(const tiling::Structure& structure, tiling::MeshOptions options,
                                                   const Execution& execution) {
  const StageTimer timer(execution.cost, "meshing");
  options.max_nodes = std::max(1, options.max_nodes / 4);
  try {
    return tiling::mesh_structure(structure, options, execution);
  } catch (const Error& error) {
    if (error.code() != "tiling.mesh_too_large" || options.mesh_size > coarsest) throw;
    return std::nullopt;
  }
}

/// The size at which an error becomes another one.
double size_for(double size, double error, double wanted) { return size * std::pow(wanted / error, 1 / rate); }

}  // namespace

tiling::MeshOptions extrapolated_mesh() {
  tiling::MeshOptions mesh;
  mesh.mesh_size = 1.0;
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
  bool finer_fits = true;
  for (int k = 0; k < max_meshes || !best; ++k) {
    std::optional<tiling::PeriodicMesh> mesh = mesh_with_room(structure, attempt.mesh, execution);
    const double size = attempt.mesh.mesh_size;
    if (!mesh) {
      // What was found before stands; without that, a coarser mesh is the best that fits.
      if (best) break;
      finer_fits = false;
      attempt.mesh.mesh_size = size * coarser;
      continue;
    }
    Simulator simulator(std::move(*mesh), attempt, execution);
    SimulationResult result = simulator.run(load, execution);
    best.emplace(AccurateSimulation{std::move(simulator), std::move(result), attempt.mesh});
    const auto error = discretization_error(best->result.states);
    if (!error || error->stress <= accepted || size <= finest || !finer_fits) break;
    attempt.mesh.mesh_size = std::max(finest, std::clamp(size_for(size, error->stress, aimed_share * accepted),
                                                         smallest_next_size * size, largest_next_size * size));
  }
  return std::move(*best);
}

}  // namespace supple::microscale
