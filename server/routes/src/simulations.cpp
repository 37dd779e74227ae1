#include <optional>

#include "computation_route.h"
#include "handlers.h"
#include "structure_spec.h"
#include "supple/json/structure_answers.h"

namespace supple::routes {
namespace {

/// Calls simulate() and makes the engine's places, "uniaxial/stretches/3" and "tolerance", places of the request.
template <class Simulate>
void with_pointers(Simulate simulate) {
  try {
    simulate();
  } catch (const Error& error) {
    std::string folder;
    if (error.code() == "simulation.invalid_load") folder = "/load/";
    if (error.code() == "simulation.invalid_option" || error.code() == "tiling.mesh_option") folder = "/accuracy/";
    if (folder.empty()) throw;
    auto details = error.details();
    for (auto& detail : details) {
      detail.where = (detail.where.starts_with("material/") ? "/" : folder) + detail.where;
    }
    throw Error(error.code(), error.what(), std::move(details));
  }
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

store::Result compute(const json::SimulationRequest& request, const tiling::Structure& structure,
                      const json::Limits& limits, const Execution& outer) {
  std::optional<microscale::Simulator> simulator;
  microscale::SimulationResult result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    with_pointers([&] {
      simulator.emplace(structure, request.options, execution);
      check_deformed(request, simulator->mesh(), limits);
      result = simulator->run(request.load, execution);
    });
  });
  return json_result(json::write_simulation(request, structure, simulator->mesh(), result, bill));
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
