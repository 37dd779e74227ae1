#include "supple/microscale/accurate_simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::microscale {
namespace {

// The following three numbers only determine the sizes of meshes.

/// Median of the estimated relative error of `extrapolated_mesh`.
constexpr double typical_error = 0.003;
/// Power of the mesh size to which errors are proportional.
constexpr double convergence_rate = 1.7;
/// The error for which the next mesh is sized, as a fraction of the largest accepted error.
constexpr double target_fraction = 0.7;

/// Limits of the mesh size, in beam widths. Coarser meshes have one element across a beam, and finer ones take minutes.
constexpr double max_size = 1.4;
constexpr double min_size = 0.1;
/// Limits of the ratio of the next mesh's size to the last one's.
constexpr double max_size_ratio = 0.8;
constexpr double min_size_ratio = 0.4;
constexpr int max_meshes = 5;

/// If the first mesh has too many nodes, the size is multiplied by this factor.
constexpr double coarsening_factor = 1.4;

/// Meshes the structure. Returns none if the mesh with every triangle divided in four would have more nodes than the
/// limit, and throws "tiling.mesh_too_large" if that is so for the coarsest mesh already.
std::optional<tiling::PeriodicMesh> mesh_if_refinable(const tiling::Structure& structure, tiling::MeshOptions options,
                                                      const Execution& execution) {
  const StageTimer timer(execution.cost, "meshing");
  options.max_nodes = std::max(1, options.max_nodes / 4);
  try {
    return tiling::mesh_structure(structure, options, execution);
  } catch (const tiling::MeshTooLarge&) {
    if (options.mesh_size > max_size) throw;
    return std::nullopt;
  }
}

/// The mesh size at which the error is `target`, if it is `error` at `size`.
double size_for(double size, double error, double target) {
  return size * std::pow(target / error, 1 / convergence_rate);
}

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
                                   const SimulationOptions& options, double max_error, const Execution& execution) {
  SimulationOptions attempt = options;
  const tiling::MeshOptions standard = extrapolated_mesh();
  attempt.mesh.corner_size = standard.corner_size;
  attempt.mesh.mesh_size = std::clamp(size_for(standard.mesh_size, typical_error, max_error), min_size, max_size);
  std::optional<AccurateSimulation> best;
  bool finer_fits = true;
  for (int k = 0; k < max_meshes || !best; ++k) {
    std::optional<tiling::PeriodicMesh> mesh = mesh_if_refinable(structure, attempt.mesh, execution);
    const double size = attempt.mesh.mesh_size;
    if (!mesh) {
      // The last result is returned. If there is none, the finest mesh within the limit of nodes is used.
      if (best) break;
      finer_fits = false;
      attempt.mesh.mesh_size = size * coarsening_factor;
      continue;
    }
    Simulator simulator(std::move(*mesh), attempt, execution);
    SimulationResult result = simulator.run(load, execution);
    best.emplace(AccurateSimulation{std::move(simulator), std::move(result), attempt.mesh});
    const auto error = discretization_error(best->result.states);
    if (!error || error->stress <= max_error || size <= min_size || !finer_fits) break;
    attempt.mesh.mesh_size = std::max(min_size, std::clamp(size_for(size, error->stress, target_fraction * max_error),
                                                           min_size_ratio * size, max_size_ratio * size));
  }
  return std::move(*best);
}

}  // namespace supple::microscale
