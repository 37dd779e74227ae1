#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "endpoint.h"
#include "handlers.h"
#include "part_spec.h"
#include "results.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/budget/memory.h"
#include "supple/json/part_simulations.h"
#include "supple/microscale/part_files.h"
#include "supple/microscale/simulation_error.h"
#include "supple/microscale/vtu.h"
#include "supple/problem/problem.h"
#include "supple/tiling/part_mesh.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

using json::PartSimulationRequest;
using microscale::PartSimulationResult;

// Fractions of the progress of a computation: the part and its mesh, and the estimate of the error.
constexpr double meshing_fraction = 0.05;
constexpr double estimate_fraction = 0.25;

/// Ratio of the size of the mesh that estimates the error to that of the part's own mesh.
constexpr double coarse_mesh_ratio = 2;
/// Number of nodes up to which the error is estimated unless the request says otherwise: that takes a minute at most.
constexpr int max_nodes_of_usual_estimate = 100'000;

/// A kind of file of a part's states: its media type, whether it shows displacements, and what writes it.
struct StatesFormat {
  std::string_view media_type;
  bool needs_displacements;
  std::string (*write)(const PartSimulationRequest&, const tiling::PeriodicMesh&, const PartSimulationResult&);
};
constexpr StatesFormat states_formats[] = {
    {"text/csv", false,
     [](const auto&, const auto&, const auto& result) { return microscale::write_part_csv(result.states); }},
    {"image/svg+xml", true,
     [](const auto&, const auto& mesh, const auto& result) {
       const std::vector<microscale::PartState> last{result.states.back()};
       return microscale::write_part_svg(mesh, last[0].displacements, microscale::picture_frame(mesh, last));
     }},
    {"model/obj", true,
     [](const auto&, const auto& mesh, const auto& result) {
       return microscale::write_part_obj(mesh, result.states.back().displacements);
     }},
    {"application/x-vtu+xml", true, [](const auto& request, const auto& mesh, const auto& result) {
       return microscale::write_part_vtu(mesh, result.states.back().displacements, request.options.material);
     }}};

/// What a computation needs.
struct PreparedPart {
  PartSimulationRequest request;
  tiling::PartDesign design;
  const StatesFormat* format = nullptr;  ///< null: JSON
  json::Limits limits;
  const budget::MemoryBudget* memory = nullptr;  ///< null: no limit
};

double finest_beam_width(const tiling::PartDesign& design) {
  double width = design.filling.beam_width;
  for (const auto& region : design.regions) width = std::min(width, region.filling.beam_width);
  return width;
}

/// Throws "simulation.invalid_load" if the part has lost a solid end that a default support would hold.
void check_ends(const PartSimulationRequest& request, const tiling::Part& part) {
  if (!request.has_default_supports || part.lost_solids.empty()) return;
  const std::string text = json::part_message(request.part, part);
  throw Error("simulation.invalid_load", "The part has lost an end that is supported by default. " + text,
              {{"/part/outline", text}});
}

/// Throws "request.limit_exceeded" or "request.too_much_memory" if the mesh would be too large.
void check_estimate(const PreparedPart& prepared, const tiling::PartMeshEstimate& estimate) {
  constexpr auto pointer = "/accuracy/mesh_size";
  const double nodes = std::round(estimate.nodes);
  if (nodes > prepared.limits.max_part_nodes)
    problem::throw_limit("request.limit_exceeded", "The number of nodes of the part's mesh, as it is estimated,",
                         prepared.limits.max_part_nodes, nodes, "", pointer);
  if (!prepared.memory) return;
  const auto max_bytes = static_cast<double>(prepared.memory->max_per_request());
  if (estimate.bytes > max_bytes)
    problem::throw_limit("request.too_much_memory",
                         "The memory in bytes that a mesh of about " + std::to_string(std::llround(nodes)) +
                             " nodes needs, as it is estimated,",
                         max_bytes, std::round(estimate.bytes), "--max-request-memory", pointer);
}

