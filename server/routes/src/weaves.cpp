#include <memory>

#include "computation_route.h"
#include "handlers.h"
#include "supple/base/part_of_execution.h"
#include "supple/weave/drawing.h"
#include "supple/weave/layout_warnings.h"
#include "weave_spec.h"

namespace supple::routes {
namespace {

using weave::Weave;

/// Throws "http.not_acceptable".
bool wants_picture(const http::Request& request) {
  const auto type = http::negotiate(request.header("Accept"), {"application/json", svg_type});
  if (!type) throw Error("http.not_acceptable", "A layout is sent as application/json or image/svg+xml.");
  return *type == svg_type;
}

/// The weave of a request, billed as the stage "layout".
Weave lay_out_billed(const json::WeaveSpec& spec, const Execution& execution) {
  execution.checkpoint(0, "layout");
  const StageTimer timer(execution.cost, "layout");
  return make_weave(spec, execution);
}

/// The same at the beginning of a computation that takes much longer.
Weave lay_out_first(const json::WeaveSpec& spec, const Execution& execution) {
  constexpr double share = 0.02;
  const PartOfExecution part(execution, 0, share);
  return lay_out_billed(spec, part.execution());
}

/// The same where a cell is needed. Throws "weave.not_periodic".
Weave lay_out_periodic(const json::WeaveSpec& spec, const Execution& execution) {
  Weave weave = lay_out_first(spec, execution);
  if (!weave.lattice) {
    const auto* const why = "The weave has no lattice; only periodic cells are homogenized.";
    throw Error("weave.not_periodic", why, {{"/weave", why}});
  }
  return weave;
}

/// Throws "request.limit_exceeded" where the strands at rest would be too large an answer.
void check_polylines(const Weave& weave, const json::Limits& limits) {
  double points = 0;
  for (const auto& strand : weave.strands) points += static_cast<double>(weave::polyline_size(strand.curve));
  if (points > static_cast<double>(limits.max_layout_points))
    problem::throw_limit("request.limit_exceeded", "The number of points of the strands' polylines, two for each mm,",
                         static_cast<double>(limits.max_layout_points), points, "", "/weave");
}

store::Result draw(const json::WeaveSpec& spec, const json::Limits& limits, const Execution& outer) {
  store::Result result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const Weave weave = lay_out_billed(spec, execution);
    check_polylines(weave, limits);
    const StageTimer timer(execution.cost, "export");
    result.body = to_svg(weave, execution);
  });
  result.content_type = svg_type;
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}};
  return result;
}

/// Whether crossings had to be found.
void tell_search(const json::WeaveSpec& spec, CostLedger* cost) {
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
    tell_search(request.weave, execution.cost);
    tell_asked(execution, "svg", request.svg);
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

/// Throws "request.limit_exceeded" where the deformed strands would be too large an answer.
void check_deformed(const Weave& weave, int segments, std::size_t states, const json::Limits& limits) {
  const double points = deformed_points(weave, segments) * static_cast<double>(states);
  if (points > static_cast<double>(limits.max_deformed))
    problem::throw_limit("request.limit_exceeded", "The number of points of deformed strands, over all states,",
                         static_cast<double>(limits.max_deformed), points, "", "/deformed");
}

/// Options of the engine by their place in the request.
Error option_fault(const Error& error) {
  auto details = error.details();
  for (auto& detail : details) {
    const bool direct = detail.where == "strain" || detail.where == "thickness" ||
                        detail.where.rfind("directions", 0) == 0 || detail.where.rfind("deformed", 0) == 0;
    detail.where = (direct ? "/" : "/accuracy/") + detail.where;
  }
  return {error.code(), error.what(), std::move(details)};
}

store::Result homogenize(const json::WeaveHomogenizationRequest& request, const json::Limits& limits,
                         const Execution& outer) {
  Weave weave;
  std::vector<weave::DirectionalResponse> responses;
  const auto bill = billed(outer, [&](const Execution& execution) {
    weave = lay_out_periodic(request.weave, execution);
    check_deformed(weave, request.options.equilibrium.segments, request.options.deformed.size(), limits);
    try {
      responses = weave::homogenize(weave, request.options, execution);
    } catch (const Error& error) {
      if (error.code() != "weave.invalid_option") throw;
      throw option_fault(error);
    }
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
    try {
      states = weave::deform_cells(weave, request.gradients, request.options, request.deformed, execution);
    } catch (const Error& error) {
      if (error.code() != "weave.invalid_option") throw;
      throw option_fault(error);
    }
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
    try {
      result = weave::simulate(weave, placed.load, request.options, execution);
    } catch (const Error& error) {
      if (error.code() == "weave.invalid_load") throw moved_to_request(error, placed);
      if (error.code() == "weave.invalid_option") throw option_fault(error);
      throw;
    }
    execution.checkpoint(1, "");
  });
  return json_result(json::write_weave_simulation(request, weave, placed.places, result, bill));
}

http::Response answer_layout(Services& services, const http::Request& http_request) {
  require_ready(services);
  const bool picture = wants_picture(http_request);
  auto request = json::parse_weave_layout(json_body(http_request), services.limits.json);
  if (becomes_job(http_request)) refuse_small_faulty_weave(request.weave);
  jobs::Computation computation{"weave-layouts", {}, request.deadline, {}};
  computation.run = [request = std::make_shared<const json::WeaveLayoutRequest>(std::move(request)), picture,
                     limits = services.limits.json](const Execution& execution) {
    return picture ? draw(request->weave, limits, execution) : describe(*request, limits, execution);
  };
  return answer_computation(services, http_request, std::move(computation));
}

/// Reads a request, refuses what can be refused at once, and computes.
template <class Request>
http::Response answer(Services& services, const http::Request& http_request, const char* kind,
                      Request (*parse)(std::string_view, const json::Limits&),
                      store::Result (*compute)(const Request&, const json::Limits&, const Execution&)) {
  require_ready(services);
  Request request = parse(json_body(http_request), services.limits.json);
  if (becomes_job(http_request)) refuse_small_faulty_weave(request.weave);
  jobs::Computation computation{kind, {}, request.deadline, {}};
  computation.run = [request = std::make_shared<const Request>(std::move(request)), limits = services.limits.json,
                     compute](const Execution& execution) { return compute(*request, limits, execution); };
  return answer_computation(services, http_request, std::move(computation));
}

http::Response answer_homogenization(Services& services, const http::Request& http_request) {
  return answer(services, http_request, "weave-homogenizations", json::parse_weave_homogenization, homogenize);
}

http::Response answer_deformation(Services& services, const http::Request& http_request) {
  return answer(services, http_request, "weave-deformations", json::parse_weave_deformation, deform);
}

http::Response answer_simulation(Services& services, const http::Request& http_request) {
  return answer(services, http_request, "weave-simulations", json::parse_weave_simulation, simulate);
}

}  // namespace

void add_weave_routes(http::Router& router, Services& services) {
  const http::BodyLimit json{services.limits.max_json, "--max-json"};
  const auto add = [&](const char* path, http::Response (*answer)(Services&, const http::Request&)) {
    router.add({"POST", path, [&services, answer](const http::Request& r) { return answer(services, r); }, json});
  };
  add("/v1/weave-layouts", answer_layout);
  add("/v1/weave-homogenizations", answer_homogenization);
  add("/v1/weave-deformations", answer_deformation);
  add("/v1/weave-simulations", answer_simulation);
}

}  // namespace supple::routes
