#include <algorithm>
#include <limits>
#include <memory>

#include "answer_parts.h"
#include "supple/json/structure_answers.h"
#include "supple/microscale/unwrapped_mesh.h"
#include "supple/microscale/vtu.h"

namespace supple::json {
namespace {

using microscale::State;

/// The meshes of the patches of a path's states: one cell, and then perhaps 2 x 2.
class Patches {
 public:
  struct Patch {
    std::shared_ptr<const tiling::PeriodicMesh> mesh;
    microscale::UnwrappedMesh unwrapped;
    int cells = 1;
  };

  explicit Patches(const std::vector<State>& states) {
    for (const auto& state : states) {
      if (!state.deformed || find(state) < patches_.size()) continue;
      patches_.push_back({state.deformed->mesh, microscale::unwrap(*state.deformed->mesh), state.cells});
    }
  }

  /// Index of the state's patch; the number of patches where it has none.
  std::size_t find(const State& state) const {
    const auto found = std::find_if(patches_.begin(), patches_.end(),
                                    [&](const Patch& patch) { return patch.mesh == state.deformed->mesh; });
    return static_cast<std::size_t>(found - patches_.begin());
  }
  const std::vector<Patch>& all() const { return patches_; }

 private:
  std::vector<Patch> patches_;
};

void write_columns(JsonWriter& out, std::string_view name, const Eigen::Matrix2Xd& columns) {
  out.key(name);
  write_rows(out, columns.transpose().eval());
}

void write_deformed(JsonWriter& out, const SimulationRequest& request, const State& state, const Patches& patches) {
  if (!state.deformed) return;
  const auto index = patches.find(state);
  const auto& unwrapped = patches.all()[index].unwrapped;
  if (request.deformed == Deformed::vtu) {
    out.field("vtu", microscale::write_vtu(unwrapped, *state.deformed, request.options.material));
    return;
  }
  out.key("deformed").begin_object().field("mesh", index);
  write_columns(out, "lattice", state.deformed->lattice);
  write_columns(out, "points", microscale::positions(unwrapped, state.deformed->lattice, state.deformed->nodes));
  out.end_object();
}

void write_state(JsonWriter& out, const SimulationRequest& request, const State& state, const Patches& patches) {
  out.begin_object().key("green_strain").numbers(state.green_strain).key("stress").numbers(state.stress);
  const auto& error = state.mesh_error;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  write_number_or_null(out, "stress_error", error ? error->stress : none);
  out.field("energy_density", state.energy_density);
  write_number_or_null(out, "energy_density_error", error ? error->energy_density : none);
  out.key("tangent");
  if (state.tangent.allFinite()) {
    write_rows(out, state.tangent);
  } else {
    out.null();
  }
  out.key("deformation_gradient");
  write_rows(out, state.deformation_gradient);
  out.field("stopped", microscale::to_string(state.stopped));
  write_number_or_null(out, "residual", state.residual);
  out.field("iterations", state.iterations).field("load_steps", state.load_steps).field("contacts", state.contacts);
  write_number_or_null(out, "smallest_gap", state.smallest_gap);
  out.field("smallest_jacobian", state.smallest_jacobian)
      .field("stable", state.stable)
      .field("branch", state.branch)
      .field("cells", state.cells);
  write_deformed(out, request, state, patches);
  out.end_object();
}

void write_meshes(JsonWriter& out, const Patches& patches) {
  out.key("meshes").begin_array();
  for (const auto& patch : patches.all()) {
    out.begin_object().field("cells", patch.cells);
    write_columns(out, "lattice", patch.mesh->lattice);
    write_columns(out, "points", microscale::positions(patch.unwrapped, patch.mesh->lattice, patch.mesh->nodes));
    out.key("triangles").begin_array();
    for (const auto& triangle : patch.unwrapped.triangles) {
      out.begin_array();
      for (const int point : triangle) out.integer(point);
      out.end_array();
    }
    out.end_array().end_object();
  }
  out.end_array();
}

void write_accuracy(JsonWriter& out, const SimulationRequest& request, const tiling::PeriodicMesh& cell,
                    const microscale::SimulationResult& result) {
  double residual = 0;
  for (const auto& state : result.states) {
    // Unlike std::max, this keeps a value that is not a number.
    if (!(state.residual <= residual)) residual = state.residual;
  }
  out.key("accuracy").begin_object().field("tolerance", request.options.tolerance);
  write_number_or_null(out, "residual", residual);
  const auto error = microscale::discretization_error(result.states);
  out.key("discretization_error");
  if (error) {
    out.begin_object().field("stress", error->stress).field("energy", error->energy_density).end_object();
  } else {
    out.null();
  }
  out.key("accepted_error");
  request.accepted_error ? out.number(*request.accepted_error) : out.null();
  out.key("error_accepted");
  request.accepted_error ? out.boolean(error && error->stress <= *request.accepted_error) : out.null();
  out.field("extrapolated", result.extrapolated);
  out.field("mesh_size", request.options.mesh.mesh_size)
      .field("corner_size", request.options.mesh.corner_size)
      .field("nodes", result.nodes)
      .field("triangles", cell.triangles.size())
      .field("unknowns", result.unknowns)
      .end_object();
}

}  // namespace

std::string write_simulation(const SimulationRequest& request, const tiling::Structure& structure,
                             const tiling::PeriodicMesh& cell, const microscale::SimulationResult& result,
                             const Bill& bill) {
  const Patches patches(result.states);
  JsonWriter out;
  out.begin_object().field("family", structure.family).key("parameters").numbers(structure.parameters);
  out.key("states").begin_array();
  for (const auto& state : result.states) write_state(out, request, state, patches);
  out.end_array().field("message", result.message);
  if (request.deformed == Deformed::json) write_meshes(out, patches);
  write_accuracy(out, request, cell, result);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