/// Throws "request.limit_exceeded" if deformed parts would be too large an answer.
void check_deformed(const PreparedPart& prepared, const tiling::PeriodicMesh& mesh) {
  const auto& options = prepared.request.options;
  const double nodes = static_cast<double>(mesh.nodes.cols()) * options.states;
  const auto max_nodes = static_cast<double>(prepared.limits.max_deformed);
  if (options.deformed_nodes && nodes > max_nodes)
    problem::throw_limit("request.limit_exceeded", "The number of nodes of deformed parts, over all states,", max_nodes,
                         nodes, "", "/states");
}

tiling::PeriodicMesh mesh_of(const PreparedPart& prepared, const tiling::Part& part, const Execution& execution) {
  return with_pointers<tiling::MeshOptionError>(PointerMap("/accuracy"), [&] {
    const double beam_width = finest_beam_width(prepared.design);
    check_estimate(prepared, tiling::estimate_part_mesh(part.faces, beam_width, prepared.request.mesh));
    execution.checkpoint(0.5, "meshing");
    const StageTimer timer(execution.cost, "meshing");
    return tiling::mesh_part(part.faces, beam_width, prepared.request.mesh, execution);
  });
}

/// Publishes intermediate states, as often as clients can see one.
class PartStatePublisher {
 public:
  PartStatePublisher(ProgressSink* sink, const PartSimulationRequest& request) : sink_(sink), request_(request) {}

  void operator()(const microscale::PartState& state) {
    const int number = ++number_;
    if (sink_ && pace_.is_due()) sink_->publish(json::write_partial_part_simulation(request_, number, state));
  }

 private:
  ProgressSink* sink_;
  const PartSimulationRequest& request_;
  int number_ = 0;
  StatePace pace_;
};

/// Supports that the request leaves to the server are no field of it.
PointerMap simulation_pointers(const PartSimulationRequest& request) {
  FieldPlace supports{.field = "supports", .pointer = "/supports"};
  if (request.has_default_supports)
    supports = {.field = "supports", .pointer = "/part/outline", .rest = FieldPlace::Rest::dropped};
  return PointerMap("/accuracy", {supports,
                                  {.field = "material", .pointer = "/material"},
                                  {.field = "states", .pointer = "/states"},
                                  {.field = "thickness", .pointer = "/part/thickness"}});
}

PartSimulationResult simulate(const PartSimulationRequest& request, const tiling::PeriodicMesh& mesh,
                              const Execution& execution) {
  return with_pointers<microscale::SimulationError>(simulation_pointers(request), [&] {
    return microscale::simulate_part(mesh, request.supports, request.options, execution,
                                     PartStatePublisher(execution.progress, request));
  });
}

/// Whether the error of the mesh is estimated, and why.
struct EstimateChoice {
  bool wanted = false;
  std::string why;
};

EstimateChoice choose_estimate(const PreparedPart& prepared, const tiling::PeriodicMesh& mesh) {
  const Switch wanted = prepared.request.error_estimate;
  if (wanted == Switch::off) return {false, "switched off by the request"};
  if (prepared.format) return {false, "the answer is a file, which does not tell it"};
  if (wanted == Switch::on) return {true, "switched on by the request"};
  const bool is_usual = mesh.nodes.cols() <= max_nodes_of_usual_estimate;
  return {is_usual, std::string("the mesh has ") + (is_usual ? "at most " : "more than ") +
                        std::to_string(max_nodes_of_usual_estimate) + " nodes"};
}

/// The same path on a coarser mesh; none if there is no such mesh, or if the supports do not fit it.
std::optional<PartSimulationResult> simulate_coarsely(const PreparedPart& prepared, const tiling::Part& part,
                                                      const Execution& execution) {
  PartSimulationRequest request = prepared.request;
  request.options.deformed_nodes = false;
  request.mesh.mesh_size *= coarse_mesh_ratio;
  try {
    const auto mesh = tiling::mesh_part(part.faces, finest_beam_width(prepared.design), request.mesh, execution);
    return microscale::simulate_part(mesh, request.supports, request.options, execution);
  } catch (const microscale::InvalidLoad&) {
    return std::nullopt;  // a box that holds points of the part's mesh may hold too few of a coarser one
  } catch (const tiling::TilingError&) {
    return std::nullopt;
  }
}

