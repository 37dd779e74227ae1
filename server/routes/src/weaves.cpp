#include <memory>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/base/part_of_execution.h"
#include "supple/weave/drawing.h"
#include "supple/weave/layout_warnings.h"
#include "supple/weave/weave_error.h"
#include "weave_spec.h"

namespace supple::routes {
namespace {

using weave::Weave;

/// The weave of a request, billed as the stage "layout".
Weave lay_out_billed(const json::WeaveSpec& spec, const Execution& execution) {
  execution.checkpoint(0, "layout");
  const StageTimer timer(execution.cost, "layout");
  return make_weave(spec, execution);
}

/// The weave of a request, as the beginning of a computation that takes much longer.
Weave lay_out_first(const json::WeaveSpec& spec, const Execution& execution) {
  constexpr double fraction = 0.02;  // of the progress
  const PartOfExecution part(execution, 0, fraction);
  return lay_out_billed(spec, part.execution());
}

/// The periodic weave of a request, as the beginning of a longer computation. Throws "weave.not_periodic".
Weave lay_out_periodic(const json::WeaveSpec& spec, const Execution& execution) {
  Weave weave = lay_out_first(spec, execution);
  if (!weave.lattice) {
    const auto* const why = "The weave has no lattice; only periodic cells are homogenized.";
    throw Error("weave.not_periodic", why, {{"/weave", why}});
  }
  return weave;
}

/// Throws "request.limit_exceeded" if the strands at rest would be too large an answer.
void check_polylines(const Weave& weave, const json::Limits& limits) {
  double points = 0;
  for (const auto& strand : weave.strands) points += static_cast<double>(weave::polyline_size(strand.curve));
  if (points > static_cast<double>(limits.max_layout_points))
    problem::throw_limit("request.limit_exceeded", "The number of points of the strands' polylines, two for each mm,",
                         static_cast<double>(limits.max_layout_points), points, "", "/weave");
}

store::Result draw(const json::WeaveSpec& spec, const json::Limits& limits, const Execution& outer) {
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const Weave weave = lay_out_billed(spec, execution);
    check_polylines(weave, limits);
    const StageTimer timer(execution.cost, "export");
    body = to_svg(weave, execution);
  });
  return file_result(svg_type, std::move(body), bill);
}

/// Bills whether crossings had to be found.
void bill_search(const json::WeaveSpec& spec, CostLedger* cost) {
  if (!cost) return;
  const auto* layout = std::get_if<json::LayoutSpec>(&spec.source);
  cost->add_effect("crossing_search", layout && !layout->crossings,
                   !layout             ? "the pattern knows its crossings"
                   : layout->crossings ? "the request gives the crossings"
                                       : "the request gives no crossings");
}

store::Result describe(const json::WeaveLayoutRequest& request, const json::Limits& limits, const Execution& outer) {
  Weave weave;
  std::vector<std::string> warnings;
  std::string svg;
  const auto bill = billed(outer, [&](const Execution& execution) {
    {
      const PartOfExecution part(execution, 0, 0.5);
      weave = lay_out_billed(request.weave, part.execution());
      check_polylines(weave, limits);
    }
    {
      const PartOfExecution part(execution, 0.5, 0.4);
      part.execution().checkpoint(0, "warnings");
      const StageTimer timer(execution.cost, "warnings");
      warnings = layout_warnings(weave, part.execution());
    }
    if (request.svg) {
      execution.checkpoint(0.9, "export");
      const StageTimer timer(execution.cost, "export");
      svg = to_svg(weave, execution);
    }
    bill_search(request.weave, execution.cost);
    bill_requested(execution, "svg", request.svg);
    execution.checkpoint(1, "");
  });
  return json_result(json::write_weave_layout(weave, warnings, request.svg ? &svg : nullptr, bill, outer));
}

/// About how many points the deformed polylines of one state have.
double deformed_points(const Weave& weave, int segments) {
  std::size_t places = 2 * weave.strands.size();
  for (const auto& crossing : weave.crossings) places += crossing.members.size();
  return static_cast<double>(places) * segments;
}

/// Throws "request.limit_exceeded" if the deformed strands would be too large an answer.
void check_deformed(const Weave& weave, int segments, std::size_t states, const json::Limits& limits) {
  const double points = deformed_points(weave, segments) * static_cast<double>(states);
  if (points > static_cast<double>(limits.max_deformed))
    problem::throw_limit("request.limit_exceeded", "The number of points of deformed strands, over all states,",
                         static_cast<double>(limits.max_deformed), points, "", "/deformed");
}

