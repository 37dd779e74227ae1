#include <optional>
#include <utility>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "structure_spec.h"
#include "supple/json/structure_answers.h"
#include "supple/microscale/accurate_simulation.h"
#include "supple/microscale/simulation_error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

/// Throws "request.limit_exceeded" if the deformed meshes would be too large an answer.
void check_deformed(const json::SimulationRequest& request, const tiling::PeriodicMesh& cell,
                    const json::Limits& limits) {
  if (request.deformed == json::Deformed::none) return;
  const auto cells = request.options.patch == microscale::Switch::off ? 1.0 : 4.0;
  const double nodes = cells * static_cast<double>(cell.nodes.cols()) * microscale::size(request.load);
  if (nodes > static_cast<double>(limits.max_deformed)) {
    problem::throw_limit("request.limit_exceeded", "The number of nodes of deformed meshes, over all states,",
                         static_cast<double>(limits.max_deformed), nodes, "", "/deformed");
  }
}

/// What a request is answered with. The simulator owns the mesh.
struct Outcome {
  std::optional<microscale::Simulator> simulator;
  microscale::SimulationResult result;
};

/// Simulates on the mesh of the request, or on the default mesh.
Outcome on_one_mesh(const json::SimulationRequest& request, const tiling::Structure& structure,
                    const json::Limits& limits, const Execution& execution) {
  Outcome outcome{microscale::Simulator(structure, request.options, execution), {}};
  check_deformed(request, outcome.simulator->mesh(), limits);
  outcome.result = outcome.simulator->run(request.load, execution);
  return outcome;
}

/// Simulates on finer and finer meshes until the error is one that the request accepts. The last mesh becomes that of
/// the request.
Outcome within_error(json::SimulationRequest& request, const tiling::Structure& structure, const json::Limits& limits,
                     const Execution& execution) {
  auto found =
      microscale::simulate_within(structure, request.load, request.options, *request.accepted_error, execution);
  request.options.mesh = found.mesh;
  check_deformed(request, found.simulator.mesh(), limits);
  return {std::move(found.simulator), std::move(found.result)};
}

store::Result compute(json::SimulationRequest request, const tiling::Structure& structure, const json::Limits& limits,
                      const Execution& outer) {
  Outcome outcome;
  const bool seeks = request.accepted_error && !request.mesh_given;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto run_on_meshes = [&] {
      return seeks ? within_error(request, structure, limits, execution)
                   : on_one_mesh(request, structure, limits, execution);
    };
    outcome = with_pointers<microscale::InvalidLoad>(PointerMap("/load"), [&] {
      return with_pointers<tiling::MeshOptionError>(PointerMap("/accuracy"), run_on_meshes);
    });
  });
  return json_result(json::write_simulation(request, structure, outcome.simulator->mesh(), outcome.result, bill));
}

PreparedComputation prepare_simulation(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_simulation(asked.body, loader.limits(), loader.cancellation());
  auto structure = make_structure(request.structure, loader, PointerMap(""));
  return {.deadline = request.deadline,
          .run = [request = std::move(request), structure = std::move(structure), limits = loader.limits()](
                     const Execution& execution) { return compute(request, structure, limits, execution); }};
}

}  // namespace

void add_simulation_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "simulations", .prepare = prepare_simulation});
}

}  // namespace supple::routes