/// Estimates the error of the mesh if that is wanted, and bills the effect.
std::optional<microscale::PartMeshError> estimate_error(const PreparedPart& prepared, const tiling::Part& part,
                                                        const PartSimulationResult& result, EstimateChoice choice,
                                                        const Execution& execution) {
  std::optional<microscale::PartMeshError> error;
  const auto start = std::chrono::steady_clock::now();
  if (choice.wanted) {
    // Its stages are those of the effect, and not of the simulation.
    const auto coarse = simulate_coarsely(prepared, part, {execution.cancellation, execution.progress, nullptr});
    if (coarse) error = microscale::part_mesh_error(result, *coarse);
    if (!coarse) choice.why = "there is no coarser mesh that the supports fit";
  }
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  if (execution.cost)
    execution.cost->add_effect("error_estimate", choice.wanted, choice.why, choice.wanted ? 1 : 0,
                               choice.wanted ? duration.count() : 0);
  return error;
}

store::Result compute(const PreparedPart& prepared, const Execution& outer) {
  tiling::Part part;
  tiling::PeriodicMesh mesh;
  PartSimulationResult result;
  std::optional<microscale::PartMeshError> error;
  std::string file;
  const auto bill = billed(outer, [&](const Execution& execution) {
    {
      const PartOfExecution beginning(execution, 0, meshing_fraction);
      part = make_part_billed(prepared.design, "/part", beginning.execution());
      check_ends(prepared.request, part);
      mesh = mesh_of(prepared, part, beginning.execution());
      check_deformed(prepared, mesh);
    }
    const auto choice = choose_estimate(prepared, mesh);
    const double end = choice.wanted ? 1 - estimate_fraction : 1;
    const PartOfExecution following(execution, meshing_fraction, end - meshing_fraction);
    result = simulate(prepared.request, mesh, following.execution());
    const PartOfExecution estimating(execution, end, 1 - end);
    error = estimate_error(prepared, part, result, choice, estimating.execution());
    if (!prepared.format) return;
    execution.checkpoint(1, "export");
    const StageTimer timer(execution.cost, "export");
    file = prepared.format->write(prepared.request, mesh, result);
  });
  if (!prepared.format)
    return json_result(json::write_part_simulation(prepared.request, {part, mesh, result, error}, bill));
  auto answer = file_result(prepared.format->media_type, std::move(file), bill);
  answer.headers.emplace_back("Supple-Stopped", microscale::to_string(result.states.back().stopped));
  if (!result.message.empty()) answer.headers.emplace_back("Supple-Message", result.message);
  return answer;
}

PreparedComputation prepare_part_simulation(const EndpointRequest& asked, const Loader& loader) {
  auto prepared = std::make_shared<PreparedPart>();
  prepared->request = json::parse_part_simulation(asked.body, loader.limits(), loader.cancellation());
  prepared->design = part_design(prepared->request.part, loader, "/part");
  prepared->format = file_of(states_formats, asked.format);
  prepared->limits = loader.limits();
  prepared->memory = loader.memory();
  if (prepared->format && prepared->format->needs_displacements) prepared->request.options.deformed_nodes = true;
  return {.deadline = prepared->request.deadline,
          .run = [prepared = std::shared_ptr<const PreparedPart>(std::move(prepared))](const Execution& execution) {
            return compute(*prepared, execution);
          }};
}

}  // namespace

void add_part_simulation_route(http::Router& router, Services& services) {
  add_endpoint(router, services,
               {.kind = "part-simulations",
                .sends = "The simulation of a part is sent as",
                .formats = json_or(states_formats),
                .prepare = prepare_part_simulation});
}

}  // namespace supple::routes
