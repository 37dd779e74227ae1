#include <optional>
#include <utility>

#include "computation_route.h"
#include "handlers.h"
#include "structure_spec.h"
#include "supple/json/structure_answers.h"
#include "supple/microscale/accurate_simulation.h"

namespace supple::routes {
namespace {

microscale::SimulationResult run(microscale::Simulator& simulator, const microscale::Load& load,
                                 const Execution& execution) {
  try {
    return simulator.run(load, execution);
  } catch (const Error& error) {
    if (error.code() != "simulation.invalid_load") throw;
    throw moved(error, "/load/");
  }
}

/// Meshes the structure. The ranges of the request's options are those of the engine, so that none is refused here.
microscale::Simulator make_simulator(const json::SimulationRequest& request, const tiling::Structure& structure,
                                     const Execution& execution) {
  return with_mesh_pointers("/accuracy/", [&] { return microscale::Simulator(structure, request.options, execution); });
}

/// Throws "request.limit_exceeded" where the deformed meshes would be too large an answer.
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

/// What a request is answered with: the simulator keeps the mesh.
struct Outcome {
  std::optional<microscale::Simulator> simulator;
  microscale::SimulationResult result;
};

/// On the mesh of the request, or on the server's.
Outcome on_one_mesh(const json::SimulationRequest& request, const tiling::Structure& structure,
                    const json::Limits& limits, const Execution& execution) {
  Outcome outcome;
  outcome.simulator = make_simulator(request, structure, execution);
  check_deformed(request, outcome.simulator->mesh(), limits);
  outcome.result = run(*outcome.simulator, request.load, execution);
  return outcome;
}

/// On meshes that become finer until the error is that which the request accepts. `request` is told of the last one.
Outcome within_error(json::SimulationRequest& request, const tiling::Structure& structure, const json::Limits& limits,
                     const Execution& execution) {
  try {
    auto found =
        microscale::simulate_within(structure, request.load, request.options, *request.accepted_error, execution);
    request.options.mesh = found.mesh;
    check_deformed(request, found.simulator.mesh(), limits);
    return {std::move(found.simulator), std::move(found.result)};
  } catch (const Error& error) {
    if (error.code() != "simulation.invalid_load") throw;
    throw moved(error, "/load/");
  }
}

store::Result compute(json::SimulationRequest request, const tiling::Structure& structure, const json::Limits& limits,
                      const Execution& outer) {
  Outcome outcome;
  const bool seeks = request.accepted_error && !request.mesh_given;
  const auto bill = billed(outer, [&](const Execution& execution) {
    outcome = seeks ? within_error(request, structure, limits, execution)
                    : on_one_mesh(request, structure, limits, execution);
  });
  return json_result(json::write_simulation(request, structure, outcome.simulator->mesh(), outcome.result, bill));
}

}  // namespace

void add_simulation_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    auto request = json::parse_simulation(json_body(http_request), services.limits.json);
    auto structure = make_structure(request.structure);
    jobs::Computation computation{"simulations", {}, request.deadline, {}};
    computation.run = [request = std::move(request), structure = std::move(structure), limits = services.limits.json](
                          const Execution& execution) { return compute(request, structure, limits, execution); };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/simulations", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
