#pragma once

#include "fields.h"
#include "supple/microscale/material.h"
#include "supple/tiling/mesh.h"

// What requests of simulations, of cells and of parts, have in common.
namespace supple::json {

/// The field "material".
void read_material(Fields& fields, microscale::Material& material);

/// The fields "mesh_size" and "corner_size".
void read_mesh_sizes(Fields& fields, tiling::MeshOptions& mesh);

/// The fields "tolerance", "max_iterations" and "max_load_step" of the accuracy. `Options` are those of a simulation.
template <class Options>
void read_path_accuracy(Fields& accuracy, Options& options) {
  accuracy.number("tolerance", options.tolerance, 1e-12, 1e-2);
  accuracy.integer("max_iterations", options.max_iterations, 1, 10'000);
  accuracy.number("max_load_step", options.max_load_step, 1e-5, 10);
}

}  // namespace supple::json