/// Some options of the engine are fields of the request itself, the others of its "accuracy".
PointerMap option_pointers() {
  return PointerMap("/accuracy", {{.field = "strain", .pointer = "/strain"},
                                  {.field = "thickness", .pointer = "/thickness"},
                                  {.field = "directions", .pointer = "/directions"},
                                  {.field = "deformed", .pointer = "/deformed"}});
}

store::Result homogenize(const json::WeaveHomogenizationRequest& request, const json::Limits& limits,
                         const Execution& outer) {
  Weave weave;
  std::vector<weave::DirectionalResponse> responses;
  const auto bill = billed(outer, [&](const Execution& execution) {
    weave = lay_out_periodic(request.weave, execution);
    check_deformed(weave, request.options.equilibrium.segments, request.options.deformed.size(), limits);
    responses = with_pointers<weave::InvalidOption>(
        option_pointers(), [&] { return weave::homogenize(weave, request.options, execution); });
    execution.checkpoint(1, "");
  });
  return json_result(json::write_weave_homogenization(request, weave, responses, bill));
}

store::Result deform(const json::WeaveDeformationRequest& request, const json::Limits& limits, const Execution& outer) {
  Weave weave;
  std::vector<weave::CellState> states;
  const auto bill = billed(outer, [&](const Execution& execution) {
    weave = lay_out_periodic(request.weave, execution);
    check_deformed(weave, request.options.segments, request.deformed.size(), limits);
    states = with_pointers<weave::InvalidOption>(option_pointers(), [&] {
      return weave::deform_cells(weave, request.gradients, request.options, request.deformed, execution);
    });
    execution.checkpoint(1, "");
  });
  return json_result(json::write_weave_deformation(request, weave, states, bill));
}

store::Result simulate(const json::WeaveSimulationRequest& request, const json::Limits& limits,
                       const Execution& outer) {
  Weave weave;
  PlacedLoad placed;
  weave::SimulationResult result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    weave = lay_out_first(request.weave, execution);
    placed = place_load(request, weave, limits, execution);
    if (request.deformed != json::DeformedStrands::none)
      check_deformed(weave, request.options.segments, static_cast<std::size_t>(request.states), limits);
    result = with_pointers<weave::InvalidOption>(option_pointers(), [&] {
      return with_pointers<weave::InvalidLoad>(
          load_pointers(placed), [&] { return weave::simulate(weave, placed.load, request.options, execution); });
    });
    execution.checkpoint(1, "");
  });
  return json_result(json::write_weave_simulation(request, weave, placed.places, result, bill));
}

/// The computation of a request about a weave. A faulty weave that can be laid out at once is refused before it becomes
/// a job.
template <class Request, class Run>
PreparedComputation computation_on_weave(const EndpointRequest& asked, Request request, Run run) {
  if (asked.becomes_job) refuse_small_faulty_weave(request.weave);
  return {.deadline = request.deadline,
          .run = [request = std::make_shared<const Request>(std::move(request)),
                  run = std::move(run)](const Execution& execution) { return run(*request, execution); }};
}

PreparedComputation prepare_layout(const EndpointRequest& asked, const Loader& loader) {
  return computation_on_weave(
      asked, json::parse_weave_layout(asked.body, loader.limits(), loader.cancellation()),
      [picture = asked.format == svg_type, limits = loader.limits()](const auto& request, const Execution& execution) {
        return picture ? draw(request.weave, limits, execution) : describe(request, limits, execution);
      });
}

template <class Request>
Endpoint weave_endpoint(const std::string& kind,
                        Request (*parse)(std::string_view, const json::Limits&, const CancellationToken&),
                        store::Result (*compute)(const Request&, const json::Limits&, const Execution&)) {
  return {.kind = kind, .prepare = [parse, compute](const EndpointRequest& asked, const Loader& loader) {
            return computation_on_weave(
                asked, parse(asked.body, loader.limits(), loader.cancellation()),
                [compute, limits = loader.limits()](const Request& request, const Execution& execution) {
                  return compute(request, limits, execution);
                });
          }};
}

}  // namespace

void add_weave_routes(http::Router& router, Services& services) {
  add_endpoint(router, services,
               {.kind = "weave-layouts",
                .sends = "A layout is sent as",
                .formats = {"application/json", svg_type},
                .prepare = prepare_layout});
  add_endpoint(router, services, weave_endpoint("weave-homogenizations", json::parse_weave_homogenization, homogenize));
  add_endpoint(router, services, weave_endpoint("weave-deformations", json::parse_weave_deformation, deform));
  add_endpoint(router, services, weave_endpoint("weave-simulations", json::parse_weave_simulation, simulate));
}

}  // namespace supple::routes
